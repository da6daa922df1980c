#include "deltadyn/runtime/effect_catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

namespace {

using Id = EffectId;
using Place = EffectPlace;
using Scale = ShapeScale;

/// Values evenly spaced in their logarithm.
std::vector<double> log_grid(double low, double high, int points) {
  std::vector<double> grid;
  for (int k = 0; k < points; ++k) grid.push_back(low * std::pow(high / low, points > 1 ? k / (points - 1.0) : 0.0));
  return grid;
}

std::vector<double> both_signs(std::vector<double> grid) {
  const std::size_t count = grid.size();
  for (std::size_t k = 0; k < count; ++k) grid.push_back(-grid[k]);
  return grid;
}

std::vector<EffectKind> make_catalogue() {
  std::vector<EffectKind> all;
  const auto add = [&all](EffectKind kind) { all.push_back(std::move(kind)); };
  add({Id::stribeck,
       "stribeck",
       "",
       "velocity-shape",
       Place::drive,
       {{"friction", "{F}", true}},
       {{"rate", "{x}/s", Scale::largest_rate, log_grid(0.004, 0.4, 9)}, {"exponent", "", Scale::absolute, {1, 2}}},
       false,
       false,
       "the drive has more friction at low speed than Coulomb's law says (Stribeck effect)",
       "excess of friction at low speed",
       "keep it as a feed-forward term; check the lubricant if it is large"});
  add({Id::shear_thinning,
       "shear_thinning",
       "",
       "velocity-shape",
       Place::drive,
       {{"friction", "{F}", true}},
       {{"rate", "{x}/s", Scale::largest_rate, log_grid(0.01, 1.0, 7)}, {"exponent", "", Scale::absolute, {0, 0.3, 0.5, 0.7}}},
       false,
       false,
       "the drive's friction bends over: it lacks friction at low speed beside a straight line (grease that thins)",
       "deficit of friction at low speed",
       "keep it as a feed-forward term; do not tune Coulomb and viscous friction by hand instead"});
  add({Id::convex_viscous,
       "convex_viscous",
       "",
       "velocity-shape",
       Place::drive,
       {{"friction", "{F}", true}},
       {{"exponent", "", Scale::absolute, {1.5, 2, 3}}},
       false,
       false,
       "the drive's friction grows faster than its speed",
       "excess of friction at high speed",
       "keep it as a feed-forward term; look at the oil level or a fan on the motor shaft"});
  add({Id::asymmetric_coulomb,
       "asymmetric_coulomb",
       "torque_offset",
       "quasi-constant",
       Place::drive,
       {{"offset", "{F}", false}},
       {},
       false,
       false,
       "the drive's torque has a constant offset (amplifier, or Coulomb friction that differs by direction)",
       "the same residual at every speed",
       "trim the amplifier's offset, or keep the term"});
  add({Id::asymmetric_viscous,
       "asymmetric_viscous",
       "",
       "velocity-shape",
       Place::drive,
       {{"viscous", "{F}*s/{x}", false}},
       {},
       false,
       false,
       "the drive's viscous friction differs by direction",
       "residual even in the speed",
       "keep it as a feed-forward term"});
  add({Id::load_dependent_friction,
       "load_dependent_friction",
       "",
       "load",
       Place::drive,
       {{"coefficient", "", true, 1.0}},
       {},
       false,
       false,
       "the drive's friction grows with the torque that it transmits",
       "friction that grows with the load",
       "keep it as a feed-forward term; look at the gear's efficiency"});
  add({Id::directional_efficiency,
       "directional_efficiency",
       "",
       "load",
       Place::drive,
       {{"driving_loss", "", true, 1.0}, {"back_driving_loss", "", true, 1.0}},
       {},
       false,
       false,
       "the drive's gear loses different shares when it drives and when it is driven",
       "follows the sign of torque times speed",
       "keep it as a feed-forward term"});
  add({Id::presliding,
       "presliding",
       "",
       "reversal-memory",
       Place::drive,
       {{"friction", "{F}", true}},
       {{"displacement", "{x}", Scale::displacement, log_grid(3e-4, 0.08, 7)}, {"damping", "s", Scale::absolute, {0}, 0}},
       false,
       true,
       "after a reversal the drive's friction builds up over a displacement instead of jumping",
       "memory after a reversal",
       "use a friction model with a state (LuGre) near reversals"});
  add({Id::hysteresis,
       "hysteresis",
       "",
       "reversal-memory",
       Place::drive,
       {{"torque", "{F}", true}},
       {{"displacement", "{x}", Scale::range, log_grid(0.1, 0.6, 4)}, {"exponent", "", Scale::absolute, {1, 2}}},
       false,
       true,
       "the drive's torque runs through a loop over its position (flexspline, belt, cable)",
       "loop of the torque over the position",
       "use a hysteresis model; look at cables that run along the arm"});
  add({Id::torque_ripple,
       "torque_ripple",
       "",
       "position-periodic",
       Place::drive,
       {{"cosine", "{F}", false}, {"sine", "{F}", false}},
       {{"n", "1/{x}", Scale::waves, {}}},
       false,
       false,
       "the drive's torque ripples over its position (cogging, tooth meshing)",
       "periodic in the position",
       "compensate the ripple over position; n tells the number of poles or teeth"});
  add({Id::position_dependent_friction,
       "position_dependent_friction",
       "",
       "position-periodic",
       Place::drive,
       {{"cosine", "{F}", false}, {"sine", "{F}", false}},
       {{"n", "1/{x}", Scale::waves, {}}},
       false,
       false,
       "the drive's Coulomb friction varies over its position",
       "periodic in the position, flips with the direction",
       "look for an eccentric wheel or uneven preload"});
  add({Id::backlash,
       "backlash",
       "",
       "reversal-memory",
       Place::drive,
       {{"share", "", true, 1.0}},
       {{"gap", "{x}", Scale::displacement, log_grid(5e-4, 0.05, 6)}},
       false,
       true,
       "the drive's gear has play",
       "torque missing after the load reverses",
       "readjust the gear"});
  add({Id::joint_elasticity,
       "joint_elasticity",
       "",
       "inertia-like",
       Place::drive,
       {{"inertia_over_stiffness", "s^2", true}},
       {{"encoder", "", Scale::absolute, {0, 1}, 0}, {"motor_share", "", Scale::absolute, {0.4}, 0.4}},
       false,
       false,
       "the drive's gear or arm yields like a spring",
       "error that grows with the frequency squared",
       "keep the motion below the resonance, or use the elastic model"});
  add({Id::rotor_inertia,
       "rotor_inertia",
       "",
       "inertia-like",
       Place::drive,
       {{"inertia", "{F}*s^2/{x}", false}},
       {},
       false,
       false,
       "one drive has another inertia than the others (rotor, gear, coupling)",
       "in proportion to one drive's acceleration",
       "identify with --rotor-inertia for this drive"});
  add({Id::limb_inertia_mismatch,
       "limb_inertia_mismatch",
       "",
       "inertia-like",
       Place::limb,
       {{"moment", "kg*m", false}, {"inertia", "kg*m^2", false}},
       {},
       false,
       false,
       "one limb has another mass distribution than the others",
       "gravity and inertia of one limb",
       "identify with --individual-limbs; look for a cable or a repair on this arm"});
  add({Id::base_tilt,
       "base_tilt",
       "",
       "pose-force",
       Place::robot,
       {{"angle_x", "rad", false, 0.3}, {"angle_y", "rad", false, 0.3}},
       {},
       false,
       false,
       "the base is not level",
       "a fixed pattern of gravity over the drives",
       "level the base, or state gravity's direction"});
  add({Id::payload,
       "payload",
       "",
       "load",
       Place::platform,
       {{"mass", "kg", true}},
       {{"log", "", Scale::logs, {}}},
       false,
       false,
       "a mass on the plate in some of the logs only",
       "the whole model scales in one log",
       "record all logs with the same load, or state it"});
  add({Id::torque_constant_error,
       "torque_constant_error",
       "",
       "load",
       Place::drive,
       {{"share", "", false, 0.5}},
       {},
       false,
       false,
       "one drive's torque constant is wrong",
       "in proportion to the drive's torque",
       "check the torque constant of this drive"});
  add({Id::time_skew,
       "time_skew",
       "",
       "phase",
       Place::drive_or_robot,
       {{"delay", "s", false}},
       {{"delay", "s", Scale::absolute, both_signs(log_grid(2e-4, 0.012, 9))}},
       true,
       false,
       "torque and position are not sampled at the same time",
       "phase",
       "shift the torque by the delay, or mend the time stamps"});
  add({Id::current_lag,
       "current_lag",
       "",
       "phase",
       Place::drive_or_robot,
       {{"time_constant", "s", true}},
       {{"time_constant", "s", Scale::absolute, log_grid(2e-4, 0.015, 10)}, {"recorded", "", Scale::absolute, {0, 1}}},
       true,
       false,
       "the current loop lags like a first-order filter between the recorded torque and the motor's",
       "phase and droop",
       "record the torque on the motor's side of the filter, or keep the term"});
  add({Id::saturation,
       "saturation",
       "",
       "load",
       Place::drive,
       {{"share", "", false, 1.0}},
       {{"level", "{F}", Scale::largest_torque, {0.5, 0.6, 0.7, 0.8, 0.88, 0.94}}},
       false,
       false,
       "the drive does not reach its torque peaks",
       "at the peaks only",
       "lower the acceleration, or check the current limit"});
  add({Id::thermal_drift,
       "thermal_drift",
       "",
       "drift",
       Place::drive,
       {{"viscous", "{F}*s/{x}", true}},
       {{"time_constant", "s", Scale::absolute, log_grid(1.5, 60, 6)}},
       false,
       false,
       "the drive's viscous friction falls while it warms up",
       "slow trend in proportion to the speed",
       "warm the drives up before recording"});
  add({Id::passive_joint_friction,
       "passive_joint_friction",
       "",
       "velocity-shape",
       Place::robot,
       {{"friction", "N*m", true}},
       {},
       false,
       false,
       "the ball and universal joints have friction",
       "couples all drives",
       "keep the term; check the preload of the balls"});
  add({Id::aerodynamic_drag,
       "aerodynamic_drag",
       "",
       "velocity-shape",
       Place::platform,
       {{"coefficient", "N*s^2/m^2", true}},
       {},
       false,
       false,
       "air drag on the plate",
       "grows with the plate's speed squared",
       "keep the term"});
  add({Id::telescope_stribeck,
       "telescope_stribeck",
       "",
       "velocity-shape",
       Place::telescope,
       {{"friction", "N", true}},
       {{"rate", "m/s", Scale::largest_rate, log_grid(0.004, 0.4, 7)}, {"exponent", "", Scale::absolute, {1, 2}}},
       false,
       false,
       "the telescope bar has more friction at low speed",
       "follows the sign of the bar's rate",
       "lubricate the bar"});
  add({Id::telescope_side_load,
       "telescope_side_load",
       "",
       "load",
       Place::telescope,
       {{"coefficient", "kg", true}},
       {},
       false,
       false,
       "the telescope bar's friction grows with its side load",
       "grows with the force across the bar",
       "check the bar's guide"});
  add({Id::hose_force,
       "hose_force",
       "",
       "pose-force",
       Place::platform,
       {{"force_x", "N", false},
        {"force_y", "N", false},
        {"force_z", "N", false},
        {"stiffness_x", "N/m", true},
        {"stiffness_y", "N/m", true},
        {"stiffness_z", "N/m", true}},
       {},
       false,
       false,
       "a force on the plate that depends on its place only (hose, cable, balancing spring)",
       "pose only",
       "route the hose or cable loosely, or keep the term"});
  add({Id::kinematic_offset,
       "kinematic_offset",
       "",
       "pose-force",
       Place::limb,
       {{"error", "SI", false}},
       {{"kind", "", Scale::absolute, {0, 1, 2}}},
       false,
       false,
       "a length or a home position is not what the robot file says (kind 0 home, 1 arm, 2 strut)",
       "gravity that depends on the pose",
       "calibrate the home position and the lengths"});
  return all;
}

[[noreturn]] void refuse_joint(const EffectKind& kind, std::string_view name, const std::string& where, const std::string& mend) {
  throw Error(fmt::format("the effect {} cannot act at '{}'", kind.name, name), where, mend);
}

}  // namespace

