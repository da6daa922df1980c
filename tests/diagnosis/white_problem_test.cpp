#include "../../src/diagnosis/white_problem.hpp"

#include <Eigen/QR>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(ConstrainedGain, IsLeastSquaresWithoutConstraints) {
  const MatrixXd C = MatrixXd::Random(30, 3);
  const VectorXd r = VectorXd::Random(30);
  const NonNegativeSolution gain = constrained_gain(C.transpose() * C, C.transpose() * r, {false, false, false});
  const VectorXd a = C.colPivHouseholderQr().solve(r);
  EXPECT_LT((gain.x - a).norm(), 1e-9);
  EXPECT_NEAR(gain.gain, r.squaredNorm() - (r - C * a).squaredNorm(), 1e-9);
}

TEST(ConstrainedGain, GivesNothingForTheWrongSign) {
  const MatrixXd C = MatrixXd::Identity(4, 1);
  const VectorXd r = -VectorXd::Unit(4, 0);
  EXPECT_EQ(constrained_gain(C.transpose() * C, C.transpose() * r, {true}).gain, 0.0);
  EXPECT_EQ(constrained_gain(C.transpose() * C, C.transpose() * r, {false}).gain, 1.0);
}

TEST(ConstrainedGain, LeavesOutColumnsOfWhichNothingIsLeft) {
  MatrixXd gram = MatrixXd::Zero(2, 2);
  gram(0, 0) = 4;
  gram(1, 1) = -1e-18;
  const NonNegativeSolution gain =
      constrained_gain(gram, Eigen::Vector2d(2, 1e-9), {false, false});  // rounding in the second
  EXPECT_NEAR(gain.gain, 1, 1e-12);
  EXPECT_EQ(gain.x(1), 0);
}

TEST(ConstrainedGain, SharesBetweenEqualColumns) {
  const MatrixXd C = MatrixXd::Random(30, 1) * Eigen::RowVector2d(1, 2);
  const VectorXd r = 3 * C.col(0);
  MatrixXd gram = C.transpose() * C;
  VectorXd inner = C.transpose() * r;
  gram(1, 1) *= 1 + 1e-11;  // rounding, which must not become a direction of its own
  inner(1) *= 1 + 1e-7;
  const NonNegativeSolution gain = constrained_gain(gram, inner, {false, false});
  EXPECT_NEAR(gain.gain, r.squaredNorm(), 1e-6 * r.squaredNorm());
  EXPECT_LT(gain.x.norm(), 10);
  EXPECT_LT((C * gain.x - r).norm(), 1e-6 * r.norm());
}

TEST(WhiteColumns, HaveNoSquareWhereOnlyRoundingIsLeft) {
  WhiteColumns columns;
  columns.blocks = {MatrixXd::Random(40, 2)};
  MatrixXd Q = columns.blocks[0].col(0).normalized();  // the first column is the base's
  columns.base = Q.transpose() * columns.blocks[0];
  const MatrixXd gram = columns.clear_gram(0, 2);
  EXPECT_EQ(gram(0, 0), 0);
  EXPECT_EQ(gram(0, 1), 0);
  EXPECT_EQ(gram(1, 1), columns.gram(0, 2)(1, 1));
}

}  // namespace
}  // namespace deltadyn
