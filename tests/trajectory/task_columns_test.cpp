#include "deltadyn/trajectory/task_columns.hpp"

#include <gmock/gmock.h>

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

TEST(TaskColumns, EndWithTheUnit) {
  const auto delta4 = task_columns(testing_support::delta_description("delta4"));
  ASSERT_EQ(delta4.size(), 4U);
  EXPECT_EQ(delta4[1].z + delta4[1].zd + delta4[1].zdd, "y_myd_m_sydd_m_s2");
  EXPECT_EQ(delta4[3].z + delta4[3].zd + delta4[3].zdd, "psi_radpsid_rad_spsidd_rad_s2");
  EXPECT_TRUE(delta4[3].rotation);
  EXPECT_EQ(task_columns(testing_support::delta_description("linear-delta3")).size(), 3U);
  const auto axis = task_columns(testing_support::axis_description(DriveKind::prismatic));
  EXPECT_EQ(axis[0].zdd, "qdd1_m_s2");
  EXPECT_FALSE(axis[0].rotation);
}

}  // namespace
}  // namespace deltadyn
