#include "design_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "deltadyn/excitation/reversals.hpp"

namespace deltadyn::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kNegligibleWeight = 1e-13;  // of a sample in a smooth maximum

}  // namespace

/// Everything at the samples of one evaluation.
struct DesignProblem::Samples {
  double omega = 0, omega_by_variable = 0;
  MatrixXd x;       ///< 3 N x samples
  MatrixXd drives;  ///< 3 N x samples
  RowMatrix A;      ///< N samples x p: weighted columns
  MatrixXd tau;     ///< N x samples, if limited
  std::vector<MatrixXd> drive_jacobian, tau_jacobian;
};

DesignProblem::DesignProblem(const DesignSpace& space, const MotionLimits& limits, const ProblemSettings& settings)
    : space_(space), limits_(limits), settings_(settings), list_(limits.list(space.robot->description())) {
  const int n = space.regressor->drives(), terms = 1 + 2 * settings.harmonics;
  const double omega = 2 * std::numbers::pi * settings.highest_hz;
  scale_matrix_.resize(terms, n);
  for (int i = 0; i < n; ++i) {
    scale_matrix_(0, i) = space.coordinate_scale(i);
    for (int k = 1; k <= settings.harmonics; ++k) {
      const double rate = k * omega;
      const double largest = std::min(
          {space.coordinate_scale(i), space.rate_scale(i) / rate, space.acceleration_scale(i) / (rate * rate)});
      scale_matrix_(2 * k - 1, i) = scale_matrix_(2 * k, i) = largest;
    }
  }
  scale_ = scale_matrix_.reshaped();
  rate_unit_ = limits.qd;
  for (int i = 0; i < n; ++i)
    if (!std::isfinite(rate_unit_(i))) rate_unit_(i) = space.rate_scale(i);
  const VectorXd phases = even_phases(settings.samples);
  for (int d = 0; d < 3; ++d) basis_[d] = fourier_basis(phases, settings.harmonics, d);
  if (settings.sign_share > 0) {
    // Rates of the drives over the states; a further joint slides like the plate moves.
    sign_width_ = VectorXd::Constant(space.regressor->friction_joints(), space.rate_scale(0));
    MatrixXd Y(n, space.regressor->parameters());
    VectorXd drives(3 * n), squares = VectorXd::Zero(n);
    int count = 0;
    for (Index k = 0; k < std::min<Index>(200, space.states.x.cols()); ++k) {
      if (space.regressor->evaluate(space.states.x.col(k), VectorXd(), Y, drives) != Status::ok) continue;
      squares += drives.segment(n, n).cwiseAbs2();
      ++count;
    }
    sign_width_.head(n) = (3 * squares / std::max(1, count)).cwiseSqrt();
    sign_width_ *= settings.sign_share;
  }
}

FourierSeries DesignProblem::series(const VectorXd& v) const {
  FourierSeries s;
  s.base_frequency_hz = settings_.lowest_hz + (settings_.highest_hz - settings_.lowest_hz) * v(v.size() - 1);
  s.coefficients = v.head(scale_.size()).cwiseProduct(scale_).reshaped(scale_matrix_.rows(), scale_matrix_.cols());
  return s;
}

VectorXd DesignProblem::variables_of(const FourierSeries& s) const {
  VectorXd v(variables());
  v.head(scale_.size()) = VectorXd(s.coefficients.reshaped()).cwiseQuotient(scale_);
  const double width = settings_.highest_hz - settings_.lowest_hz;
  v(v.size() - 1) = width > 0 ? (s.base_frequency_hz - settings_.lowest_hz) / width : 0.0;
  return v;
}

template <class Out>
void DesignProblem::chain(const Samples& samples, Index i, const VectorXd& g, Out&& out) const {
  const Index n = g.size() / 3, terms = basis_[0].cols();
  const double w = samples.omega;
  double by_omega = 0;
  for (Index c = 0; c < n; ++c) {
    const double g0 = g(c), g1 = w * g(n + c), g2 = w * w * g(2 * n + c);
    if (g0 != 0 || g1 != 0 || g2 != 0) {
      out.segment(c * terms, terms) += (g0 * basis_[0].row(i) + g1 * basis_[1].row(i) + g2 * basis_[2].row(i))
                                           .transpose()
                                           .cwiseProduct(scale_matrix_.col(c));
      by_omega += (g(n + c) * samples.x(n + c, i) + 2 * g(2 * n + c) * samples.x(2 * n + c, i)) / w;
    }
  }
  out(scale_.size()) += by_omega * samples.omega_by_variable;
}

