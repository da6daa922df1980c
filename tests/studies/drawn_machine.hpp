#pragma once

/// \file
/// A robot of the blind study that is drawn at random: type, lengths, masses, gears; what the user's model of it is,
/// and what the machine really is.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "studies/blind_effects.hpp"
#include "support/descriptions.hpp"

namespace deltadyn::blind {

constexpr double kPi = 3.14159265358979323846;

/// Bristles of a drive of a dirty machine: friction builds up over a displacement.
struct Bristles {
  double displacement = 0;  ///< [rad | m]; 0: none, Coulomb's law
  double bend = 0;          ///< of the build-up's form; 0: exponential, above: steeper at first
  double damping_s = 0;
};

/// Cogging: amplitude sin(n q + phase).
struct Cogging {
  double amplitude = 0, n = 0, phase = 0;  ///< [N m | N], [1/rad | 1/m], [rad]
};

/// Everything that is slightly wrong with a machine at once. Empty vectors: nothing is.
struct Dirt {
  RobotDescription robot;              ///< the machine as built, its lengths a little off
  std::vector<double> arms, struts;    ///< factors of each limb's bodies
  std::vector<Bristles> bristles;      ///< one a drive
  std::vector<Cogging> cogging;        ///< the same
  double current_filter_s = 0;         ///< time constant of the recorded torque's filter
  std::vector<double> torque_quantum;  ///< step of the recorded torque, one a drive [N m | N]
  [[nodiscard]] bool any() const { return !bristles.empty(); }
};

/// Sizes of a drive's motion and torque in the fast log, by which friction and effects are measured.
struct DriveScale {
  double speed = 1;     ///< largest [rad/s | m/s]
  double range = 1;     ///< between the ends [rad | m]
  double torque = 1;    ///< rms of the rigid torque [N m | N]
  double friction = 0;  ///< Coulomb's [N m | N]
  double inertia = 1;   ///< with the others held, at the start [kg m^2 | kg]

  /// Rate within which a clean machine's friction changes its sign. [rad/s | m/s]
  [[nodiscard]] double sign_width() const { return 0.003 * speed; }
};

/// The machine without its motion.
struct Machine {
  RobotDescription robot;      ///< as the user knows it
  ParameterOptions layout;     ///< of the user's model
  Eigen::VectorXd parameters;  ///< true ones, in that layout
  std::vector<DriveScale> scale;
  double length = 0.5;  ///< arm, or strut of carriages, by which paths are measured [m]
  double home_z = 0;    ///< of the plate [m]
  Dirt dirt;

