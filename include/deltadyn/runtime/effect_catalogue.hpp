#pragma once

/// \file
/// The list of effects (effects/all.hpp) at run time: looked up by name, placed on a robot, with units filled in.

#include <Eigen/Core>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "deltadyn/effects/visit.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

/// An effect of the list as the upper floors see it.
struct EffectKind : EffectTraits {
  EffectId id = EffectId{0};
};

/// One effect at its place with its numbers.
struct Effect {
  EffectId id = EffectId{0};
  int joint = -1;  ///< drive from 0; -1: not on one drive (telescope, platform, robot)
  Eigen::VectorXd shape, amplitude, shape_std, amplitude_std;
  /// Of an effect that only some logs have: their file names without folders; empty: the log of the shape's number
  std::vector<std::string> logs = {};
};

/// Shape parameters in the fixed size that the laws take; those that are missing are as the traits say, else 0.
[[nodiscard]] Shape<double> shape_of(const Effect& effect);
[[nodiscard]] Shape<double> shape_of(EffectId id, const Eigen::VectorXd& shape);
/// Amplitudes in fixed size; those that are missing are 0.
[[nodiscard]] std::array<double, kMostAmplitudes> amplitudes_of(const Effect& effect);

[[nodiscard]] const std::vector<EffectKind>& effect_catalogue();
[[nodiscard]] const EffectKind& effect_kind(EffectId id);
/// By name or alias; empty if there is none.
[[nodiscard]] const EffectKind* find_effect_kind(std::string_view name);

/// The effect that stands for a term of the model; there is one for each role.
[[nodiscard]] EffectId effect_with(Role role);
/// Does the effect act in one of several logs only?
[[nodiscard]] bool of_one_log(EffectId id);
/// The effects as they act in a log: those that name their logs get its number if it is one of them, else that of none.
/// \param file    of the log; folders do not matter
/// \param number  of the log, from 1
[[nodiscard]] std::vector<Effect> effects_in_log(std::vector<Effect> effects, const std::string& file, int number);
/// File name without folders.
[[nodiscard]] std::string bare_name(const std::string& file);
/// Start values of a shape parameter, in its scale.
[[nodiscard]] std::vector<double> start_values(const ShapeTraits& shape);
/// Throws deltadyn::Error for amplitudes of the wrong sign or beyond their largest size, and shapes that must be
/// positive and are not.
/// \param where  place of the parameter of this name, for the message
void check_sizes(const Effect& effect, const std::function<std::string(std::string_view)>& where, ExitCode code);

/// "drive2", "telescope", "platform", "robot".
[[nodiscard]] std::string effect_joint_name(EffectId id, int joint);
/// The joint of a name, as Effect::joint. Accepts "2" for "drive2". Throws deltadyn::Error if the effect cannot act
/// there on this robot.
[[nodiscard]] int effect_joint(EffectId id, std::string_view name, const RobotDescription& robot,
                               const std::string& where);
/// Does an effect with joint -1 act on this drive (from 0), as one of all that are alike?
[[nodiscard]] bool acts_on_all(EffectId id, int drive, const RobotDescription& robot);
/// Every place of a robot where the effect can act, as Effect::joint; empty if the robot has none.
[[nodiscard]] std::vector<int> effect_joints(EffectId id, const RobotDescription& robot);
/// A unit with its placeholders filled in for the joint's kind.
[[nodiscard]] std::string effect_unit(std::string_view unit, int joint, const RobotDescription& robot);
/// "rate=0.25 rad/s; exponent=2": the shape parameters for people and for the column of a table.
[[nodiscard]] std::string effect_shape_text(const Effect& effect, const RobotDescription& robot);

}  // namespace deltadyn
