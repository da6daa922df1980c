#pragma once

/// \file
/// What all exporters share: the parameters by name with the effects that are parameters worked in, and what is left.

#include <string>
#include <vector>

#include "deltadyn/io/model_export.hpp"

#include "robot_file_format.hpp"

namespace deltadyn::model_export {

struct Parts {
  NamedValues values;                 ///< parameters, with the effects that are one added
  std::vector<Effect> effects;        ///< those that are no parameter
  std::vector<std::string> left_out;  ///< what the format does not hold, one line each

  [[nodiscard]] double value(const std::string& name) const { return robot_file::value_of(values, name); }
  /// The ten parameters of a body: of its own name ("strut2") if the set has individual limbs, else of the shared one
  /// ("strut").
  [[nodiscard]] InertialVector<double> body(const std::string& shared, const std::string& own = {}) const;
};

/// Throws Error if `p` has not the robot's size, a number is not finite, or a body has inertia without mass.
[[nodiscard]] Parts collect(const Robot& robot, const Eigen::VectorXd& p, const std::vector<Effect>& effects);

/// "effect NAME at drive2 (...)".
[[nodiscard]] std::string describe(const Effect& effect, const RobotDescription& robot);

/// For a format that has no place for effects: adds them all to what is left out.
void leave_effects_out(const RobotDescription& robot, Parts& parts);

using robot_file::text;

/// Lines of a comment with what the format does not hold; empty if nothing.
[[nodiscard]] std::string left_out_comment(const std::vector<std::string>& left_out, const std::string& prefix);

}  // namespace deltadyn::model_export
