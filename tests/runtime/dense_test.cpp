#include "deltadyn/runtime/dense.hpp"

#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/random.hpp"

namespace deltadyn::dense {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Random matrices, of full rank and of less.
class Dense : public testing::TestWithParam<int> {
 protected:
  static constexpr Index kRows = 9, kColumns = 6, kRank = 4;

  [[nodiscard]] MatrixXd random(Index rows, Index columns) {
    MatrixXd A(rows, columns);
    for (double& number : A.reshaped()) number = canonical(random_) - 0.5;
    return A;
  }
  [[nodiscard]] MatrixXd short_of_rank() { return random(kRows, kRank) * random(kRank, kColumns); }

  static void expect_near(const MatrixXd& a, const MatrixXd& b) {
    ASSERT_EQ(a.rows(), b.rows());
    ASSERT_EQ(a.cols(), b.cols());
    EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-11 * (1 + b.cwiseAbs().maxCoeff()));
  }

  std::mt19937_64 random_{static_cast<std::uint64_t>(GetParam())};
  const MatrixXd identity_ = MatrixXd::Identity(kColumns, kColumns);
};

TEST_P(Dense, DecompositionsMultiplyToTheirMatrix) {
  const MatrixXd A = random(kRows, kColumns), S = A.transpose() * A;
  const Spectrum spectrum = dense::spectrum(S);
  expect_near(spectrum.vectors * spectrum.values.asDiagonal() * spectrum.vectors.transpose(), S);
  expect_near(eigenvalues(S), spectrum.values);
  const SingularValues singular = svd(A);
  expect_near(singular.U * singular.values.asDiagonal() * singular.V.transpose(), A);
  expect_near(singular_values(A), singular.values);
  const Cholesky factor = cholesky(S);
  EXPECT_TRUE(factor.positive_definite);
  expect_near(factor.L * factor.L.transpose(), S);
  EXPECT_FALSE(cholesky(S - 2 * S.trace() * identity_).positive_definite);
  expect_near(q_factor(A) * r_factor(A), A);
  expect_near(q_factor(A).transpose() * q_factor(A), identity_);
  EXPECT_EQ(r_factor(A.transpose()).rows(), kColumns);
}

TEST_P(Dense, SolutionsSolve) {
  const MatrixXd A = random(kRows, kColumns), S = A.transpose() * A, B = random(kColumns, 2);
  const VectorXd b = B.col(0);
  expect_near(S * solve_symmetric(S, b), b);
  expect_near(S * solve_symmetric(S, B), B);
  expect_near(S * solve_square(S, b), b);
  const MatrixXd R = r_factor(A);
  expect_near(R * solve_upper(R, b), b);
  expect_near(R * solve_upper(R, B), B);
  expect_near(R.transpose() * solve_upper_transposed(R, b), b);
  expect_near(R.transpose() * solve_lower(R.transpose(), B), B);
  expect_near(S * solve(cholesky(S), B), B);
}

TEST_P(Dense, TheSmallestSolutionHasNothingThatTheMatrixDoesNotSee) {
  const MatrixXd A = short_of_rank(), inverse = pseudo_inverse(A);
  const VectorXd b = random(kRows, 1), x = least_norm(A, b);
  expect_near(x, inverse * b);
  expect_near(A * inverse * A, A);
  expect_near(inverse * A, (inverse * A).transpose());
  // A wide threshold leaves the weak directions out.
  EXPECT_LT(least_norm(A, b, 0.999).norm(), x.norm());
}

TEST_P(Dense, ThePivotedFactorShowsTheRank) {
  const MatrixXd A = short_of_rank();
  const PivotedQr qr(A, 1e-9);
  EXPECT_EQ(qr.rank(), kRank);
  const MatrixXd basis = qr.basis();
  EXPECT_EQ(basis.cols(), kRank);
  expect_near(basis * basis.transpose() * A, A);
  const VectorXd b = random(kRows, 1);
  expect_near(A.transpose() * A * qr.solve(b), A.transpose() * b);
  EXPECT_NEAR(qr.rotated(b).tail(kRows - kRank).norm(), (b - basis * basis.transpose() * b).norm(), 1e-12);
  const std::vector<Index> order = qr.order();
  for (Index k = 0; k < kColumns; ++k)
    EXPECT_NEAR(qr.R().col(k).norm(), A.col(order[static_cast<std::size_t>(k)]).norm(), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Dense, testing::Range(1, 9));

}  // namespace
}  // namespace deltadyn::dense
