#pragma once

/// \file
/// Decompositions of matrices whose size is known at run time only, compiled once. Eigen's templates behind them are
/// among the slowest to compile, and one copy in every unit that solves a system would take a quarter of the build.
/// The fixed sizes of the core call Eigen itself.

#include <Eigen/Core>
#include <Eigen/QR>
#include <vector>

namespace deltadyn::dense {

/// A symmetric matrix as V diag(values) V^T, values rising. Not finite where the iteration fails.
struct Spectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
[[nodiscard]] Spectrum spectrum(const Eigen::MatrixXd& symmetric);
[[nodiscard]] Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);

/// A = U diag(values) V^T, values falling; U and V with as many columns as there are values.
struct SingularValues {
  Eigen::MatrixXd U;
  Eigen::VectorXd values;
  Eigen::MatrixXd V;
};
[[nodiscard]] SingularValues svd(const Eigen::MatrixXd& A);
[[nodiscard]] Eigen::VectorXd singular_values(const Eigen::MatrixXd& A);

/// Cholesky's factor of a positive definite matrix, A = L L^T. Of another matrix L holds what was done until a pivot
/// was not positive: A's own part beyond it.
struct Cholesky {
  Eigen::MatrixXd L;
  bool positive_definite = false;
};
[[nodiscard]] Cholesky cholesky(const Eigen::MatrixXd& symmetric);
/// L x = b, and L L^T x = b.
[[nodiscard]] Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& L, const Eigen::MatrixXd& b);
[[nodiscard]] Eigen::MatrixXd solve(const Cholesky& factor, const Eigen::MatrixXd& b);

/// A x = b with A symmetric and not negative (L D L^T, pivoted).
[[nodiscard]] Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& symmetric, const Eigen::MatrixXd& b);
[[nodiscard]] Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& symmetric, const Eigen::VectorXd& b);

/// A x = b with A square and regular (L U, pivoted).
[[nodiscard]] Eigen::VectorXd solve_square(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// The smallest x among those that come nearest to A x = b, whatever the rank of A.
/// \param threshold size of a pivot, against the largest, from which it counts; 0: Eigen's own
[[nodiscard]] Eigen::VectorXd least_norm(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double threshold = 0);
[[nodiscard]] Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& A);

/// R of A = Q R, upper triangular, with as many rows as A has or columns, whichever is fewer.
[[nodiscard]] Eigen::MatrixXd r_factor(const Eigen::MatrixXd& A);
/// Q of A = Q R with as many columns as A, for A with no fewer rows than columns.
[[nodiscard]] Eigen::MatrixXd q_factor(const Eigen::MatrixXd& A);
/// R x = b and R^T x = b with R upper triangular.
[[nodiscard]] Eigen::MatrixXd solve_upper(const Eigen::MatrixXd& R, const Eigen::MatrixXd& b);
[[nodiscard]] Eigen::VectorXd solve_upper(const Eigen::MatrixXd& R, const Eigen::VectorXd& b);
[[nodiscard]] Eigen::VectorXd solve_upper_transposed(const Eigen::MatrixXd& R, const Eigen::VectorXd& b);

/// A P = Q R with the columns in the order of their weight: what shows the rank, and solves least squares by it.
class PivotedQr {
 public:
  PivotedQr() = default;
  /// \param threshold size of a diagonal entry of R, against the largest, from which it counts; 0: Eigen's own
  explicit PivotedQr(const Eigen::MatrixXd& A, double threshold = 0);

  [[nodiscard]] Eigen::Index rank() const { return qr_.rank(); }
  /// Columns of A in the order in which R holds them.
  [[nodiscard]] std::vector<Eigen::Index> order() const;
  /// Upper triangular, as r_factor has it.
  [[nodiscard]] Eigen::MatrixXd R() const;
  /// Orthonormal columns that span what A spans, as many as the rank.
  [[nodiscard]] Eigen::MatrixXd basis() const;
  /// Q^T b with all of Q: beyond the rank stands what A cannot reach.
  [[nodiscard]] Eigen::VectorXd rotated(const Eigen::VectorXd& b) const;
  /// Nearest to A x = b, with 0 for the columns beyond the rank.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_;
};

}  // namespace deltadyn::dense
