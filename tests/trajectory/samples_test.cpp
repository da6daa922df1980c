#include "deltadyn/trajectory/samples.hpp"

#include <gmock/gmock.h>

#include "deltadyn/runtime/error.hpp"

#include "support/descriptions.hpp"
#include "support/matchers.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using testing_support::IsNear;

TEST(TrajectorySamples, DrivesAndTaskSpaceCompleteEachOther) {
  const auto robot = make_robot(testing_support::delta_description("delta4"));
  testing_support::Random random(1);
  TrajectorySamples samples;
  samples.t_s = Eigen::VectorXd::LinSpaced(30, 0, 1);
  samples.z.resize(30, 4);
  samples.zd = samples.zdd = samples.z;
  for (Eigen::Index row = 0; row < 30; ++row) {
    const auto task = testing_support::random_task<Delta4>(random);
    samples.z.row(row) = task.z.transpose();
    samples.zd.row(row) = task.zd.transpose();
    samples.zdd.row(row) = task.zdd.transpose();
  }
  complete_drives(*robot, samples);
  TrajectorySamples back = samples;
  back.z.resize(0, 0);
  complete_task(*robot, back);
  EXPECT_THAT(back.z, IsNear(samples.z, 1e-12));
  EXPECT_THAT(back.zd, IsNear(samples.zd, 1e-10));
  EXPECT_THAT(back.zdd, IsNear(samples.zdd, 1e-8));
  samples.z(7, 2) = -9;
  try {
    complete_drives(*robot, samples);
    FAIL() << "out of reach";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("at t = 0.241379 s the pose is out of reach"));
  }
}

}  // namespace
}  // namespace deltadyn
