#include "fit_convex.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "deltadyn/runtime/dense.hpp"

#include "fit_metric.hpp"

namespace deltadyn::fit {
namespace {

constexpr double kFinalBarrier = 1e-5;  // chi^2 an eigenvalue of a cone; far below what any statistic can see
constexpr double kFirstBarrier = 1.0;   // at least, and ...
constexpr double kFirstOfStart = 0.01;  // ... of the cost at the start: a damped step gains about a barrier's worth
constexpr double kDeepestCut = 0.03;
constexpr double kGentleCut = 0.7;  // from which no centre is too far
constexpr int kMostSteps = 25;      // to a centre; with more the cut was too deep
constexpr int kFewSteps = 5;        // with fewer the next cut is deeper,
constexpr double kDeepening = 1.5;  // by this power, less than going back takes off
constexpr double kObjectiveRounding = 1e-10;
constexpr int kMaxNewton = 1000;

}  // namespace

ConvexProblem::ConvexProblem(const Layout& layout, const Eigen::MatrixXd& A, const Eigen::VectorXd& b)
    : layout_(layout), A_(A), b_(b), scale_(layout.convex), centring_(Eigen::VectorXd::Zero(layout.convex)) {
  scale_.head(layout.fitted) = layout.scale(layout.y_to_p);
  for (const Block& block : layout.blocks) {
    if (block.split >= 0) scale_(block.split) = block.anchor(block.inertia);
  }
  const Eigen::VectorXd start = convex_start(layout);
  for (const Block& block : layout.blocks) {
    if (block.cone.size == 0) continue;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd hessian;
    double value = 0;
    if (!log_det_barrier(block.cone, block.gather(start), value, &gradient, &hessian)) continue;
    centring_.segment(block.y, block.fitted()) = -gradient.head(block.fitted());
    if (block.split >= 0) centring_(block.split) = -gradient(block.fitted());
  }
  // Normal equations of a problem with far more digits in some directions than in others lose the weak ones. In the
  // singular directions the data term is diagonal, and nothing blurs.
  const int n = layout.fitted;
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(n);
  const auto rows = std::min<Eigen::Index>(A_.rows(), n);
  square.topRows(rows) = A_.topRows(rows) * scale_.head(n).asDiagonal();
  rhs.head(rows) = b_.head(rows);
  const dense::SingularValues svd = dense::svd(square);
  singular_ = svd.values;
  V_ = svd.V;
  target_ = svd.U.transpose() * rhs;
}

double ConvexProblem::regularization_cost(FitMetric metric, const Eigen::VectorXd& y) const {
  double sum = 0;
  for (const Block& block : layout_.blocks) {
    Eigen::VectorXd residual(residual_size(block, metric));
    if (!metric_residual(block, layout_, metric, y.segment(block.y, block.fitted()), residual, nullptr)) {
      return std::numeric_limits<double>::infinity();
    }
    sum += residual.squaredNorm();
  }
  return sum;
}

bool ConvexProblem::separable_terms(FitMetric metric, double lambda, double barrier, const Eigen::VectorXd& x,
                                    Terms& terms, bool derivatives) const {
  terms.value = 0;
  if (derivatives) {
    terms.gradient.setZero(layout_.convex);
    terms.factor.setZero(layout_.convex, layout_.convex);
  }
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
  for (const Block& block : layout_.blocks) {
    const Eigen::VectorXd own = block.gather(x);
    const auto n = own.size();
    const int count = block.fitted();
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
    double value = 0;
    if (!metric_terms(block, layout_, metric, own.head(count), value, derivatives ? &gradient : nullptr, &hessian))
      return false;
    terms.value += lambda * value;
    if (derivatives) {
      g.head(count) += lambda * gradient;
      H.topLeftCorner(count, count) += lambda * hessian;
    }
    if (block.cone.size > 0) {
      if (!log_det_barrier(block.cone, own, value, derivatives ? &gradient : nullptr, &hessian)) return false;
      // The barrier is the log-det divergence from the anchor. A plain -log det has no minimum where neither the data
      // nor a weak lambda hold a body, and would send it to infinity. The last stage does without the divergence's
      // linear part: from a thin anchor it would bias the result by more than the certificate admits.
      const Eigen::VectorXd centring =
          barrier > kFinalBarrier ? block.gather(centring_) : Eigen::VectorXd::Zero(n).eval();
      terms.value += barrier * (value + centring.dot(own));
      if (derivatives) {
        g += barrier * (gradient + centring);
        H += barrier * hessian;
      }
    }
    if (!derivatives) continue;
    Eigen::VectorXi index(n);
    for (int i = 0; i < count; ++i) index(i) = block.y + i;
    if (block.split >= 0) index(count) = block.split;
    for (Eigen::Index i = 0; i < n; ++i) {
      g(i) *= scale_(index(i));
      for (Eigen::Index j = 0; j < n; ++j) H(i, j) *= scale_(index(i)) * scale_(index(j));
    }
    const Eigen::MatrixXd L = dense::cholesky(H).L;
    for (Eigen::Index i = 0; i < n; ++i) {
      terms.gradient(index(i)) = g(i);
      for (Eigen::Index j = 0; j <= i; ++j) terms.factor(index(i), index(j)) = L(i, j);
    }
  }
  return true;
}

Eigen::VectorXd ConvexProblem::residual_at(const Eigen::VectorXd& scaled) const {
  return singular_.cwiseProduct(V_.transpose() * scaled.head(layout_.fitted)) - target_;
}

ConvexProblem::Newton ConvexProblem::newton_step(const Terms& terms, const Eigen::VectorXd& residual) const {
  const int n = layout_.convex, fitted = layout_.fitted;
  // in (V^T y, splits)
  Eigen::VectorXd gradient = terms.gradient;
  gradient.head(fitted) = V_.transpose() * terms.gradient.head(fitted) + 2 * singular_.cwiseProduct(residual);
  // The Newton matrix is stacked^T stacked. Where a body nears the boundary it spreads over more than the digits there
  // are, and its Cholesky factor would need a ridge that hides what descent is left; a QR of the stack needs half the
  // digits.
  Eigen::MatrixXd stacked = Eigen::MatrixXd::Zero(n + fitted, n);
  stacked.topRows(n) = terms.factor.transpose();
  stacked.topLeftCorner(n, fitted) = terms.factor.topRows(fitted).transpose() * V_;
  stacked.bottomLeftCorner(fitted, fitted).diagonal() = std::sqrt(2.0) * singular_;
  const Eigen::MatrixXd R = dense::r_factor(stacked);
  Newton newton;
  newton.step = -dense::solve_upper(R, dense::solve_upper_transposed(R, gradient));
  newton.decrement = -gradient.dot(newton.step);
  newton.step.head(fitted) = (V_ * newton.step.head(fitted)).eval();
  return newton;
}

/// Moves to the full step or the first of its halves that gains enough; false if none does.
bool ConvexProblem::search_line(FitMetric metric, double lambda, double barrier, const Terms& terms,
                                const Newton& newton, Iterate& at) const {
  const double value = at.residual.squaredNorm() + terms.value;
  double length = 1;
  for (int trial = 0; trial < 60 && newton.decrement > 0; ++trial, length *= 0.5) {
    Iterate candidate{at.x + length * newton.step, {}};
    Terms there;
    if (!separable_terms(metric, lambda, barrier, candidate.x.cwiseProduct(scale_), there, false)) continue;
    candidate.residual = residual_at(candidate.x);
    if (candidate.residual.squaredNorm() + there.value > value - 1e-4 * length * newton.decrement) continue;
    at = candidate;
    return true;
  }
  return false;
}

ConvexProblem::Result ConvexProblem::minimise(FitMetric metric, double lambda, const Eigen::VectorXd& start) const {
  Result result;
  Iterate at{start.cwiseQuotient(scale_), {}};
  at.residual = residual_at(at.x);
  double barrier = std::max(kFirstBarrier, kFirstOfStart * at.residual.squaredNorm());
  Iterate centred;
  double centred_barrier = 0, cut = kDeepestCut;
  int steps = 0;  // since the barrier was cut
  Terms terms;
  while (result.iterations < kMaxNewton) {
    ++result.iterations;
    ++steps;
    if (!separable_terms(metric, lambda, barrier, at.x.cwiseProduct(scale_), terms, true)) return result;
    const double value = at.residual.squaredNorm() + terms.value;
    const Newton newton = newton_step(terms, at.residual);
    if (!newton.step.allFinite()) return result;
    const bool accepted = search_line(metric, lambda, barrier, terms, newton, at);
    const double decrement = newton.decrement;
    const bool is_centred = decrement <= (barrier > kFinalBarrier ? 0.5 : 0.1) * barrier;  // well enough
    if (!is_centred && accepted) {
      if (steps < kMostSteps || centred.x.size() == 0 || barrier > kGentleCut * centred_barrier) continue;
      // Where the boundary bends, a deep cut ends next to it, from where steps along it are short: go back, cut less.
      at = centred;
      cut = std::sqrt(barrier / centred_barrier);
      barrier = centred_barrier;
    } else if (barrier <= kFinalBarrier) {
      // a line search that fails counts as converged only where no more than rounding is left to gain
      result.converged = decrement <= std::max(barrier, kObjectiveRounding * (1 + std::abs(value)));
      break;
    } else if (is_centred) {
      centred = at;
      centred_barrier = barrier;
      if (steps < kFewSteps) cut = std::max(std::pow(cut, kDeepening), kDeepestCut);
    }
    barrier = std::max(barrier * cut, kFinalBarrier);
    steps = 0;
  }
  result.x = at.x.cwiseProduct(scale_);
  return result;
}

namespace {

/// Dual of one block's cone: the gradient as symmetric matrices that must be positive semidefinite, scaled to the
/// anchor.
struct Dual {
  double min_eigenvalue = 0;
  Eigen::VectorXd identity;  // gradient that shifts every eigenvalue by 1
};

double min_eigenvalue(const Eigen::MatrixXd& M) {
  return dense::eigenvalues(M)(0);
}

Dual dual_of(const Block& block, const Eigen::VectorXd& g) {
  Dual dual;
  dual.identity.setZero(block.fitted());
  if (block.shape == BlockKind::spatial) {
    InertialVector<double> g10 = InertialVector<double>::Zero();
    for (int i = 0; i < block.fitted(); ++i) g10(block.entries[static_cast<std::size_t>(i)]) = g(i);
    const Eigen::Vector4d size = to_pseudo_inertia(block.anchor).diagonal().cwiseSqrt();
    dual.min_eigenvalue = min_eigenvalue(size.asDiagonal() * dual_pseudo_inertia(g10) * size.asDiagonal());
    // <I, D^-1 Mbar(p) D^-1> as a linear function of p
    for (int i = 0; i < block.fitted(); ++i) {
      const Eigen::Matrix4d basis = block.cone.basis[static_cast<std::size_t>(i)];
      dual.identity(i) = basis.diagonal().cwiseQuotient(size.cwiseAbs2()).sum();
    }
  } else if (block.shape == BlockKind::planar) {
    // The cone (|a| + |b|)^2 <= m I has the dual max(|g_a|, |g_b|)^2 <= 4 g_m g_I: two 2 x 2 matrices (the completion
    // of S_ab).
    const double m = block.anchor(inertial::kM), I = block.anchor(block.inertia);
    for (int j = 0; j < 2; ++j) {
      Eigen::Matrix2d G;
      G << g(3) * I, 0.5 * g(1 + j) * std::sqrt(m * I), 0.5 * g(1 + j) * std::sqrt(m * I), g(0) * m;
      const double smallest = min_eigenvalue(G);
      dual.min_eigenvalue = j == 0 ? smallest : std::min(dual.min_eigenvalue, smallest);
    }
    dual.identity(0) = 1 / m;
    dual.identity(3) = 1 / I;
  } else if (block.shape != BlockKind::free) {
    dual.min_eigenvalue = g(0) * block.anchor(0);
    dual.identity(0) = 1 / block.anchor(0);
  }
  return dual;
}

}  // namespace

/// Near the central path: the slope of the barrier after one more Newton step. It lies in the dual cone where that step
/// stays in the barrier's Dikin ellipsoid, and what it leaves of J's slope, the step times J's Hessian, is as small as
/// the step.
std::optional<Eigen::VectorXd> ConvexProblem::barrier_dual(FitMetric metric, double lambda,
                                                           const Eigen::VectorXd& x) const {
  Terms terms;
  if (!separable_terms(metric, lambda, kFinalBarrier, x, terms, true)) return std::nullopt;
  const Eigen::VectorXd step = newton_step(terms, residual_at(x.cwiseQuotient(scale_))).step.cwiseProduct(scale_);
  if (!step.allFinite()) return std::nullopt;
  Eigen::VectorXd z = Eigen::VectorXd::Zero(layout_.fitted);
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
  for (const Block& block : layout_.blocks) {
    double value = 0;
    if (block.cone.size == 0) continue;
    if (!log_det_barrier(block.cone, block.gather(x), value, &gradient, &hessian)) return std::nullopt;
    z.segment(block.y, block.fitted()) =
        -kFinalBarrier * (gradient + hessian * block.gather(step)).head(block.fitted());
  }
  return z;
}

OptimalityCertificate ConvexProblem::certify(FitMetric metric, double lambda, const Eigen::VectorXd& x) const {
  OptimalityCertificate certificate;
  if (metric == FitMetric::riemannian) return certificate;
  const int n = layout_.fitted;
  const Eigen::VectorXd y = x.head(n), scale = scale_.head(n);
  const std::optional<Eigen::VectorXd> dual =
      x.size() == layout_.convex ? barrier_dual(metric, lambda, x) : std::nullopt;
  // J(y') >= J(y) + g.(y'-y) + ||A (y'-y)||^2 + lambda (D's own growth). For any z in the dual cone, z.y' >= z.floor,
  // so that
  //   gap <= z.(y - floor) + max over steps of -(g - z).step - growth(step),
  // where growth is a quadratic form H (relative), or a self-concordant function with Hessian H (bregman). Slopes and H
  // stand in the singular directions of the data, in which sharp and weak ones do not blur each other.
  Eigen::VectorXd of_metric(n);                               // lambda D'
  Eigen::MatrixXd stacked = Eigen::MatrixXd::Zero(2 * n, n);  // R^T R = half the Hessian of J
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
  for (const Block& block : layout_.blocks) {
    const int count = block.fitted();
    double value = 0;
    if (!metric_terms(block, layout_, metric, y.segment(block.y, count), value, &gradient, &hessian))
      return certificate;
    of_metric.segment(block.y, count) = lambda * gradient;
    stacked.block(n + block.y, block.y, count, count) =
        dense::cholesky(0.5 * lambda * hessian).L.transpose() * scale.segment(block.y, count).asDiagonal();
  }
  stacked.bottomRows(n) = (stacked.bottomRows(n) * V_).eval();
  stacked.topRows(n) = singular_.asDiagonal();
  const Eigen::VectorXd whole = 2 * singular_.cwiseProduct(residual_at(x.cwiseQuotient(scale_.head(x.size())))) +
                                V_.transpose() * scale.cwiseProduct(of_metric);
  const Eigen::VectorXd z = dual ? *dual : Eigen::VectorXd((V_ * whole).cwiseQuotient(scale));

  double at_y = 0;
  certificate.min_dual_eigenvalue = std::numeric_limits<double>::infinity();
  Eigen::VectorXd shifted = Eigen::VectorXd::Zero(n);
  for (const Block& block : layout_.blocks) {
    const int count = block.fitted();
    const Eigen::VectorXd own = z.segment(block.y, count);
    if (block.shape == BlockKind::free) {
      shifted.segment(block.y, count) = -own;
      continue;
    }
    const Dual cone = dual_of(block, own);
    if (cone.min_eigenvalue < certificate.min_dual_eigenvalue) {
      certificate.min_dual_eigenvalue = cone.min_eigenvalue;
      certificate.min_dual_name = block.name;
    }
    Eigen::VectorXd above = y.segment(block.y, count);
    above(0) -= block.mass_floor;
    shifted.segment(block.y, count) = std::max(0.0, -cone.min_eigenvalue) * cone.identity;
    at_y += (own + shifted.segment(block.y, count)).dot(above);
  }
  const Eigen::VectorXd slope =
      (dual ? Eigen::VectorXd(whole - V_.transpose() * scale.cwiseProduct(z)) : Eigen::VectorXd::Zero(n)) -
      V_.transpose() * scale.cwiseProduct(shifted);
  const Eigen::MatrixXd R = dense::r_factor(stacked);
  auto growth_bound = [&](const Eigen::VectorXd& left) {
    const double quarter = 0.25 * dense::solve_upper_transposed(R, left).squaredNorm();
    if (!std::isfinite(quarter)) return std::numeric_limits<double>::infinity();
    if (metric == FitMetric::relative) return quarter;
    const double decrement = std::sqrt(2 * quarter / lambda);  // of J / lambda, which is self-concordant
    if (decrement >= 1) return std::numeric_limits<double>::infinity();
    return lambda * (-decrement - std::log1p(-decrement));
  };
  // z = 0 is a dual point too, and the better one where the optimum is inside the cones
  certificate.gap = std::min(std::max(at_y, 0.0) + growth_bound(slope), growth_bound(whole));
  certificate.available = true;
  return certificate;
}

}  // namespace deltadyn::fit
