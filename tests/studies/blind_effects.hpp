#pragma once

/// \file
/// The hidden effects of the blind study, in forms that are not the catalogue's own, off its start values.

#include <cmath>
#include <string>
#include <vector>

#include "deltadyn/runtime/random.hpp"

#include "studies/blind_plant.hpp"

namespace deltadyn::blind {

/// A drive's torque scale that effects are sized by.
inline double coulomb_of(int drive) {
  return drive == 3 ? 0.8 : 5.0;
}

/// Smoothed, as an integrator needs it; a light fourth drive needs more of it.
inline double sign_of(double v, double width = 0.008) {
  return std::tanh(v / width);
}

/// A hidden effect whose size the catalogue states in the same way.
inline Hidden sized(Hidden hidden, double amplitude) {
  hidden.amplitude = amplitude;
  return hidden;
}

using Random = std::mt19937_64;

inline double between(Random& random, double low, double high) {
  return low + (high - low) * UniformDistribution()(random);
}

/// Resistance on one drive as a function of the moment.
template <class Function>
Hidden on_drive(const std::string& truth, int drive, Function torque) {
  Hidden out{truth, "drive" + std::to_string(drive + 1), {}, 0, {}, {}, {}, 0};
  out.resist = [drive, torque](const Moment& m, const Eigen::VectorXd&, Eigen::VectorXd&, Eigen::VectorXd& load) {
    load(drive) += torque(m, m.qd(drive), m.q(drive));
  };
  return out;
}

inline const std::vector<std::string>& hidden_names() {
  static const std::vector<std::string> names = {"stribeck",
                                                 "shear_thinning",
                                                 "convex_viscous",
                                                 "asymmetric_coulomb",
                                                 "asymmetric_viscous",
                                                 "load_dependent_friction",
                                                 "directional_efficiency",
                                                 "presliding",
                                                 "hysteresis",
                                                 "torque_ripple",
                                                 "position_dependent_friction",
                                                 "joint_elasticity",
                                                 "rotor_inertia",
                                                 "limb_inertia_mismatch",
                                                 "base_tilt",
                                                 "payload",
                                                 "torque_constant_error",
                                                 "time_skew",
                                                 "current_lag",
                                                 "thermal_drift",
                                                 "aerodynamic_drag",
                                                 "hose_force",
                                                 "kinematic_offset"};
  return names;
}

/// \param size  0 barely detectable ... 1 plain
inline Hidden make_hidden(const std::string& name, int drives, double size, Random& random) {
  const int drive = static_cast<int>(between(random, 0, drives - 0.001));
  const int limb = static_cast<int>(between(random, 0, 2.999));
  const double F = coulomb_of(drive) * (0.06 + 0.44 * size), fast = drive == 3 ? 12.0 : 1.0,
               width = drive == 3 ? 0.12 : 0.008;
  const double u = between(random, 0, 1);
  if (name == "stribeck") {
    const double vs = fast * (0.06 + 0.3 * u);
    return on_drive(name, drive, [=](const Moment&, double v, double) {
      return 1.4 * F / (1 + v * v / (vs * vs)) * sign_of(v, width);
    });
  }
  if (name == "shear_thinning") {
    const double v0 = fast * (0.2 + 0.8 * u);
    return on_drive(name, drive, [=](const Moment&, double v, double) {
      return 3 * F * std::asinh(v / v0) / (1 + 0.3 * std::abs(v) / v0);
    });
  }
  if (name == "convex_viscous") {
    const double v1 = fast * 2.0;
    return on_drive(name, drive, [=](const Moment&, double v, double) {
      return 2 * F * (std::cosh(std::min(3.0, std::abs(v) / v1)) - 1) * sign_of(v, width);
    });
  }
  if (name == "asymmetric_coulomb") {
    return sized(
        on_drive(name, drive, [=](const Moment&, double v, double) { return 0.5 * F * (1 + sign_of(v, width)); }),
        0.5 * F);
  }
  if (name == "asymmetric_viscous") {
    return sized(
        on_drive(name, drive, [=](const Moment&, double v, double) { return v > 0 ? 0.8 * F * v / fast : 0.0; }),
        0.4 * F / fast);  // the other half is viscous friction
  }
  if (name == "load_dependent_friction") {
    const double mu = 0.02 + 0.10 * size;
    const int loaded = drive == 3 ? 0 : drive;
    return sized(on_drive(name, loaded,
                          [=](const Moment& m, double v, double) {
                            return mu * std::abs(m.transmitted(loaded)) * sign_of(v, 0.008);
                          }),
                 mu);
  }
  if (name == "directional_efficiency") {
    const double loss = 0.03 + 0.12 * size;
    return sized(on_drive(name, limb,
                          [=](const Moment& m, double v, double) {
                            const double power = m.transmitted(limb) * v;
                            return loss * std::abs(m.transmitted(limb)) * 0.5 * (1 + std::tanh(power / 0.5)) *
                                   sign_of(v, 0.008);
                          }),
                 loss / (1 - loss));  // of what the gear passes on
  }
  if (name == "presliding") {  // LuGre in place of part of the Coulomb friction, with bristle damping
    const double x = fast * (0.02 + 0.06 * u), share = 0.15 + 0.5 * size;
    Hidden out{name, "drive" + std::to_string(drive + 1), {}, 1, {}, {}, {}, 0};
    out.resist = [=](const Moment& m, const Eigen::VectorXd& z, Eigen::VectorXd& z_d, Eigen::VectorXd& load) {
      const double v = m.qd(drive), Fc = share * coulomb_of(drive);
      z_d(0) = v - std::abs(v) / x * z(0);
      load(drive) += Fc * (z(0) / x + 0.002 * z_d(0) - sign_of(v, width));
    };
    return out;
  }
  if (name == "hysteresis") {  // Maxwell slip: springs that slide one after the other, here smoothed
    const double reach = fast * (0.12 + 0.25 * u);
    Hidden out{name, "drive" + std::to_string(drive + 1), {}, 3, {}, {}, {}, 0};
    out.resist = [=](const Moment& m, const Eigen::VectorXd& z, Eigen::VectorXd& z_d, Eigen::VectorXd& load) {
      for (int k = 0; k < 3; ++k) {
        const double limit = reach * (0.5 + 0.5 * k) / 1.5, v = m.qd(drive), x = z(k) / limit;
        z_d(k) = v * x > 0 ? v * (1 - std::pow(std::min(1.0, std::abs(x)), 8)) : v;
        load(drive) += 0.5 * F * x;
      }
    };
    return out;
  }
  if (name == "torque_ripple") {
    const double n = drive == 3 ? 3.3 + 2 * u : 17.7 + 30 * u, phase = between(random, 0, 6);
    return sized(on_drive(name, drive,
                          [=](const Moment&, double, double q) {
                            return 0.5 * F * (std::sin(n * q + phase) + 0.15 * std::sin(2 * n * q));
                          }),
                 0.5 * F);
  }
  if (name == "position_dependent_friction") {
    const double n = drive == 3 ? 1.0 : 4.3 + 5 * u, phase = between(random, 0, 6);
    return on_drive(name, drive, [=](const Moment&, double v, double q) {
      return F * std::tanh(1.2 * std::cos(n * q + phase)) * sign_of(v, width);
    });
  }
  if (name == "joint_elasticity") {
    Hidden out{name, "drive" + std::to_string(limb + 1), {}, 0, {}, {}, {}, 0};
    const bool on_motor = u < 0.5;
    const double hz = 26 + 16 * (1 - size);
    out.spring = Spring{limb, hz, on_motor};
    return sized(out, std::pow(2 * 3.14159265 * hz, -2));
  }
  if (name == "rotor_inertia") {
    Hidden out{name, "drive" + std::to_string(limb + 1), {}, 0, {}, {}, {}, 0};
    out.parameters = [=](const Robot& robot, int, Eigen::VectorXd& p) {
      for (int k = 0; k < robot.parameters(); ++k) {
        if (robot.parameter_names()[static_cast<std::size_t>(k)] ==
            "drive" + std::to_string(limb + 1) + ".rotor_inertia")
          p(k) += 0.01 + 0.06 * size;
      }
    };
    return sized(out, 0.01 + 0.06 * size);
  }
  if (name == "limb_inertia_mismatch") {  // a lump of mass on one arm
    Hidden out{name, "drive" + std::to_string(limb + 1), {}, 0, {}, {}, {}, 0};
    const double m = 0.04 + 0.4 * size, x = 0.2 + 0.3 * u;
    out.parameters = [=](const Robot& robot, int, Eigen::VectorXd& p) {
      const std::string arm = "upper_arm" + std::to_string(limb + 1);
      for (int k = 0; k < robot.parameters(); ++k) {
        const std::string& text = robot.parameter_names()[static_cast<std::size_t>(k)];
        if (text == arm + ".m") p(k) += m;
        if (text == arm + ".mcx") p(k) += m * x;
        if (text == arm + ".Iyy" || text == arm + ".Izz") p(k) += m * x * x;
      }
    };
    return sized(out, m * x);
  }
  if (name == "base_tilt") {
    Hidden out{name, "robot", {}, 0, {}, {}, {}, 0};
    const double angle = 0.006 + 0.05 * size, about = between(random, 0, 6.28);
    out.robot = [=](RobotDescription& robot) {
      robot.gravity = 9.81 * Eigen::Vector3d(std::sin(angle) * std::cos(about), std::sin(angle) * std::sin(about),
                                             -std::cos(angle));
    };
    return sized(out, angle);
  }
  if (name == "payload") {
    Hidden out{name, "platform", {}, 0, {}, {}, {}, 0};
    out.parameters = [=](const Robot& robot, int log, Eigen::VectorXd& p) {
      for (int k = 0; k < robot.parameters() && log == 0; ++k) {
        if (robot.parameter_names()[static_cast<std::size_t>(k)] == "platform.m") p(k) += 0.05 + 0.5 * size;
      }
    };
    return sized(out, 0.05 + 0.5 * size);
  }
  if (name == "torque_constant_error") {
    Hidden out{name, "drive" + std::to_string(limb + 1), {}, 0, {}, {}, {}, 0};
    const double eps = (u > 0.5 ? 1 : -1) * (0.01 + 0.08 * size);
    out.record = [=](int, Eigen::MatrixXd& tau, Eigen::MatrixXd&, double) { tau.col(limb) *= 1 + eps; };
    return sized(out, std::abs(eps));
  }
  if (name == "time_skew") {
    Hidden out{name, "robot", {}, 0, {}, {}, {}, 0};
    const double delay = 1.6 + 5 * size;  // samples
    out.record = [=](int, Eigen::MatrixXd& tau, Eigen::MatrixXd&, double) {
      const Eigen::MatrixXd x = tau;
      for (Eigen::Index k = 0; k < x.rows(); ++k) {
        const double at = std::max(0.0, static_cast<double>(k) - delay);
        const auto low = std::min(static_cast<Eigen::Index>(at), x.rows() - 2);
        tau.row(k) = x.row(low) + (at - static_cast<double>(low)) * (x.row(low + 1) - x.row(low));
      }
    };
    return sized(out, 1e-3 * delay);
  }
  if (name == "current_lag") {
    Hidden out{name, "robot", {}, 0, {}, {}, {}, 0.0015 + 0.004 * size};
    return sized(out, 0.0015 + 0.004 * size);
  }
  if (name == "thermal_drift") {
    const double T = 3 + 8 * u;
    return on_drive(name, drive, [=](const Moment& m, double v, double) {
      return 1.2 * F / fast / std::pow(1 + std::max(0.0, m.t) / T, 2) * v;
    });
  }
  if (name == "aerodynamic_drag") {
    Hidden out{name, "platform", {}, 0, {}, {}, {}, 0};
    out.resist = [=](const Moment& m, const Eigen::VectorXd&, Eigen::VectorXd&, Eigen::VectorXd& load) {
      load += (0.6 + 6 * size) * std::pow(m.v.norm() + 1e-9, 0.85) * (m.J.topRows<3>().transpose() * m.v);
    };
    return out;
  }
  if (name == "hose_force") {
    Hidden out{name, "platform", {}, 0, {}, {}, {}, 0};
    const Eigen::Vector3d anchor(between(random, -0.2, 0.2), between(random, -0.2, 0.2), -0.8);
    const double k0 = 1.5 + 25 * size;
    out.resist = [=](const Moment& m, const Eigen::VectorXd&, Eigen::VectorXd&, Eigen::VectorXd& load) {
      const Eigen::Vector3d d = m.r - anchor;
      const Eigen::Vector3d k(k0, 0.7 * k0, 0.3 * k0);
      load += m.J.topRows<3>().transpose() * (k.cwiseProduct(d) * (1 + 0.3 * d.norm()));
    };
    return out;
  }
  // kinematic_offset: a home position that is off
  Hidden out{"kinematic_offset", "drive" + std::to_string(limb + 1), {}, 0, {}, {}, {}, 0};
  const double off = 0.004 + 0.03 * size;
  out.record = [=](int, Eigen::MatrixXd&, Eigen::MatrixXd& q, double) { q.col(limb).array() += off; };
  return sized(out, off);
}

/// Kinds that the catalogue does not have.
inline Hidden make_outside(int kind, int drives, double size, Random& random) {
  const int drive = static_cast<int>(between(random, 0, 2.999)), other = (drive + 1) % std::min(3, drives);
  const double F = coulomb_of(drive) * (0.15 + 0.4 * size), phase = between(random, 0, 6), width = 0.008;
  const auto unknown = [&](auto torque) { return on_drive("unknown", drive, torque); };
  switch (kind % 8) {
    case 0:
      return unknown([=](const Moment& m, double, double) { return F * std::sin(2 * 3.14159 * 1.7 * m.t + phase); });
    case 1:
      return unknown(
          [=](const Moment& m, double v, double) { return F * std::sin(6 * m.q(other) + phase) * sign_of(v, width); });
    case 2: return unknown([=](const Moment& m, double, double) { return F * std::sin(5 * m.q(other) + phase); });
    case 3: return unknown([=](const Moment& m, double, double) { return m.t > 5 ? F : -F; });
    case 4:
      return unknown(
          [=](const Moment& m, double v, double) { return m.t > 4 && m.t < 6.5 ? 2 * F * sign_of(v, width) : 0.0; });
    case 5:
      return unknown([=](const Moment& m, double v, double) { return F * sign_of(v, width) * sign_of(m.qd(other)); });
    case 6: return unknown([=](const Moment& m, double, double) { return F * std::sin(3 * m.qd(other) + phase); });
    default:
      return unknown([=](const Moment& m, double, double q) {
        return q > -0.05 ? F * (1 - std::exp(-(q + 0.05) / 0.05)) : 0.0 * m.t;
      });
  }
}

}  // namespace deltadyn::blind
