#include "deltadyn/excitation/task_regressor.hpp"

#include "deltadyn/runtime/geometry_of.hpp"

namespace deltadyn {

namespace detail {

/// In task_regressor_of.hpp, compiled for each type in src/robots.
template <class R>
std::unique_ptr<TaskRegressor> make_task_regressor_of(const Robot& robot);

}  // namespace detail

std::unique_ptr<TaskRegressor> make_task_regressor(const Robot& robot) {
  return with_robot_type(robot.description(),
                         [&](auto type) { return detail::make_task_regressor_of<decltype(type)>(robot); });
}

}  // namespace deltadyn
