#include "deltadyn/diagnosis/white_problem.hpp"

#include <Eigen/QR>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(ConstrainedGain, IsLeastSquaresWithoutConstraints) {
  const MatrixXd C = MatrixXd::Random(30, 3);
  const VectorXd r = VectorXd::Random(30);
  const Gain gain = constrained_gain(C.transpose() * C, C.transpose() * r, {false, false, false});
  const VectorXd a = C.colPivHouseholderQr().solve(r);
  EXPECT_LT((gain.amplitude - a).norm(), 1e-9);
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
  const Gain gain = constrained_gain(gram, Eigen::Vector2d(2, 1e-9), {false, false});  // rounding in the second
  EXPECT_NEAR(gain.gain, 1, 1e-12);
  EXPECT_EQ(gain.amplitude(1), 0);
}

TEST(ConstrainedGain, SharesBetweenEqualColumns) {
  const MatrixXd C = MatrixXd::Random(30, 1) * Eigen::RowVector2d(1, 2);
  const VectorXd r = 3 * C.col(0);
  const Gain gain = constrained_gain(C.transpose() * C, C.transpose() * r, {false, false});
  EXPECT_NEAR(gain.gain, r.squaredNorm(), 1e-6 * r.squaredNorm());
  EXPECT_LT((C * gain.amplitude - r).norm(), 1e-6 * r.norm());
}

}  // namespace
}  // namespace deltadyn
