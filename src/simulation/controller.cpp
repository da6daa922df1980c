#include "deltadyn/simulation/controller.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/workspace.hpp"

namespace deltadyn {

void ControllerOptions::validate(int drives) const {
  const auto require = [](bool good, const std::string& what, const std::string& mend) {
    if (!good) throw Error("controller: " + what, "", mend, ExitCode::usage);
  };
  require(bandwidth_hz > 0 && bandwidth_hz < 1000, fmt::format("a bandwidth of {} Hz", bandwidth_hz),
          "give a few Hz to some ten Hz");
  require(damping_ratio > 0 && damping_ratio < 10, fmt::format("a damping ratio of {}", damping_ratio),
          "0.7 to 1 is usual");
  require(rate_filter_hz > 0, fmt::format("a rate filter at {} Hz", rate_filter_hz), "give a positive frequency");
  for (const auto* gains : {&kp, &kd}) {
    require(gains->empty() || static_cast<int>(gains->size()) == drives,
            fmt::format("{} gains for {} drives", gains->size(), drives), "give one for each drive");
    for (const double gain : *gains)
      require(gain >= 0 && std::isfinite(gain), fmt::format("a gain of {}", gain), "gains are positive");
  }
}

namespace {

/// Share of a drive's inertia below which a loop that is laid out for all of it shakes at its sampling rate.
constexpr double kLeastShare = 0.2;

/// What is left of the drives' inertias where all drives move the way that is lightest: the smallest eigenvalue of the
/// mass matrix in units of its diagonal, over the workspace. 0.23 or more for a Delta, 0.1 for four coupled limbs.
double least_inertia_share(const Robot& robot, const Eigen::VectorXd& p) {
  constexpr int kPoses = 200;
  constexpr double kLeast = 0.05;  // a model that is not consistent must not turn the sign of the gains
  WorkspaceSampler sampler(robot, 1);
  Eigen::VectorXd q;
  Eigen::MatrixXd M(robot.drives(), robot.drives());
  double least = 1;
  for (int k = 0; k < kPoses; ++k) {
    sampler.next(q);
    if (robot.mass_matrix(q, p, M) != Status::ok) continue;
    const Eigen::VectorXd unit = M.diagonal().cwiseSqrt().cwiseInverse();
    least = std::min(least, dense::eigenvalues(unit.asDiagonal() * M * unit.asDiagonal())(0));
  }
  return std::max(least, kLeast);
}

}  // namespace

Controller::Controller(const Robot& robot, const Eigen::VectorXd& p, const ControllerOptions& options, double period_s,
                       const Eigen::VectorXd& home)
    : robot_(robot), p_(p), rigid_(p), options_(options), period_(period_s) {
  const int n = robot.drives();
  options.validate(n);
  for (int k = 0; k < robot.parameters(); ++k)
    if (robot.parameter_ids()[static_cast<std::size_t>(k)].is_friction()) rigid_(k) = 0;
  filter_ = std::exp(-2 * std::numbers::pi * options.rate_filter_hz * period_s);
  const double omega = 2 * std::numbers::pi * options.bandwidth_hz;
  Eigen::VectorXd inertia = Eigen::VectorXd::Ones(n);
  if (options.law != ControlLaw::computed_torque) {
    Eigen::MatrixXd M(n, n);
    if (robot.mass_matrix(home, p, M) != Status::ok)
      throw Error("the motion starts out of reach or in a singular pose", "trajectory",
                  "check the units of the trajectory, and that it was planned for this robot file");
    const bool by_default = options.kp.empty() || options.kd.empty();
    const double share = by_default ? least_inertia_share(robot, p) : kLeastShare;
    inertia = M.diagonal() * std::min(1.0, share / kLeastShare);
  }
  kp_ = omega * omega * inertia;
  kd_ = 2 * options.damping_ratio * omega * inertia;
  if (!options.kp.empty()) kp_ = Eigen::Map<const Eigen::VectorXd>(options.kp.data(), n);
  if (!options.kd.empty()) kd_ = Eigen::Map<const Eigen::VectorXd>(options.kd.data(), n);
}

Eigen::VectorXd Controller::inverse(const Eigen::VectorXd& q, const Eigen::VectorXd& qd, const Eigen::VectorXd& qdd,
                                    const Eigen::VectorXd& p) const {
  Eigen::VectorXd tau(q.size());
  if (const Status status = robot_.inverse_dynamics(q, qd, qdd, p, tau); status != Status::ok) {
    throw Error(fmt::format("the controller's model cannot follow: {}", message(status)), "simulation",
                "check gains and trajectory; the robot may have left its reach", ExitCode::no_convergence);
  }
  return tau;
}

Eigen::VectorXd Controller::torque(const ReferenceMotion::State& reference, const Eigen::VectorXd& measured) {
  const Eigen::VectorXd error = reference.q - measured;
  if (!begun_) {
    error_rate_.setZero(error.size());
  } else {
    error_rate_ = filter_ * error_rate_ + (1 - filter_) * (error - error_) / period_;
  }
  error_ = error;
  begun_ = true;
  const Eigen::VectorXd push = kp_.cwiseProduct(error) + kd_.cwiseProduct(error_rate_);
  if (options_.law == ControlLaw::pd_feedforward) {
    if (!options_.feed_forward) return push;
    return inverse(reference.q, reference.qd, reference.qdd, p_) + push;
  }
  // Friction of the planned rate: with the measured one, noise around rest would flip its sign at every sample.
  const Eigen::VectorXd friction =
      inverse(reference.q, reference.qd, reference.qdd, p_) - inverse(reference.q, reference.qd, reference.qdd, rigid_);
  const Eigen::VectorXd rate = reference.qd - error_rate_;
  if (options_.law == ControlLaw::computed_torque)
    return inverse(measured, rate, reference.qdd + push, rigid_) + friction;
  // C(q, a) b with Christoffel's symbols is symmetric in a and b, so it follows from the squares c(v) = C(q, v) v.
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(error.size());
  const Eigen::VectorXd gravity = inverse(measured, zero, zero, rigid_);
  const Eigen::VectorXd coriolis = 0.25 * (inverse(measured, rate + reference.qd, zero, rigid_) -
                                           inverse(measured, rate - reference.qd, zero, rigid_));
  const Eigen::VectorXd inertial = inverse(measured, zero, reference.qdd, rigid_) - gravity;
  return inertial + coriolis + gravity + friction + push;
}

}  // namespace deltadyn
