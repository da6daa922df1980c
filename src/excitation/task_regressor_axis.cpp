#include "task_regressor_of.hpp"

namespace deltadyn::detail {
template std::unique_ptr<TaskRegressor> make_task_regressor_of<Axis>(const Robot&);
template std::unique_ptr<TaskRegressor> make_task_regressor_of<LinearAxis>(const Robot&);
}  // namespace deltadyn::detail
