#include "deltadyn/excitation/criterion.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <gmock/gmock.h>

#include "deltadyn/runtime/error.hpp"

#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using testing_support::Random;

constexpr Criterion kAll[] = {Criterion::log_det, Criterion::det, Criterion::cond, Criterion::trace,
                              Criterion::min_eigenvalue};

Eigen::MatrixXd random_information(Random& random, int p) {
  Eigen::MatrixXd A(3 * p, p);
  for (Eigen::Index k = 0; k < A.size(); ++k) A(k) = random.uniform(-1, 1);
  return A.transpose() * A;
}

TEST(Criterion, ValuesAreThoseOfTheEigenvalues) {
  Random random(1);
  const Eigen::MatrixXd M = random_information(random, 6);
  const Eigen::VectorXd l = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(M).eigenvalues();
  EXPECT_NEAR(evaluate(Criterion::log_det, M).value, l.array().log().sum(), 1e-12);
  EXPECT_NEAR(evaluate(Criterion::det, M).value, std::pow(l.prod(), 1.0 / 6), 1e-12);
  EXPECT_NEAR(evaluate(Criterion::cond, M).value, -std::log(l(5) / l(0)), 1e-12);
  EXPECT_NEAR(evaluate(Criterion::trace, M).value, -std::log(l.cwiseInverse().sum()), 1e-12);
  EXPECT_NEAR(evaluate(Criterion::min_eigenvalue, M).value, std::log(l(0)), 1e-12);
}

TEST(Criterion, GradientIsTheSlopeAlongEveryDirection) {
  Random random(2);
  const Eigen::MatrixXd M = random_information(random, 5);
  for (const Criterion criterion : kAll) {
    const CriterionValue at = evaluate(criterion, M);
    for (int trial = 0; trial < 10; ++trial) {
      Eigen::MatrixXd D(5, 5);
      for (Eigen::Index k = 0; k < D.size(); ++k) D(k) = random.uniform(-1, 1);
      D = (D + D.transpose()).eval();
      constexpr double kStep = 1e-5;
      const double slope =
          (evaluate(criterion, M + kStep * D).value - evaluate(criterion, M - kStep * D).value) / (2 * kStep);
      EXPECT_NEAR(at.by_M.cwiseProduct(D).sum(), slope, 1e-7 * (1 + std::abs(slope))) << word_of(criterion);
    }
  }
}

TEST(Criterion, MoreInformationIsNeverWorse) {
  Random random(3);
  const Eigen::MatrixXd M = random_information(random, 5), more = M + 0.1 * random_information(random, 5);
  for (const Criterion criterion : {Criterion::log_det, Criterion::det, Criterion::trace, Criterion::min_eigenvalue})
    EXPECT_GT(evaluate(criterion, more).value, evaluate(criterion, M).value) << word_of(criterion);
}

TEST(Criterion, SingularInformationIsSaid) {
  const Eigen::MatrixXd M = Eigen::VectorXd::Unit(4, 1).asDiagonal();
  for (const Criterion criterion : kAll) EXPECT_FALSE(evaluate(criterion, M).regular) << word_of(criterion);
  EXPECT_EQ(log_determinant(M), -std::numeric_limits<double>::infinity());
}

TEST(Criterion, WordsGoBothWays) {
  for (const Criterion criterion : kAll) EXPECT_EQ(criterion_of(word_of(criterion)), criterion);
  EXPECT_THROW((void)criterion_of("volume"), Error);
}

}  // namespace
}  // namespace deltadyn
