#include "fit_metric.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "deltadyn/runtime/dense.hpp"

namespace deltadyn::fit {
namespace {

constexpr double kSqrt2 = 1.4142135623730951;

/// rho of metric_residual and its derivative, from log l.
struct Rho {
  double value, slope;
};

Rho rho(double l, FitMetric metric) {
  const double e = l - 1;
  if (metric == FitMetric::riemannian) return {std::log(l) / kSqrt2, 1 / (l * kSqrt2)};
  // rho^2 = e^2/2 - e^3/3 + e^4/4 - ...; near l = 1 the closed form loses half its digits
  if (std::abs(e) < 1e-2) {
    double series = 0, slope_series = 0;  // rho^2 = e^2 h(e), h' by terms
    for (int k = 8; k >= 0; --k) {
      const double c = (k % 2 == 0 ? 1.0 : -1.0) / (k + 2);
      series = series * e + c;
    }
    for (int k = 8; k >= 1; --k) {
      const double c = (k % 2 == 0 ? 1.0 : -1.0) / (k + 2);
      slope_series = slope_series * e + c * k;
    }
    const double root = std::sqrt(series);
    return {e * root, root + 0.5 * e * slope_series / root};
  }
  const double value = std::copysign(std::sqrt(e - std::log1p(e)), e);
  return {value, 0.5 * (1 - 1 / l) / value};
}

double divided_difference(double a, double b, const Rho& at_a, const Rho& at_b, FitMetric metric) {
  if (std::abs(a - b) > 1e-4 * (std::abs(a) + std::abs(b))) return (at_a.value - at_b.value) / (a - b);
  return rho(0.5 * (a + b), metric).slope;  // exact to second order in the distance
}

}  // namespace

bool is_relative(const Block& block, FitMetric metric) {
  return metric == FitMetric::relative || block.metric.size == 0;
}

int residual_size(const Block& block, FitMetric metric) {
  if (is_relative(block, metric)) return block.fitted();
  return block.metric.size * (block.metric.size + 1) / 2;
}

bool metric_residual(const Block& block, const Layout& layout, FitMetric metric,
                     const Eigen::Ref<const Eigen::VectorXd>& y, Eigen::Ref<Eigen::VectorXd> residual,
                     Eigen::MatrixXd* jacobian) {
  if (is_relative(block, metric)) {
    if (jacobian != nullptr) jacobian->setZero(block.fitted(), block.fitted());
    for (int i = 0; i < block.fitted(); ++i) {
      const double scale = layout.scale(block.column + block.entries[static_cast<std::size_t>(i)]);
      residual(i) = (y(i) - layout.prior(block.y + i)) / scale;
      if (jacobian != nullptr) (*jacobian)(i, i) = 1 / scale;
    }
    return true;
  }
  const int n = block.metric.size;
  const Eigen::Matrix4d& C = block.metric_root;
  const Eigen::Matrix4d L4 = C.transpose() * block.metric(y) * C;
  const dense::Spectrum spectrum = dense::spectrum(L4.topLeftCorner(n, n));
  const Eigen::VectorXd& l = spectrum.values;
  const Eigen::MatrixXd& V = spectrum.vectors;
  if (!(l(0) > 0)) return false;
  std::vector<Rho> values;
  for (int i = 0; i < n; ++i) values.push_back(rho(l(i), metric));
  auto to_vector = [n](const Eigen::MatrixXd& S, auto&& out) {
    int row = 0;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i <= j; ++i) out(row++) = i == j ? S(i, j) : kSqrt2 * S(i, j);
    }
  };
  Eigen::VectorXd diagonal(n);
  for (int i = 0; i < n; ++i) diagonal(i) = values[static_cast<std::size_t>(i)].value;
  to_vector(V * diagonal.asDiagonal() * V.transpose(), residual);
  if (jacobian == nullptr) return true;
  jacobian->resize(residual_size(block, metric), block.fitted());
  Eigen::MatrixXd differences(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      differences(i, j) = divided_difference(l(i), l(j), values[static_cast<std::size_t>(i)],
                                             values[static_cast<std::size_t>(j)], metric);
    }
  }
  for (int k = 0; k < block.fitted(); ++k) {
    const Eigen::Matrix4d dL4 = C.transpose() * block.metric.basis[static_cast<std::size_t>(k)] * C;
    const Eigen::MatrixXd inner = V.transpose() * dL4.topLeftCorner(n, n) * V;
    to_vector(V * differences.cwiseProduct(inner) * V.transpose(), jacobian->col(k));
  }
  return true;
}

bool log_det_barrier(const LinearMatrix& matrix, const Eigen::Ref<const Eigen::VectorXd>& x, double& value,
                     Eigen::VectorXd* gradient, Eigen::MatrixXd* hessian) {
  const int n = matrix.size;
  Eigen::Matrix4d M = matrix(x);
  for (int i = n; i < 4; ++i) M(i, i) = 1;  // the unused corner: determinant 1
  const Eigen::LLT<Eigen::Matrix4d> factor(M);
  if (factor.info() != Eigen::Success || !(factor.matrixLLT().diagonal().minCoeff() > 0)) return false;
  value = -2 * factor.matrixLLT().diagonal().array().log().sum();
  if (gradient == nullptr) return true;
  const auto count = static_cast<Eigen::Index>(matrix.basis.size());
  gradient->resize(count);
  hessian->resize(count, count);
  // tr(M^-1 E_i M^-1 E_j) = <K_i, K_j> with the symmetric K_i = L^-1 E_i L^-T
  Eigen::Matrix<double, 16, Eigen::Dynamic> K(16, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    Eigen::Matrix4d inner = factor.matrixL().solve(matrix.basis[static_cast<std::size_t>(i)]);
    inner = factor.matrixL().solve(inner.transpose()).eval();
    (*gradient)(i) = -inner.trace();
    K.col(i) = Eigen::Map<const Eigen::Matrix<double, 16, 1>>(inner.data());
  }
  hessian->noalias() = K.transpose() * K;
  return true;
}

bool metric_terms(const Block& block, const Layout& layout, FitMetric metric,
                  const Eigen::Ref<const Eigen::VectorXd>& y, double& value, Eigen::VectorXd* gradient,
                  Eigen::MatrixXd* hessian) {
  if (is_relative(block, metric) || metric == FitMetric::riemannian) {
    Eigen::VectorXd residual(residual_size(block, metric));
    Eigen::MatrixXd jacobian;
    if (!metric_residual(block, layout, metric, y, residual, gradient != nullptr ? &jacobian : nullptr)) return false;
    value = residual.squaredNorm();
    if (gradient != nullptr) {
      *gradient = 2 * jacobian.transpose() * residual;
      *hessian = 2 * jacobian.transpose() * jacobian;
    }
    return true;
  }
  // tr L - log det L - n with log det L = log det Q + 2 log |det C|
  if (!log_det_barrier(block.metric, y, value, gradient, hessian)) return false;
  const int n = block.metric.size;
  const Eigen::Matrix4d inverse = block.metric_root * block.metric_root.transpose();
  value += inverse.cwiseProduct(block.metric(y)).sum() - n -
           2 * block.metric_root.diagonal().head(n).array().abs().log().sum();
  if (gradient != nullptr) {
    for (int i = 0; i < block.fitted(); ++i)
      (*gradient)(i) += inverse.cwiseProduct(block.metric.basis[static_cast<std::size_t>(i)]).sum();
  }
  return true;
}

}  // namespace deltadyn::fit
