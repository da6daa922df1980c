#include "deltadyn/runtime/robot.hpp"

#include "deltadyn/runtime/error.hpp"

#include "robot_of.hpp"

namespace deltadyn {

std::vector<Eigen::Index> coulomb_columns(const Robot& robot) {
  std::vector<Eigen::Index> columns;
  for (int k = 0; k < robot.parameters(); ++k)
    if (robot.parameter_ids()[static_cast<std::size_t>(k)].kind == ParameterKind::coulomb) columns.push_back(k);
  return columns;
}

std::unique_ptr<Robot> make_robot(const RobotDescription& description, const ParameterOptions& options) {
  description.validate(description.name);
  for (const int drive : options.rotor_inertia) {
    if (drive < 1 || drive > description.drives()) {
      throw Error("rotor inertia of drive " + std::to_string(drive) + " asked for", description.name,
                  "the robot has drives 1 to " + std::to_string(description.drives()), ExitCode::usage);
    }
  }
  const bool prismatic = description.drive_kind == DriveKind::prismatic;
  if (description.type == Delta3::kName) return detail::make_robot_of<Delta3>(description, options);
  if (description.type == LinearDelta3::kName) return detail::make_robot_of<LinearDelta3>(description, options);
  if (description.type == Delta4::kName) return detail::make_robot_of<Delta4>(description, options);
  if (description.type == Axis::kName) {
    return prismatic ? detail::make_robot_of<LinearAxis>(description, options)
                     : detail::make_robot_of<Axis>(description, options);
  }
  throw Error("robot type '" + description.type + "' is not known", description.name,
              "use one of delta3, linear-delta3, delta4, axis");
}

}  // namespace deltadyn
