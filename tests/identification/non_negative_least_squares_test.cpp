#include "deltadyn/identification/non_negative_least_squares.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Problem {
  MatrixXd C;
  VectorXd r;
  std::vector<bool> positive;
};

/// Columns that are much alike, as those of effects are, so that one that left often belongs back in.
Problem random_problem(std::mt19937_64& random, Index columns) {
  NormalDistribution normal;
  const auto matrix = [&](Index rows, Index cols) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); }));
  };
  Problem out;
  out.C = matrix(20, 2) * matrix(2, columns) + 0.3 * matrix(20, columns);
  out.r = matrix(20, 1);
  for (Index i = 0; i < columns; ++i) {
    out.C.col(i) *= std::pow(10.0, normal(random));
    out.positive.push_back(random() % 4 != 0);
  }
  return out;
}

/// Least sum of squares over all sets of columns whose least squares keeps the signs.
double by_trying_all_sets(const Problem& problem) {
  const auto columns = static_cast<std::size_t>(problem.C.cols());
  double least = problem.r.squaredNorm();
  for (unsigned set = 1; set < (1U << columns); ++set) {
    std::vector<Index> chosen;
    for (std::size_t i = 0; i < columns; ++i) {
      if ((set >> i) % 2 == 1) chosen.push_back(static_cast<Index>(i));
    }
    const MatrixXd C = problem.C(Eigen::all, chosen);
    const VectorXd x = C.colPivHouseholderQr().solve(problem.r);
    bool allowed = true;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      if (problem.positive[static_cast<std::size_t>(chosen[k])] && x(static_cast<Index>(k)) < 0) allowed = false;
    }
    if (allowed) least = std::min(least, (problem.r - C * x).squaredNorm());
  }
  return least;
}

TEST(NonNegativeLeastSquares, IsTheBestOfAllSetsOfColumns) {
  std::mt19937_64 random(1);
  int bounded = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Problem problem = random_problem(random, 2 + trial % 6);
    const auto found = non_negative_least_squares(problem.C.transpose() * problem.C, problem.C.transpose() * problem.r,
                                                  problem.positive);
    for (Index i = 0; i < found.x.size(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      EXPECT_TRUE(found.x(i) >= 0 || !problem.positive[at]);
      EXPECT_TRUE(found.x(i) == 0 || found.free[at]);
      bounded += found.free[at] ? 0 : 1;
    }
    const double left = (problem.r - problem.C * found.x).squaredNorm();
    EXPECT_NEAR(left, by_trying_all_sets(problem), 1e-9 * problem.r.squaredNorm()) << "trial " << trial;
    EXPECT_NEAR(found.gain, problem.r.squaredNorm() - left, 1e-9 * problem.r.squaredNorm());
  }
  EXPECT_GT(bounded, 1000);
}

TEST(NonNegativeLeastSquares, TakesAColumnBackThatLeftTooEarly) {
  std::mt19937_64 random(2);
  int back = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Problem problem = random_problem(random, 6);
    problem.positive.assign(6, true);
    const MatrixXd G = problem.C.transpose() * problem.C;
    const VectorXd u = problem.C.transpose() * problem.r;
    // What elimination without a way back finds: the worst leaves until none has the wrong sign.
    std::vector<Index> left = {0, 1, 2, 3, 4, 5};
    double greedy = 0;
    while (!left.empty()) {
      const VectorXd x = MatrixXd(G(left, left)).ldlt().solve(VectorXd(u(left)));
      const VectorXd size = x.cwiseProduct(G.diagonal()(left).cwiseSqrt());
      Index worst = 0;
      if (size.minCoeff(&worst) >= 0) {
        greedy = VectorXd(u(left)).dot(x);
        break;
      }
      left.erase(left.begin() + worst);
    }
    const double gain = non_negative_least_squares(G, u, problem.positive).gain;
    EXPECT_GE(gain, greedy * (1 - 1e-9));
    back += gain > greedy * (1 + 1e-6) + 1e-9 ? 1 : 0;
  }
  EXPECT_GT(back, 10);
}

TEST(NonNegativeLeastSquares, EmptyAndEqualColumns) {
  MatrixXd C(3, 4);
  C << 1, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0;
  const VectorXd r = Eigen::Vector3d(2, -1, 5);
  const auto found = non_negative_least_squares(C.transpose() * C, C.transpose() * r, {true, true, false, true});
  EXPECT_NEAR(found.x(0), 1, 1e-12);  // shared between the two
  EXPECT_NEAR(found.x(1), 1, 1e-12);
  EXPECT_EQ(found.x(2), 0);
  EXPECT_EQ(found.x(3), 0);
  EXPECT_NEAR(found.gain, 4, 1e-12);
  EXPECT_EQ(found.free, (std::vector<bool>{true, true, false, false}));
}

TEST(NonNegativeLeastSquares, IsLeastSquaresWithoutConstraints) {
  const MatrixXd C = MatrixXd::Random(30, 3);
  const VectorXd r = VectorXd::Random(30);
  const NonNegativeSolution gain =
      non_negative_least_squares(C.transpose() * C, C.transpose() * r, {false, false, false});
  const VectorXd a = C.colPivHouseholderQr().solve(r);
  EXPECT_LT((gain.x - a).norm(), 1e-9);
  EXPECT_NEAR(gain.gain, r.squaredNorm() - (r - C * a).squaredNorm(), 1e-9);
}

TEST(NonNegativeLeastSquares, GivesNothingForTheWrongSign) {
  const MatrixXd C = MatrixXd::Identity(4, 1);
  const VectorXd r = -VectorXd::Unit(4, 0);
  EXPECT_EQ(non_negative_least_squares(C.transpose() * C, C.transpose() * r, {true}).gain, 0.0);
  EXPECT_EQ(non_negative_least_squares(C.transpose() * C, C.transpose() * r, {false}).gain, 1.0);
}

TEST(NonNegativeLeastSquares, LeavesOutColumnsOfWhichNothingIsLeft) {
  MatrixXd gram = MatrixXd::Zero(2, 2);
  gram(0, 0) = 4;
  gram(1, 1) = -1e-18;
  const NonNegativeSolution gain =
      non_negative_least_squares(gram, Eigen::Vector2d(2, 1e-9), {false, false});  // rounding in the second
  EXPECT_NEAR(gain.gain, 1, 1e-12);
  EXPECT_EQ(gain.x(1), 0);
}

TEST(NonNegativeLeastSquares, SharesBetweenEqualColumns) {
  const MatrixXd C = MatrixXd::Random(30, 1) * Eigen::RowVector2d(1, 2);
  const VectorXd r = 3 * C.col(0);
  MatrixXd gram = C.transpose() * C;
  VectorXd inner = C.transpose() * r;
  gram(1, 1) *= 1 + 1e-11;  // rounding, which must not become a direction of its own
  inner(1) *= 1 + 1e-7;
  const NonNegativeSolution gain = non_negative_least_squares(gram, inner, {false, false});
  EXPECT_NEAR(gain.gain, r.squaredNorm(), 1e-6 * r.squaredNorm());
  EXPECT_LT(gain.x.norm(), 10);
  EXPECT_LT((C * gain.x - r).norm(), 1e-6 * r.norm());
}

TEST(NonNegativeLeastSquares, NoColumns) {
  EXPECT_EQ(non_negative_least_squares(MatrixXd(0, 0), VectorXd(0), {}).gain, 0);
}

}  // namespace
}  // namespace deltadyn
