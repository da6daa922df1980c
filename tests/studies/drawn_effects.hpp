#pragma once

/// \file
/// The hidden effects of blind_effects.hpp for robots drawn at random: the same forms, off the catalogue's, measured by
/// the motion and the torque of the drive where they act.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "studies/drawn_machine.hpp"

namespace deltadyn::blind {

/// Where an effect acts and how large it is.
struct Site {
  const Machine& machine;
  int drive = 0, limb = 0;  ///< drawn for effects of a drive, and of a drive that moves a limb
  double size = 0;          ///< 0 barely there ... 1 plain
  double gain = 1;          ///< on its amplitude, so that it stands out of the dirt

  [[nodiscard]] const DriveScale& at(int j) const { return machine.scale[static_cast<std::size_t>(j)]; }
  /// An amplitude between two ends, with the gain, and never beyond what a machine can have.
  [[nodiscard]] double amplitude(double low, double high, double most) const {
    return std::min(most, gain * (low + (high - low) * size));
  }
  /// Of a friction or a torque on a drive [N m | N]
  [[nodiscard]] double torque(int j) const { return at(j).friction * amplitude(0.06, 0.5, 1.5); }
  /// Rates of the forms are those of a drive that reaches 2.5 rad/s.
  [[nodiscard]] double rate(int j) const { return at(j).speed / 2.5; }
  /// Force on the plate that its drives feel as their own torque [N]
  [[nodiscard]] double plate_force() const { return at(0).torque / (machine.turns(0) ? machine.length : 1.0); }
};

/// Can the effect act on this machine, and is it not a part of the user's model there?
inline bool can_act(const std::string& name, const Machine& m) {
  const auto one_of = [&](std::initializer_list<const char*> names) {
    return std::any_of(names.begin(), names.end(), [&](const char* n) { return name == n; });
  };
  if (!m.plate() && one_of({"rotor_inertia", "limb_inertia_mismatch", "base_tilt", "payload", "torque_constant_error",
                            "aerodynamic_drag", "hose_force", "kinematic_offset", "asymmetric_coulomb"}))
    return false;
  const bool carriages = m.robot.drive_kind == DriveKind::prismatic;
  if (carriages && name == "limb_inertia_mismatch") return false;
  if (name == "rotor_inertia") return m.layout.rotor_inertia.size() < 3;
  // delta-identify finds bristles and ripples of a dirty machine by itself: they are in its parameter file.
  return !(m.dirt.any() && one_of({"presliding", "torque_ripple"}));
}

/// Friction that depends on the rate, and losses of the gear.
inline std::optional<Hidden> hidden_friction(const std::string& name, const Site& site, double u) {
  const int drive = site.drive;
  const double F = site.torque(drive), fast = site.rate(drive), width = site.at(drive).sign_width();
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
  if (name == "thermal_drift") {
    const double T = 3 + 8 * u;
    return on_drive(name, drive, [=](const Moment& m, double v, double) {
      return 1.2 * F / fast / std::pow(1 + std::max(0.0, m.t) / T, 2) * v;
    });
  }
  return std::nullopt;
}

inline std::optional<Hidden> hidden_loss(const std::string& name, const Site& site) {
  const int limb = site.limb;
  const double width = site.at(limb).sign_width();
  if (name == "load_dependent_friction") {
    const double mu = site.amplitude(0.02, 0.12, 0.3);
    return sized(on_drive(name, limb,
                          [=](const Moment& m, double v, double) {
                            return mu * std::abs(m.transmitted(limb)) * sign_of(v, width);
                          }),
                 mu);
  }
  if (name == "directional_efficiency") {
    const double loss = site.amplitude(0.03, 0.15, 0.35), soft = 0.02 * site.at(limb).torque * site.at(limb).speed;
    return sized(on_drive(name, limb,
                          [=](const Moment& m, double v, double) {
                            const double power = m.transmitted(limb) * v;
                            return loss * std::abs(m.transmitted(limb)) * 0.5 * (1 + std::tanh(power / soft)) *
                                   sign_of(v, width);
                          }),
                 loss / (1 - loss));  // of what the gear passes on
  }
  return std::nullopt;
}

/// Effects with a memory, and those over the position.
inline std::optional<Hidden> hidden_position(const std::string& name, const Site& site, double u, Random& random) {
  const int drive = site.drive;
  const double F = site.torque(drive), range = site.at(drive).range, width = site.at(drive).sign_width();
  Hidden out{name, "drive" + std::to_string(drive + 1), {}, 0, {}, {}, {}, 0};
  if (name == "presliding") {  // LuGre in place of part of the Coulomb friction, with bristle damping
    const double x = range * (0.02 + 0.06 * u), Fc = site.at(drive).friction * site.amplitude(0.15, 0.65, 1.0);
    out.memory_size = 1;
    out.resist = [=](const Moment& m, const Eigen::VectorXd& z, Eigen::VectorXd& z_d, Eigen::VectorXd& load) {
      const double v = m.qd(drive);
      z_d(0) = v - std::abs(v) / x * z(0);
      load(drive) += Fc * (z(0) / x + 0.002 * z_d(0) / x - sign_of(v, width));
    };
    return out;
  }
  if (name == "hysteresis") {  // Maxwell slip: springs that slide one after the other, here smoothed
    const double reach = range * (0.12 + 0.25 * u);
    out.memory_size = 3;
    out.resist = [=](const Moment& m, const Eigen::VectorXd& z, Eigen::VectorXd& z_d, Eigen::VectorXd& load) {
      for (int k = 0; k < 3; ++k) {
        const double limit = reach * (0.5 + 0.5 * k) / 1.5, v = m.qd(drive), x = z(k) / limit;
        z_d(k) = v * x > 0 ? v * (1 - std::pow(std::min(1.0, std::abs(x)), 8)) : v;
        load(drive) += 0.5 * F * x;
      }
    };
    return out;
  }
  const double phase = between(random, 0, 6);
  if (name == "torque_ripple") {
    const double n = (18 + 30 * u) / range;
    return sized(on_drive(name, drive,
                          [=](const Moment&, double, double q) {
                            return 0.5 * F * (std::sin(n * q + phase) + 0.15 * std::sin(2 * n * q));
                          }),
                 0.5 * F);
  }
  if (name == "position_dependent_friction") {
    const double n = (4.3 + 5 * u) / range;
    return on_drive(name, drive, [=](const Moment&, double v, double q) {
      return F * std::tanh(1.2 * std::cos(n * q + phase)) * sign_of(v, width);
    });
  }
  return std::nullopt;
}

}  // namespace deltadyn::blind
