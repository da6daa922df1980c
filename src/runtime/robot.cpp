#include "deltadyn/runtime/robot.hpp"

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/geometry_of.hpp"

namespace deltadyn {

namespace detail {

/// In robot_of.hpp, compiled for each type in src/robots.
template <class R>
std::unique_ptr<Robot> make_robot_of(const RobotDescription& description, const ParameterOptions& options);

}  // namespace detail

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
  return with_robot_type(description,
                         [&](auto type) { return detail::make_robot_of<decltype(type)>(description, options); });
}

}  // namespace deltadyn