const std::vector<EffectKind>& effect_catalogue() {
  static const std::vector<EffectKind> catalogue = make_catalogue();
  return catalogue;
}

const EffectKind& effect_kind(EffectId id) {
  for (const EffectKind& kind : effect_catalogue()) {
    if (kind.id == id) return kind;
  }
  throw Error("an effect has no entry in the catalogue", "", "", ExitCode::usage);
}

const EffectKind* find_effect_kind(std::string_view name) {
  for (const EffectKind& kind : effect_catalogue()) {
    if (kind.name == name || (!kind.alias.empty() && kind.alias == name)) return &kind;
  }
  return nullptr;
}

std::string effect_joint_name(EffectId id, int joint) {
  if (joint >= 0) return fmt::format("drive{}", joint + 1);
  switch (effect_kind(id).place) {
    case EffectPlace::telescope: return "telescope";
    case EffectPlace::platform: return "platform";
    default: return "robot";
  }
}

std::vector<int> effect_joints(EffectId id, const RobotDescription& robot) {
  std::vector<int> joints;
  const bool plate = !robot.parts.empty();
  const auto add_drives = [&joints](int count) {
    for (int j = 0; j < count; ++j) joints.push_back(j);
  };
  switch (effect_kind(id).place) {
    case EffectPlace::drive: add_drives(robot.drives()); break;
    case EffectPlace::limb:
      if (plate) add_drives(static_cast<int>(robot.limbs.size()));
      break;
    case EffectPlace::drive_or_robot:
      if (robot.drives() > 1) joints.push_back(-1);
      add_drives(robot.drives());
      break;
    case EffectPlace::telescope:
      if (robot.telescope) joints.push_back(-1);
      break;
    case EffectPlace::platform:
    case EffectPlace::robot:
      if (plate) joints.push_back(-1);
      break;
  }
  return joints;
}

