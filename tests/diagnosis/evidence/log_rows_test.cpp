#include "../../../src/diagnosis/evidence/log_rows.hpp"

#include <gtest/gtest.h>

#include "identification/axis_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

// The diagnosis sees the model that the parameter file holds: its rows are those of a fit or a validation.
TEST(MakeLogRows, HoldsKnownBristlesAndRipplesAsTheRowsOfAFitDo) {
  const auto robot = make_robot(axis_description(DriveKind::revolute));
  AxisLog dirty;
  dirty.presliding = 4e-3;
  dirty.ripple = 0.1;
  ProcessingOptions processing;
  processing.cutoff_hz = 20;
  processing.periods = Periods::ignore;
  processing.presliding = Eigen::VectorXd::Constant(1, dirty.presliding);
  processing.ripples = {{0, dirty.waves, 0.09, -0.04, 0, 0}};
  const BaseParameters base = find_base_parameters(*robot);
  const PreparedLog prepared = prepare_log(*robot, dirty.make(), processing);
  RowBlock block;
  read_rows(*robot, prepared, 0, prepared.rows, block);
  const LogRows rows = make_log_rows(*robot, base, prepared, 1);
  ASSERT_EQ(rows.rows(), prepared.rows);
  EXPECT_LT((rows.tau - block.tau).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((rows.ripple - block.ripple).cwiseAbs().maxCoeff(), 1e-12);
  for (int c = 0; c < base.count(); ++c) {
    const auto column = base.independent[static_cast<std::size_t>(c)];
    EXPECT_LT((rows.Y[0].col(c) - block.Y[0].col(column)).cwiseAbs().maxCoeff(), 1e-9) << c;
  }
}

}  // namespace
}  // namespace deltadyn
