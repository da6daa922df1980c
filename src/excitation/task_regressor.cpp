#include "deltadyn/excitation/task_regressor.hpp"

#include "deltadyn/runtime/error.hpp"

#include "task_regressor_of.hpp"

namespace deltadyn {

std::unique_ptr<TaskRegressor> make_task_regressor(const Robot& robot) {
  const RobotDescription& description = robot.description();
  if (description.type == Delta3::kName) return detail::make_task_regressor_of<Delta3>(robot);
  if (description.type == LinearDelta3::kName) return detail::make_task_regressor_of<LinearDelta3>(robot);
  if (description.type == Delta4::kName) return detail::make_task_regressor_of<Delta4>(robot);
  if (description.type == Axis::kName) {
    return description.drive_kind == DriveKind::prismatic ? detail::make_task_regressor_of<LinearAxis>(robot)
                                                          : detail::make_task_regressor_of<Axis>(robot);
  }
  throw Error("no excitation for robots of type '" + description.type + "'", description.name,
              "use one of delta3, linear-delta3, delta4, axis");
}

}  // namespace deltadyn
