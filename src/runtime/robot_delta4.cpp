#include "robot_of.hpp"

namespace deltadyn::detail {
template std::unique_ptr<Robot> make_robot_of<Delta4>(const RobotDescription&, const ParameterOptions&);
}  // namespace deltadyn::detail
