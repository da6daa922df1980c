#include "robot_of.hpp"

namespace deltadyn::detail {
template std::unique_ptr<Robot> make_robot_of<Axis>(const RobotDescription&, const ParameterOptions&);
template std::unique_ptr<Robot> make_robot_of<LinearAxis>(const RobotDescription&, const ParameterOptions&);
}  // namespace deltadyn::detail