void DesignProblem::limit_gradient(const Limit& limit, const Samples& samples, Index i, VectorXd& g) const {
  const Index n = g.size() / 3;
  const Index k = limit.index;
  const auto at = static_cast<std::size_t>(i);
  const double slope = usage_slope(limit);
  const auto of_drives = [&](Index row) { g = slope * samples.drive_jacobian[at].row(row).transpose(); };
  g.setZero();
  switch (limit.quantity) {
    case LimitedQuantity::region: {
      Eigen::Vector3d by_r;
      limits_.region->usage(limit.index, samples.x.col(i).head<3>(), &by_r);
      g.head<3>() = by_r;
      return;
    }
    case LimitedQuantity::z: g(k) = slope; return;
    case LimitedQuantity::zd: g(n + k) = slope; return;
    case LimitedQuantity::zdd: g(2 * n + k) = slope; return;
    case LimitedQuantity::q: return of_drives(k);
    case LimitedQuantity::qd: return of_drives(n + k);
    case LimitedQuantity::qdd: return of_drives(2 * n + k);
    case LimitedQuantity::tau: g = slope * samples.tau_jacobian[at].row(k).transpose(); return;
  }
}

void DesignProblem::evaluate(const VectorXd& v, bool derivatives, Evaluation& out) const {
  const TaskRegressor& regressor = *space_.regressor;
  const Index n = regressor.drives(), p = space_.base_parameters(), count = settings_.samples;
  const double samples_real = static_cast<double>(count);
  out.regular = false;
  const FourierSeries s = series(v);
  if (!v.allFinite() || !(s.base_frequency_hz > 0)) return;
  Samples at;
  at.omega = s.omega();
  at.omega_by_variable = 2 * std::numbers::pi * (settings_.highest_hz - settings_.lowest_hz);
  at.x.resize(3 * n, count);
  for (int d = 0; d < 3; ++d)
    at.x.middleRows(d * n, n) = std::pow(at.omega, d) * (basis_[d] * s.coefficients).transpose();
  at.drives.resize(3 * n, count);
  at.A.resize(n * count, p);
  const bool torque = limits_.parameters.size() > 0;
  if (torque) at.tau.resize(n, count);
  MatrixXd Y(n, regressor.parameters());
  VectorXd x(3 * n), drives(3 * n);
  for (Index i = 0; i < count; ++i) {
    x = at.x.col(i);
    if (regressor.evaluate(x, sign_width_, Y, drives) != Status::ok) return;
    at.drives.col(i) = drives;
    if (torque) at.tau.col(i) = Y * limits_.parameters;
    for (Index k = 0; k < p; ++k) {
      at.A.col(k).segment(i * n, n) =
          Y.col(space_.base_columns[static_cast<std::size_t>(k)]).cwiseQuotient(space_.torque_scale) /
          space_.column_scale(k);
    }
  }
  out.information = MatrixXd::Zero(p, p);
  out.information.selfadjointView<Eigen::Lower>().rankUpdate(at.A.transpose(), 1 / samples_real);
  out.information = MatrixXd(out.information.selfadjointView<Eigen::Lower>());
  MatrixXd M = settings_.share * out.information;
  if (settings_.other_information.size() > 0) M += settings_.other_information;
  const CriterionValue criterion = deltadyn::evaluate(settings_.criterion, M);
  if (!criterion.regular) return;
  out.value = criterion.value;

  // Drive velocities in units of their limits, root of the mean square: the second term of (9).
  const MatrixXd share_of_limit = at.drives.middleRows(n, n).array().colwise() / rate_unit_.array();
  const double rms = std::sqrt(share_of_limit.squaredNorm() / samples_real);
  out.value += settings_.velocity_weight * rms;

  // Usages of the limits, and their smooth maximum over each window.
  const auto limits = static_cast<Index>(list_.size());
  MatrixXd usage(limits, count);
  LimitedState state;
  out.worst = -std::numeric_limits<double>::infinity();
  for (Index i = 0; i < count; ++i) {
    state.x = at.x.col(i);
    state.drives = at.drives.col(i);
    if (torque) state.tau = at.tau.col(i);
    for (Index k = 0; k < limits; ++k) {
      const Limit& limit = list_[static_cast<std::size_t>(k)];
      usage(k, i) = usage_of(limit, limited_value(limit, limits_, state));
      out.worst = std::max(out.worst, limit_load(limit, usage(k, i)));
    }
  }
  const Index windows = settings_.windows;
  out.constraints.resize(constraints());
  MatrixXd weight(limits, count);  // signed: d constraint / d usage
  for (Index k = 0; k < limits; ++k) {
    const bool both = two_sided(list_[static_cast<std::size_t>(k)]);
    for (Index w = 0; w < windows; ++w) {
      const Index first = w * count / windows, last = (w + 1) * count / windows;
      const auto part = usage.row(k).segment(first, last - first);
      const double top = both ? part.cwiseAbs().maxCoeff() : part.maxCoeff();
      double sum = 0;
      for (Index i = first; i < last; ++i) {
        const double up = std::exp(settings_.sharpness * (usage(k, i) - top));
        const double down = both ? std::exp(settings_.sharpness * (-usage(k, i) - top)) : 0.0;
        sum += up + down;
        weight(k, i) = up - down;
      }
      weight.row(k).segment(first, last - first) /= sum;
      out.constraints(k * windows + w) = top + std::log(sum) / settings_.sharpness - 1;
    }
  }
  out.regular = true;
  out.lacks_away = 0;
  if (!derivatives) return add_reversals(at, false, out);
  out.gradient = VectorXd::Zero(v.size());
  out.jacobian = MatrixXd::Zero(v.size(), constraints());
  const RowMatrix G_A = (2 * settings_.share / samples_real) * (at.A * criterion.by_M);
  at.drive_jacobian.assign(static_cast<std::size_t>(count), MatrixXd(3 * n, 3 * n));
  if (torque) at.tau_jacobian.assign(static_cast<std::size_t>(count), MatrixXd(n, 3 * n));
  MatrixXd G, gradients;
  VectorXd g(3 * n);
  std::vector<int> loaded;  // drives whose torque counts at an instant
  for (Index i = 0; i < count; ++i) {
    x = at.x.col(i);
    loaded.clear();
    for (Index k = 0; torque && k < limits; ++k) {
      const Limit& limit = list_[static_cast<std::size_t>(k)];
      if (limit.quantity == LimitedQuantity::tau && std::abs(weight(k, i)) >= kNegligibleWeight)
        loaded.push_back(limit.index);
    }
    const auto sums = static_cast<Index>(1 + loaded.size());
    G.setZero(sums * n, regressor.parameters());
    gradients.resize(3 * n, sums);
    for (Index k = 0; k < p; ++k) {
      G.col(space_.base_columns[static_cast<std::size_t>(k)]).head(n) =
          G_A.col(k).segment(i * n, n).cwiseQuotient(space_.torque_scale) / space_.column_scale(k);
    }
    for (Index k = 1; k < sums; ++k)
      G.row(k * n + loaded[static_cast<std::size_t>(k - 1)]) = limits_.parameters.transpose();
    MatrixXd& jacobian = at.drive_jacobian[static_cast<std::size_t>(i)];
    if (regressor.differentiate(x, sign_width_, G, gradients, jacobian) != Status::ok) {
      out.regular = false;
      return;
    }
    g = gradients.col(0);
    for (Index k = 1; k < sums; ++k)
      at.tau_jacobian[static_cast<std::size_t>(i)].row(loaded[static_cast<std::size_t>(k - 1)]) =
          gradients.col(k).transpose();
    if (settings_.velocity_weight != 0 && rms > 0) {
      const VectorXd by_qd = share_of_limit.col(i).cwiseQuotient(rate_unit_) / (rms * samples_real);
      g += settings_.velocity_weight * jacobian.middleRows(n, n).transpose() * by_qd;
    }
    chain(at, i, g, out.gradient);
    Index window = 0;
    while (i >= (window + 1) * count / windows) ++window;
    for (Index k = 0; k < limits; ++k) {
      if (std::abs(weight(k, i)) < kNegligibleWeight) continue;
      limit_gradient(list_[static_cast<std::size_t>(k)], at, i, g);
      g *= weight(k, i);
      chain(at, i, g, out.jacobian.col(k * windows + window));
    }
  }
  add_reversals(at, true, out);
}

