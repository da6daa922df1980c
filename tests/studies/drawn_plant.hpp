#pragma once

/// \file
/// The plant of the drawn machines: what blind_plant.hpp is for the two fixed robots, with bristles, cogging, limbs
/// that differ and lengths that are off. Nothing of effects/, diagnosis/ or simulation/ is used, only the rigid robot.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "studies/drawn_path.hpp"

namespace deltadyn::blind {

/// Everything that makes the logs of one case, and nothing else.
struct DrawnCase {
  std::string type;  ///< of the robot
  Machine machine;
  std::vector<Hidden> hidden;
  Noise noise;
  std::vector<double> encoder_step;  ///< one a drive [rad | m]
  double rate_hz = 1000;             ///< of the logs
  double duration_s = 10;
  MotionKind motion = MotionKind::fourier;
  std::vector<Path> paths;  ///< fast, slow, held out
  std::uint64_t seed = 1;
  double strength = 0;  ///< see drawn_signature.hpp
  bool strong = true;   ///< no hidden effect stayed below what it should have been

  [[nodiscard]] const Spring* spring() const {
    for (const Hidden& one : hidden) {
      if (one.spring) return &*one.spring;
    }
    return nullptr;
  }
};

/// Friction of a bristle between two surfaces, as a share of Coulomb's: a function of the way since a known state. With
/// u what is missing to full friction, du/ds = -u (1 + bend u) / displacement, which has a closed form: no step of an
/// integrator is too long for it.
class BristleWay {
 public:
  BristleWay() = default;
  explicit BristleWay(const Bristles& law, double share) : law_(law), share_(share) {}

  /// \param way  from the known state [rad | m]  \param rate  there [rad/s | m/s]
  [[nodiscard]] double torque(double way, double rate) const {
    const double z = after(way), sense = rate >= 0 ? 1.0 : -1.0, u = 1 - sense * z;
    return z + law_.damping_s * rate * u * (1 + law_.bend * u) / law_.displacement;
  }
  void move(double way) { share_ = after(way); }

 private:
  [[nodiscard]] double after(double way) const {
    if (way == 0) return share_;
    const double sense = way > 0 ? 1.0 : -1.0, u = 1 - sense * share_;
    const double w = u / (1 + law_.bend * u) * std::exp(-std::abs(way) / law_.displacement);
    return sense * (1 - w / (1 - law_.bend * w));
  }

  Bristles law_;
  double share_ = 0;
};

/// Robot, parameters and friction of the machine as it is in one log.
struct BuiltMachine {
  std::unique_ptr<Robot> robot;
  Eigen::VectorXd p;                     ///< limb by limb, without friction
  std::vector<double> viscous, coulomb;  ///< drives, then the inner joint
};

/// Parameters of the user's layout in the plant's own, which has everything limb by limb.
inline void fill_parameters(const Machine& m, BuiltMachine& built) {
  const auto model = make_robot(m.robot, m.layout);
  const auto joints = static_cast<std::size_t>(m.robot.drives()) + 1;
  built.p.setZero(built.robot->parameters());
  built.viscous.assign(joints, 0);
  built.coulomb.assign(joints, 0);
  for (int i = 0; i < model->parameters(); ++i) {
    const ParameterId& id = model->parameter_ids()[static_cast<std::size_t>(i)];
    if (id.is_friction()) {
      const std::size_t joint = id.number == 0 ? joints - 1 : static_cast<std::size_t>(id.number - 1);
      (id.kind == ParameterKind::viscous ? built.viscous : built.coulomb)[joint] = m.parameters(i);
      continue;
    }
    for (int k = 0; k < built.robot->parameters(); ++k) {
      ParameterId own = built.robot->parameter_ids()[static_cast<std::size_t>(k)];
      if (id.kind == ParameterKind::inertial && id.number == 0) own.number = 0;
      if (own == id) built.p(k) = m.parameters(i);
    }
  }
}

/// \param hidden  effects that change the machine  \param dirty  with the machine's dirt
inline BuiltMachine build_machine(const Machine& m, const std::vector<Hidden>& hidden, int log, bool dirty) {
  RobotDescription description = dirty && m.dirt.any() ? m.dirt.robot : m.robot;
  for (const Hidden& one : hidden) {
    if (one.robot) one.robot(description);
  }
  ParameterOptions own;
  own.individual_limbs = m.plate();
  own.offset = m.layout.offset;
  for (int j = 1; j <= m.robot.drives(); ++j) own.rotor_inertia.push_back(j);
  BuiltMachine built{make_robot(description, own), {}, {}, {}};
  fill_parameters(m, built);
  for (int k = 0; k < built.robot->parameters() && dirty && m.dirt.any() && m.plate(); ++k) {
    const ParameterId& id = built.robot->parameter_ids()[static_cast<std::size_t>(k)];
    if (id.kind != ParameterKind::inertial || id.number == 0) continue;
    const auto limb = static_cast<std::size_t>(id.number - 1);
    built.p(k) *= id.body == Body::upper_arm ? m.dirt.arms[limb] : m.dirt.struts[limb];
  }
  for (const Hidden& one : hidden) {
    if (one.parameters) one.parameters(*built.robot, log, built.p);
  }
  return built;
}

/// A spring's numbers: the rotor, a body of its own, carries the drive's friction.
struct SpringNumbers {
  int drive = -1;  ///< -1: none
  bool encoder_on_motor = true;
  double resonance_hz = 0, rotor = 0, stiffness = 0, damping = 0;
  [[nodiscard]] bool there() const { return drive >= 0; }
};

inline SpringNumbers spring_numbers(const Spring* spring, double whole) {
  constexpr double kRotorShare = 0.3, kDampingRatio = 0.05;
  if (spring == nullptr) return {};
  SpringNumbers s{spring->drive, spring->encoder_on_motor, spring->resonance_hz, kRotorShare * whole, 0, 0};
  const double w = 2 * kPi * s.resonance_hz;
  s.stiffness = w * w * (s.encoder_on_motor ? whole - s.rotor : s.rotor);
  s.damping = 2 * kDampingRatio * std::sqrt(s.stiffness * s.rotor * (whole - s.rotor) / whole);
  return s;
}

}  // namespace deltadyn::blind