int effect_joint(EffectId id, std::string_view name, const RobotDescription& robot, const std::string& where) {
  std::string choice;
  const std::vector<int> joints = effect_joints(id, robot);
  for (const int joint : joints) {
    const std::string text = effect_joint_name(id, joint);
    if (name == text || (joint >= 0 && name == std::to_string(joint + 1))) return joint;
    choice += (choice.empty() ? "" : ", ") + text;
  }
  refuse_joint(effect_kind(id), name, where, choice.empty() ? "this robot has no such part" : "give one of these: " + choice);
}

std::string effect_unit(const std::string& unit, int joint, const RobotDescription& robot) {
  const bool turns = joint < 0 || robot.kind_of_drive(joint) == DriveKind::revolute;
  std::string text = unit;
  const auto replace = [&text](const std::string& mark, const std::string& word) {
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark)) text.replace(at, mark.size(), word);
  };
  replace("{F}", turns ? "N*m" : "N");
  replace("{x}", turns ? "rad" : "m");
  // Inertia in its usual unit.
  if (text == "N*m*s^2/rad") return "kg*m^2";
  if (text == "N*s^2/m") return "kg";
  return text;
}

std::string effect_shape_text(const Effect& effect, const RobotDescription& robot) {
  const EffectKind& kind = effect_kind(effect.id);
  std::string text;
  for (std::size_t k = kind.tied ? 1 : 0; k < kind.shapes.size() && static_cast<Eigen::Index>(k) < effect.shape.size(); ++k) {
    const std::string unit = effect_unit(kind.shapes[k].unit, effect.joint, robot);
    text += fmt::format("{}{}={:.4g}{}", text.empty() ? "" : "; ", kind.shapes[k].name,
                        effect.shape(static_cast<Eigen::Index>(k)), unit.empty() ? "" : " " + unit);
  }
  return text;
}

}  // namespace deltadyn