/// One constraint a drive: least share away from reversals minus the mean of the smooth distances, own times that of
/// the bar.
void DesignProblem::add_reversals(const Samples& samples, bool derivatives, Evaluation& out) const {
  if (!minds_reversals()) return;
  const Index n = space_.regressor->drives(), count = settings_.samples;
  const auto first = static_cast<Index>(list_.size()) * settings_.windows;
  const RobotDescription& robot = space_.robot->description();
  const double reach = settings_.reversal_reach_s;
  constexpr double kLeastRate = 0.003;  // of the joint's scale, as the mask's floor
  const double bar_rate =               // of d . v, typical
      robot.telescope ? (space_.states.centre.head<3>() + robot.telescope->p_BV - robot.telescope->p_WU).norm() *
                            space_.rate_scale.head<3>().norm()
                      : 0.0;
  out.constraints.tail(n).setConstant(settings_.least_away);
  VectorXd g(3 * n);
  for (Index i = 0; i < count; ++i) {
    // The bar's length L turns where L dL/dt = d . v does, d from its upper to its lower joint and v the plate's
    // velocity.
    // The joints of an articulated plate turn back where the yaw does.
    SmoothDistance bar;
    Eigen::Vector3d d = Eigen::Vector3d::Zero(), v = d, a = d;
    if (robot.telescope) {
      d = samples.x.col(i).head<3>() + robot.telescope->p_BV - robot.telescope->p_WU;
      v = samples.x.col(i).segment<3>(n);
      a = samples.x.col(i).segment<3>(2 * n);
      bar = distance_from_reversal(d.dot(v), v.dot(v) + d.dot(a), reach, kLeastRate * bar_rate);
    }
    if (robot.plate)
      bar = distance_from_reversal(samples.x(n + 3, i), samples.x(2 * n + 3, i), reach,
                                   kLeastRate * space_.rate_scale(3));
    for (Index j = 0; j < n; ++j) {
      const bool with_bar = robot.feels_inner_joint(static_cast<int>(j));
      const SmoothDistance own = distance_from_reversal(samples.drives(n + j, i), samples.drives(2 * n + j, i), reach,
                                                        kLeastRate * rate_unit_(j));
      const double of_bar = with_bar ? bar.value : 1.0;
      out.constraints(first + j) -= own.value * of_bar / static_cast<double>(count);
      if (!derivatives) continue;
      const MatrixXd& J = samples.drive_jacobian[static_cast<std::size_t>(i)];
      g = of_bar * (own.by_rate * J.row(n + j) + own.by_acceleration * J.row(2 * n + j)).transpose();
      if (with_bar && robot.plate) {
        g(n + 3) += own.value * bar.by_rate;
        g(2 * n + 3) += own.value * bar.by_acceleration;
      } else if (with_bar) {
        g.head<3>() += own.value * (bar.by_rate * v + bar.by_acceleration * a);
        g.segment<3>(n) += own.value * (bar.by_rate * d + 2 * bar.by_acceleration * v);
        g.segment<3>(2 * n) += own.value * bar.by_acceleration * d;
      }
      g /= -static_cast<double>(count);
      chain(samples, i, g, out.jacobian.col(first + j));
    }
  }
  out.lacks_away = std::max(0.0, out.constraints.tail(n).maxCoeff());
}

}  // namespace deltadyn::detail
