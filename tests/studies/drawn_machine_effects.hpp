#pragma once

/// \file
/// The other hidden effects of drawn robots: of the machine's bodies and lengths, of the plate, of the record; and what
/// the catalogue does not have.

#include "studies/drawn_effects.hpp"

namespace deltadyn::blind {

/// Adds to a parameter of the plant, whose limbs have parameters of their own.
inline void add_to(const Robot& robot, const std::string& name, double value, Eigen::VectorXd& p) {
  for (int k = 0; k < robot.parameters(); ++k) {
    if (robot.parameter_names()[static_cast<std::size_t>(k)] == name) p(k) += value;
  }
}

inline double parameter_of(const Machine& m, const std::string& name) {
  const auto robot = make_robot(m.robot, m.layout);
  for (int k = 0; k < robot->parameters(); ++k) {
    if (robot->parameter_names()[static_cast<std::size_t>(k)] == name) return m.parameters(k);
  }
  return 0;
}

inline std::optional<Hidden> hidden_body(const std::string& name, const Site& site, double u, Random& random) {
  const int limb = site.limb;
  const std::string joint = "drive" + std::to_string(limb + 1);
  if (name == "joint_elasticity") {
    Hidden out{name, joint, {}, 0, {}, {}, {}, 0};
    const double hz = std::max(14.0, (26 + 16 * (1 - site.size)) / std::sqrt(site.gain));
    out.spring = Spring{limb, hz, u < 0.5};
    return sized(out, std::pow(2 * kPi * hz, -2));
  }
  if (name == "rotor_inertia") {
    Hidden out{name, joint, {}, 0, {}, {}, {}, 0};
    const double more = site.at(limb).inertia * site.amplitude(0.02, 0.14, 0.8);
    out.parameters = [=](const Robot& robot, int, Eigen::VectorXd& p) {
      add_to(robot, joint + ".rotor_inertia", more, p);
    };
    return sized(out, more);
  }
  if (name == "limb_inertia_mismatch") {  // a lump of mass on one arm
    Hidden out{name, joint, {}, 0, {}, {}, {}, 0};
    const double x = site.machine.length * (0.4 + 0.5 * u);
    const double m = site.at(limb).inertia / (x * x) * site.amplitude(0.03, 0.25, 1.0);
    out.parameters = [=](const Robot& robot, int, Eigen::VectorXd& p) {
      const std::string arm = "upper_arm" + std::to_string(limb + 1);
      add_to(robot, arm + ".m", m, p);
      add_to(robot, arm + ".mcx", m * x, p);
      add_to(robot, arm + ".Iyy", m * x * x, p);
      add_to(robot, arm + ".Izz", m * x * x, p);
    };
    return sized(out, m * x);
  }
  if (name == "base_tilt") {
    Hidden out{name, "robot", {}, 0, {}, {}, {}, 0};
    const double angle = site.amplitude(0.006, 0.056, 0.12), about = between(random, 0, 6.28);
    out.robot = [=](RobotDescription& robot) {
      robot.gravity = 9.81 * Eigen::Vector3d(std::sin(angle) * std::cos(about), std::sin(angle) * std::sin(about),
                                             -std::cos(angle));
    };
    return sized(out, angle);
  }
  if (name == "payload") {
    Hidden out{name, "platform", {}, 0, {}, {}, {}, 0};
    const double m = (parameter_of(site.machine, "platform.m") + parameter_of(site.machine, "tool.m")) *
                     site.amplitude(0.05, 0.5, 2.5);
    out.parameters = [=](const Robot& robot, int log, Eigen::VectorXd& p) {
      if (log == 0) add_to(robot, "platform.m", m, p);
    };
    return sized(out, m);
  }
  return std::nullopt;
}

inline std::optional<Hidden> hidden_record(const std::string& name, const Site& site, double u) {
  const int limb = site.limb;
  const std::string joint = "drive" + std::to_string(limb + 1);
  const std::string all = site.machine.robot.drives() > 1 ? "robot" : "drive1";
  if (name == "torque_constant_error") {
    Hidden out{name, joint, {}, 0, {}, {}, {}, 0};
    const double eps = (u > 0.5 ? 1 : -1) * site.amplitude(0.01, 0.09, 0.25);
    out.record = [=](int, Eigen::MatrixXd& tau, Eigen::MatrixXd&, double) { tau.col(limb) *= 1 + eps; };
    return sized(out, std::abs(eps));
  }
  if (name == "time_skew") {
    Hidden out{name, all, {}, 0, {}, {}, {}, 0};
    const double delay = site.amplitude(0.0016, 0.0066, 0.01);
    out.record = [=](int, Eigen::MatrixXd& tau, Eigen::MatrixXd&, double dt) {
      const Eigen::MatrixXd x = tau;
      for (Eigen::Index k = 0; k < x.rows(); ++k) {
        const double at = std::max(0.0, static_cast<double>(k) - delay / dt);
        const auto low = std::min(static_cast<Eigen::Index>(at), x.rows() - 2);
        tau.row(k) = x.row(low) + (at - static_cast<double>(low)) * (x.row(low + 1) - x.row(low));
      }
    };
    return sized(out, delay);
  }
  if (name == "current_lag") {
    const double lag = site.amplitude(0.0015, 0.0055, 0.01);
    Hidden out{name, all, {}, 0, {}, {}, {}, lag};
    return sized(out, lag);
  }
  if (name == "kinematic_offset") {  // a home position that is off
    Hidden out{name, joint, {}, 0, {}, {}, {}, 0};
    const double off = site.amplitude(0.004, 0.034, 0.06) * (site.machine.turns(limb) ? 1.0 : site.machine.length);
    out.record = [=](int, Eigen::MatrixXd&, Eigen::MatrixXd& q, double) { q.col(limb).array() += off; };
    return sized(out, off);
  }
  return std::nullopt;
}

inline std::optional<Hidden> hidden_plate(const std::string& name, const Site& site, Random& random) {
  Hidden out{name, "platform", {}, 0, {}, {}, {}, 0};
  const double length = site.machine.length;
  if (name == "aerodynamic_drag") {
    const double c = site.plate_force() * site.amplitude(0.04, 0.4, 2.0);
    out.resist = [=](const Moment& m, const Eigen::VectorXd&, Eigen::VectorXd&, Eigen::VectorXd& load) {
      load += c * std::pow(m.v.norm() + 1e-9, 0.85) * (m.J.topRows<3>().transpose() * m.v);
    };
    return out;
  }
  if (name == "hose_force") {
    const Eigen::Vector3d anchor = length * Eigen::Vector3d(between(random, -0.4, 0.4), between(random, -0.4, 0.4), 0) +
                                   site.machine.home_z * Eigen::Vector3d::UnitZ();
    const double k0 = site.plate_force() / length * site.amplitude(0.1, 1.0, 4.0);
    out.resist = [=](const Moment& m, const Eigen::VectorXd&, Eigen::VectorXd&, Eigen::VectorXd& load) {
      const Eigen::Vector3d d = m.r - anchor, k(k0, 0.7 * k0, 0.3 * k0);
      load += m.J.topRows<3>().transpose() * (k.cwiseProduct(d) * (1 + 0.3 * d.norm()));
    };
    return out;
  }
  return std::nullopt;
}

inline Hidden make_drawn(const std::string& name, const Site& site, Random random) {
  const double u = between(random, 0, 1);
  if (auto found = hidden_friction(name, site, u)) return *found;
  if (auto found = hidden_loss(name, site)) return *found;
  if (auto found = hidden_position(name, site, u, random)) return *found;
  if (auto found = hidden_body(name, site, u, random)) return *found;
  if (auto found = hidden_record(name, site, u)) return *found;
  return hidden_plate(name, site, random).value();
}

/// Kinds that the catalogue does not have; those that need a second drive only where there is one.
inline Hidden make_drawn_outside(int kind, const Site& site, Random& random) {
  const int drive = site.limb, other = (drive + 1) % site.machine.limbs();
  const DriveScale& here = site.at(drive);
  const DriveScale& there = site.at(other);
  const double F = here.friction * site.amplitude(0.15, 0.55, 2.0), phase = between(random, 0, 6);
  const double width = here.sign_width(), turn = 6 / there.range, fast = site.rate(other);
  const double split = between(random, 0, 1);
  const auto unknown = [&](auto torque) { return on_drive("unknown", drive, torque); };
  const int alone[] = {0, 3, 4, 0};
  switch (other == drive ? alone[kind % 4] : kind % 7) {
    case 0: return unknown([=](const Moment& m, double, double) { return F * std::sin(2 * kPi * 1.7 * m.t + phase); });
    case 1:
      return unknown([=](const Moment& m, double v, double) {
        return F * std::sin(turn * m.q(other) + phase) * sign_of(v, width);
      });
    case 2: return unknown([=](const Moment& m, double, double) { return F * std::sin(turn * m.q(other) + phase); });
    case 3: return unknown([=](const Moment& m, double, double) { return m.t > 4 + 2 * split ? F : -F; });
    case 4:
      return unknown(
          [=](const Moment& m, double v, double) { return m.t > 4 && m.t < 6.5 ? 2 * F * sign_of(v, width) : 0.0; });
    case 5:
      return unknown([=](const Moment& m, double v, double) {
        return F * sign_of(v, width) * sign_of(m.qd(other), there.sign_width());
      });
    default:
      return unknown([=](const Moment& m, double, double) { return F * std::sin(3 * m.qd(other) / fast + phase); });
  }
}

}  // namespace deltadyn::blind
