#include "deltadyn/runtime/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>

namespace deltadyn::dense {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Spectrum spectrum(const MatrixXd& symmetric) {
  if (symmetric.size() == 0) return {};  // Eigen's solver needs a row
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VectorXd eigenvalues(const MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

SingularValues svd(const MatrixXd& A) {
  const Eigen::JacobiSVD<MatrixXd> solver(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {solver.matrixU(), solver.singularValues(), solver.matrixV()};
}

VectorXd singular_values(const MatrixXd& A) {
  return Eigen::JacobiSVD<MatrixXd>(A).singularValues();
}

Cholesky cholesky(const MatrixXd& symmetric) {
  const Eigen::LLT<MatrixXd> factor(symmetric);
  return {factor.matrixL(), factor.info() == Eigen::Success};
}

MatrixXd solve_lower(const MatrixXd& L, const MatrixXd& b) {
  return L.triangularView<Eigen::Lower>().solve(b);
}

MatrixXd solve(const Cholesky& factor, const MatrixXd& b) {
  const auto L = factor.L.triangularView<Eigen::Lower>();
  MatrixXd x = b;
  L.solveInPlace(x);
  L.transpose().solveInPlace(x);
  return x;
}

MatrixXd solve_symmetric(const MatrixXd& symmetric, const MatrixXd& b) {
  return symmetric.ldlt().solve(b);
}

VectorXd solve_symmetric(const MatrixXd& symmetric, const VectorXd& b) {
  return symmetric.ldlt().solve(b);
}

VectorXd solve_square(const MatrixXd& A, const VectorXd& b) {
  return A.partialPivLu().solve(b);
}

VectorXd least_norm(const MatrixXd& A, const VectorXd& b, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
  if (threshold > 0) decomposition.setThreshold(threshold);
  return decomposition.compute(A).solve(b);
}

MatrixXd pseudo_inverse(const MatrixXd& A) {
  return A.completeOrthogonalDecomposition().pseudoInverse();
}

MatrixXd r_factor(const MatrixXd& A) {
  const Eigen::HouseholderQR<MatrixXd> qr(A);
  return qr.matrixQR().topRows(std::min(A.rows(), A.cols())).triangularView<Eigen::Upper>();
}

MatrixXd q_factor(const MatrixXd& A) {
  const Eigen::HouseholderQR<MatrixXd> qr(A);
  return qr.householderQ() * MatrixXd::Identity(A.rows(), A.cols());
}

MatrixXd solve_upper(const MatrixXd& R, const MatrixXd& b) {
  return R.triangularView<Eigen::Upper>().solve(b);
}

VectorXd solve_upper(const MatrixXd& R, const VectorXd& b) {
  return R.triangularView<Eigen::Upper>().solve(b);
}

VectorXd solve_upper_transposed(const MatrixXd& R, const VectorXd& b) {
  return R.triangularView<Eigen::Upper>().transpose().solve(b);
}

PivotedQr::PivotedQr(const MatrixXd& A, double threshold) {
  if (threshold > 0) qr_.setThreshold(threshold);
  qr_.compute(A);
}

std::vector<Index> PivotedQr::order() const {
  const auto& indices = qr_.colsPermutation().indices();
  return {indices.begin(), indices.end()};
}

MatrixXd PivotedQr::R() const {
  return qr_.matrixQR().topRows(std::min(qr_.rows(), qr_.cols())).triangularView<Eigen::Upper>();
}

MatrixXd PivotedQr::basis() const {
  return qr_.householderQ() * MatrixXd::Identity(qr_.rows(), qr_.rank());
}

VectorXd PivotedQr::rotated(const VectorXd& b) const {
  return qr_.householderQ().transpose() * b;
}

VectorXd PivotedQr::solve(const VectorXd& b) const {
  // Eigen's own takes pivots below the threshold for numbers.
  const Index count = rank();
  VectorXd head = rotated(b).head(count);
  qr_.matrixQR().topLeftCorner(count, count).triangularView<Eigen::Upper>().solveInPlace(head);
  VectorXd x = VectorXd::Zero(qr_.cols());
  for (Index k = 0; k < count; ++k) x(qr_.colsPermutation().indices()(k)) = head(k);
  return x;
}

}  // namespace deltadyn::dense
