#include "deltadyn/excitation/task_regressor.hpp"

#include "deltadyn/runtime/geometry_of.hpp"

#include "task_regressor_of.hpp"

namespace deltadyn {

std::unique_ptr<TaskRegressor> make_task_regressor(const Robot& robot) {
  return with_robot_type(robot.description(),
                         [&](auto type) { return detail::make_task_regressor_of<decltype(type)>(robot); });
}

}  // namespace deltadyn
