#pragma once

/// \file
/// The catalogue of physical effects at run time: names, classes, where each acts, what its numbers mean. The formulas stand in
/// effects/, one file each; the names are a contract with effect files and command lines.

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

enum class EffectId {
  stribeck,
  shear_thinning,
  convex_viscous,
  asymmetric_coulomb,
  asymmetric_viscous,
  load_dependent_friction,
  directional_efficiency,
  presliding,
  hysteresis,
  torque_ripple,
  position_dependent_friction,
  backlash,
  joint_elasticity,
  rotor_inertia,
  limb_inertia_mismatch,
  base_tilt,
  payload,
  torque_constant_error,
  time_skew,
  current_lag,
  saturation,
  thermal_drift,
  passive_joint_friction,
  aerodynamic_drag,
  telescope_stribeck,
  telescope_side_load,
  hose_force,
  kinematic_offset
};

/// Where an effect acts.
enum class EffectPlace {
  drive,           ///< on one drive
  limb,            ///< on one drive that moves a limb (not the telescope's)
  drive_or_robot,  ///< on one drive, or on all drives alike
  telescope,       ///< on the telescope bar's prismatic joint
  platform,        ///< on the plate
  robot            ///< on the robot as a whole
};

/// What a shape parameter's range is measured in.
enum class ShapeScale {
  absolute,        ///< as it stands
  largest_rate,    ///< share of the joint's largest rate in the logs
  largest_torque,  ///< share of the drive's largest torque in the logs
  displacement,    ///< 1 rad or 0.1 m, or the joint's range in the logs if that is wider
  range,           ///< share of the joint's range in the logs
  waves,           ///< waves per range up to the largest one that the pass band lets through
  logs             ///< number of a log, from 1
};

/// A parameter in which the effect is not linear.
struct EffectShape {
  std::string name;
  std::string unit;  ///< "{x}": rad or m, "{F}": N*m or N as the joint is
  ShapeScale scale;
  std::vector<double> grid;  ///< start values; empty for scales `waves` and `logs`, which depend on the log
  double otherwise = std::numeric_limits<double>::quiet_NaN();  ///< what holds where files and flags do not say; NaN: they must
};

/// A parameter in which the effect is linear.
struct EffectAmplitude {
  std::string name;
  std::string unit;        ///< as in EffectShape
  bool positive;           ///< physics fixes the sign
  double largest = 1e300;  ///< largest size that makes sense
};

struct EffectKind {
  EffectId id;
  std::string name, alias;  ///< alias may be empty
  std::string
      effect_class;  ///< velocity-shape, quasi-constant, reversal-memory, ...: what remains when members cannot be told apart
  EffectPlace place;
  std::vector<EffectAmplitude> amplitudes;
  std::vector<EffectShape> shapes;
  bool tied = false;    ///< the first shape parameter is the amplitude, too (a delay, a time constant)
  bool memory = false;  ///< has a state: needs the rows near reversals
  std::string meaning;  ///< in plain words: what it is
  std::string shows;    ///< how it shows
  std::string remedy;   ///< what to do about it on the machine
};

/// One effect at its place with its numbers.
struct Effect {
  EffectId id = EffectId::stribeck;
  int joint = -1;  ///< drive from 0; -1: not on one drive (telescope, platform, robot)
  Eigen::VectorXd shape, amplitude, shape_std, amplitude_std;
};

[[nodiscard]] const std::vector<EffectKind>& effect_catalogue();
[[nodiscard]] const EffectKind& effect_kind(EffectId id);
/// By name or alias; empty if there is none.
[[nodiscard]] const EffectKind* find_effect_kind(std::string_view name);

/// "drive2", "telescope", "platform", "robot".
[[nodiscard]] std::string effect_joint_name(EffectId id, int joint);
/// The joint of a name, as Effect::joint. Accepts "2" for "drive2". Throws deltadyn::Error if the effect cannot act there on this robot.
[[nodiscard]] int effect_joint(EffectId id, std::string_view name, const RobotDescription& robot, const std::string& where);
/// Every place of a robot where the effect can act, as Effect::joint; empty if the robot has none.
[[nodiscard]] std::vector<int> effect_joints(EffectId id, const RobotDescription& robot);
/// A unit with its placeholders filled in for the joint's kind.
[[nodiscard]] std::string effect_unit(const std::string& unit, int joint, const RobotDescription& robot);
/// "rate=0.25 rad/s; exponent=2": the shape parameters for people and for the column of a table.
[[nodiscard]] std::string effect_shape_text(const Effect& effect, const RobotDescription& robot);

}  // namespace deltadyn
