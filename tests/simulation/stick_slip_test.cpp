#include "deltadyn/simulation/stick_slip.hpp"

#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

/// Every joint is held with no acceleration, or held back with all there is while it starts the other way.
void expect_solved(const Eigen::MatrixXd& A, const JointVector& b, const JointVector& low, const JointVector& high,
                   const StickSlip& result) {
  const Eigen::VectorXd a = A * result.force + b;
  const double scale = b.cwiseAbs().maxCoeff() + 1;
  for (Eigen::Index i = 0; i < b.size(); ++i) {
    EXPECT_GE(result.force(i), low(i));
    EXPECT_LE(result.force(i), high(i));
    switch (result.direction(i)) {
      case 0: EXPECT_NEAR(a(i), 0, 1e-8 * scale); break;
      case 1:
        EXPECT_EQ(result.force(i), low(i));
        EXPECT_GT(a(i), 0);
        break;
      default: EXPECT_EQ(result.force(i), high(i)); EXPECT_LT(a(i), 0);
    }
  }
}

TEST(StickSlip, OneJointHoldsUpToItsFriction) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Constant(1, 1, 2.0);  // mass 0.5 kg
  const JointVector low = JointVector::Constant(1, -3.0), high = JointVector::Constant(1, 3.0);
  const auto at = [&](double push) { return solve_stick_slip(A, JointVector::Constant(1, 2.0 * push), low, high); };
  EXPECT_EQ(at(2.9).direction(0), 0);
  EXPECT_NEAR(at(2.9).force(0), -2.9, 1e-12);
  EXPECT_EQ(at(3.1).direction(0), 1);
  EXPECT_NEAR(at(3.1).acceleration(0), 0.2, 1e-12);
  EXPECT_EQ(at(-3.1).direction(0), -1);
}

TEST(StickSlip, RandomProblemsMeetTheirConditions) {
  std::mt19937_64 random(5);
  NormalDistribution normal;
  for (int k = 0; k < 500; ++k) {
    const int joints = 1 + k % 7, coordinates = 1 + k % 4;  // often more joints than coordinates: A is singular then
    Eigen::MatrixXd J(joints, coordinates);
    JointVector b(joints), low(joints), high(joints);
    const Eigen::MatrixXd free = Eigen::MatrixXd::NullaryExpr(coordinates, 1, [&] { return 3 * normal(random); });
    for (int i = 0; i < joints; ++i) {
      for (int j = 0; j < coordinates; ++j) J(i, j) = normal(random);
      high(i) = std::abs(normal(random));
      low(i) = -std::abs(normal(random));
    }
    b = J * free;
    const Eigen::MatrixXd A = J * J.transpose();
    expect_solved(A, b, low, high, solve_stick_slip(A, b, low, high));
  }
}

TEST(StickSlip, JointsThatDependOnOneAnotherShareTheirForce) {
  // Two brakes on one shaft, neither strong enough alone.
  const Eigen::MatrixXd A = Eigen::MatrixXd::Ones(2, 2);
  const JointVector low = JointVector::Constant(2, -1.0), high = JointVector::Constant(2, 1.0);
  const StickSlip held = solve_stick_slip(A, JointVector::Constant(2, 1.9), low, high);
  EXPECT_EQ(held.direction(0), 0);
  EXPECT_EQ(held.direction(1), 0);
  EXPECT_NEAR(held.force.sum(), -1.9, 1e-12);
  const StickSlip slips = solve_stick_slip(A, JointVector::Constant(2, 2.1), low, high);
  EXPECT_EQ(slips.direction(0), 1);
  EXPECT_EQ(slips.direction(1), 1);
}

}  // namespace
}  // namespace deltadyn