  [[nodiscard]] bool plate() const { return !robot.parts.empty(); }
  [[nodiscard]] int limbs() const { return static_cast<int>(robot.limbs.size()); }
  /// The drive of a telescope bar, which turns fast and light.
  [[nodiscard]] bool yaws(int drive) const { return robot.telescope && drive == limbs(); }
  /// Does the drive turn, or slide?
  [[nodiscard]] bool turns(int drive) const { return robot.kind_of_drive(drive) == DriveKind::revolute; }
};

inline RobotDescription draw_delta(const std::string& type, double& length, Random& random) {
  testing_support::Lengths l;
  const bool carriages = type == "linear-delta3";
  if (carriages) {
    l.strut = length = between(random, 0.4, 1.1);
    l.platform_radius = l.strut * between(random, 0.06, 0.15);
    l.base_radius = l.platform_radius + l.strut * between(random, 0.35, 0.6);
    l.strut_spacing = l.strut * between(random, 0.08, 0.15);
  } else {
    l.upper_arm = length = between(random, 0.2, 0.6);
    l.strut = length * between(random, 1.9, 2.5);
    l.base_radius = length * between(random, 0.35, 0.65);
    l.platform_radius = length * between(random, 0.09, 0.25);
    l.strut_spacing = length * between(random, 0.15, 0.3);
  }
  RobotDescription robot = testing_support::delta_description(type, l);
  const double lean = carriages && between(random, 0, 1) < 0.4 ? between(random, -0.3, 0.3) : 0;
  for (LimbGeometry<double>& limb : robot.limbs) {
    if (carriages) limb.axis_L = Vector3<double>(std::sin(lean), 0, -std::cos(lean));
  }
  return robot;
}

/// h4, i4 or par4 with arms or on rails, limbs in the diagonals, the plate of the size of its attachments.
inline RobotDescription draw_four_limbs(const std::string& type, double& length, Random& random) {
  const bool carriages = between(random, 0, 1) < 0.3;
  RobotDescription robot =
      testing_support::four_limb_description(type, carriages ? DriveKind::prismatic : DriveKind::revolute);
  double base = 0, strut = 0;
  if (carriages) {
    strut = length = between(random, 0.4, 1.1);
    base = strut * between(random, 0.45, 0.65);
  } else {
    length = between(random, 0.2, 0.6);
    strut = length * between(random, 2.0, 2.5);
    base = length * between(random, 0.4, 0.7);
  }
  const double plate = 0.1 * strut * between(random, 0.9, 1.5);
  PlateShape shape = *robot.plate;
  if (shape.spacing > 0) shape.spacing = plate * between(random, 1.1, 1.6);
  if (shape.bar_spacing > 0) shape.bar_spacing = shape.spacing * between(random, 0.4, 0.7);
  if (shape.pinion_radius > 0) shape.pinion_radius = plate * between(random, 0.35, 0.5);
  shape.tool = ToolPlace::centre;
  robot.set_plate(shape);
  const double spacing = strut * between(random, 0.08, 0.15);
  for (LimbGeometry<double>& limb : robot.limbs) {
    const Vector3<double> radial(std::cos(limb.azimuth), std::sin(limb.azimuth), 0);
    limb.p_WD = base * radial;
    limb.p_BA = plate * radial - robot.parts[static_cast<std::size_t>(limb.part)].a;
    limb.strut = strut;
    limb.strut_spacing = spacing;
    if (!carriages) limb.p_DE_0.x() = length;
  }
  return robot;
}

/// Height of the plate with the drives in the middle of their ranges.
inline double home_height(const RobotDescription& robot, double length) {
  const LimbGeometry<double>& limb = robot.limbs.front();
  const bool carriages = robot.drive_kind == DriveKind::prismatic;
  constexpr double kArm = 0.35;  // rad below the horizontal
  const Eigen::Vector2d elbow =
      limb.p_WD.head<2>().norm() * Eigen::Vector2d::UnitX() +
      (carriages ? Eigen::Vector2d(0.4 * length * limb.axis_L.x(), 0.4 * length * limb.axis_L.z())
                 : Eigen::Vector2d(length * std::cos(kArm), -length * std::sin(kArm)));
  const Eigen::Vector3d part =
      robot.plate ? robot.parts[static_cast<std::size_t>(limb.part)].a : Eigen::Vector3d::Zero();
  const double out = elbow.x() - (part + limb.p_BA).head<2>().norm();
  return elbow.y() - std::sqrt(std::max(0.01 * limb.strut * limb.strut, limb.strut * limb.strut - out * out));
}

/// Bodies: those of simple shapes, each as a whole lighter or heavier than the drawing's.
inline Eigen::VectorXd draw_bodies(const Robot& robot, Random& random) {
  Eigen::VectorXd p = nominal_parameters(robot, PartShapes(robot.description())).value;
  const bool axis = robot.description().parts.empty();
  for (Eigen::Index k = 0; k < p.size();) {
    const ParameterId& id = robot.parameter_ids()[static_cast<std::size_t>(k)];
    if (id.kind != ParameterKind::inertial) {
      p(k++) = 0;
      continue;
    }
    p.segment<kInertialParameters>(k) *=
        axis ? std::exp(between(random, std::log(2.0), std::log(20.0))) : between(random, 0.75, 1.35);
    if (axis) p(k + 1) += 0.05 * p(k);  // an arm hangs to one side: gravity is felt
    if (axis) p.segment<3>(k + 4).array() += 0.01 * p(k);
    k += kInertialParameters;
  }
  return p;
}

/// Gears: the rotors' reflected inertia. Where an arm's own inertia holds it, it is a part of that; a carriage and a
/// telescope's drive have parameters of their own for it, which such a user asks for.
inline void draw_gears(Machine& m, double share, Random& random) {
  const auto robot = make_robot(m.robot, m.layout);
  m.parameters = draw_bodies(*robot, random);
  double arm = 0;
  for (int k = 0; k < robot->parameters(); ++k) {
    const ParameterId& id = robot->parameter_ids()[static_cast<std::size_t>(k)];
    const bool carriage = m.robot.drive_kind == DriveKind::prismatic;
    const bool in_arm = id.kind == ParameterKind::inertial && id.body == Body::upper_arm;
    if (in_arm && id.entry == (carriage ? 0 : 5)) arm = m.parameters(k);
    if (in_arm && !carriage && m.plate() && (id.entry == 5 || id.entry == 6)) m.parameters(k) += share * arm;
    if (id.kind == ParameterKind::rotor_inertia) m.parameters(k) = (m.yaws(id.number - 1) ? 0.02 : 1.0) * share * arm;
  }
}

/// \param type  "axis", "delta3", "delta4", "linear-delta3", "h4", "i4", "par4"
inline Machine draw_machine(const std::string& type, Random& random) {
  Machine m;
  const bool geared = between(random, 0, 1) < 0.6;
  const double share = geared ? between(random, 0.1, 1.0) : 0.0;
  if (type == "axis") {
    const bool turns = between(random, 0, 1) < 0.5;
    m.robot = testing_support::axis_description(turns ? DriveKind::revolute : DriveKind::prismatic);
    // As delta-identify and delta-diagnose have it for a drive on its test bench
    if (turns) m.layout.rotor_inertia = {1};
    m.layout.offset = true;
  } else {
    const bool four = type == "h4" || type == "i4" || type == "par4";
    m.robot = four ? draw_four_limbs(type, m.length, random) : draw_delta(type, m.length, random);
    m.home_z = home_height(m.robot, m.length);
    if (geared && type == "delta4") m.layout.rotor_inertia = {4};
    for (int j = 1; j <= m.limbs() && geared && m.robot.drive_kind == DriveKind::prismatic; ++j)
      m.layout.rotor_inertia.push_back(j);
  }
  draw_gears(m, share, random);
  return m;
}

/// Friction of every joint, measured by the torque and the speed of its motion.
inline void draw_friction(Machine& m, Random& random) {
  const auto robot = make_robot(m.robot, m.layout);
  const int drives = m.robot.drives();
  for (int j = 0; j < drives; ++j) {
    m.scale[static_cast<std::size_t>(j)].friction =
        m.scale[static_cast<std::size_t>(j)].torque *
        (m.yaws(j) ? between(random, 1.0, 4.0) : between(random, 0.12, 0.4));
  }
  for (int k = 0; k < robot->parameters(); ++k) {
    const ParameterId& id = robot->parameter_ids()[static_cast<std::size_t>(k)];
    if (id.kind == ParameterKind::offset) m.parameters(k) = between(random, -0.5, 0.5) * m.scale[0].friction;
    if (!id.is_friction()) continue;
    if (id.number == 0) {
      m.parameters(k) = (m.robot.plate ? 0.03 : 1.0) * between(random, 0.8, 3.0) * m.length / 0.5;
      continue;
    }
    const DriveScale& scale = m.scale[static_cast<std::size_t>(id.number - 1)];
    m.parameters(k) =
        id.kind == ParameterKind::coulomb ? scale.friction : scale.friction * between(random, 0.3, 1.0) / scale.speed;
  }
}

/// Everything slightly wrong at once, as on a real machine: bristles instead of Coulomb's law, cogging of half a per
/// cent of the largest torque, lengths 0.3 mm and limbs 1 % off, torque from a filtered and quantised current.
inline void draw_dirt(Machine& m, Random& random) {
  Dirt& dirt = m.dirt;
  dirt.robot = m.robot;
  const auto off = [&] { return between(random, -3e-4, 3e-4); };
  for (LimbGeometry<double>& limb : dirt.robot.limbs) {
    if (!m.plate()) break;
    if (m.robot.drive_kind == DriveKind::revolute) limb.p_DE_0.x() += off();
    limb.strut += off();
    limb.p_WD += limb.p_WD.normalized() * off();
    limb.p_BA += limb.p_BA.normalized() * off();
    dirt.arms.push_back(1 + between(random, -0.01, 0.01));
    dirt.struts.push_back(1 + between(random, -0.01, 0.01));
  }
  for (int j = 0; j < m.robot.drives(); ++j) {
    const DriveScale& scale = m.scale[static_cast<std::size_t>(j)];
    const double largest = 3 * scale.torque + scale.friction;
    dirt.bristles.push_back({scale.range * between(random, 1e-3, 2.5e-3), between(random, -0.2, 0.5),
                             between(random, 0, 1) < 0.5 ? 0.0 : between(random, 1e-4, 1e-3)});
    const double waves = m.yaws(j) ? 9.0 : std::floor(between(random, 20, 48));
    const double n = m.turns(j) ? waves : 2 * kPi * waves / (2 * scale.range);
    dirt.cogging.push_back({0.005 * largest * between(random, 0.7, 1.3), n, between(random, 0, 6)});
    dirt.torque_quantum.push_back(largest * std::pow(2.0, -std::floor(between(random, 9, 11.99))));
  }
  dirt.current_filter_s = between(random, 2e-4, 8e-4);
}

}  // namespace deltadyn::blind
