#include "task_regressor_of.hpp"

namespace deltadyn::detail {
template std::unique_ptr<TaskRegressor> make_task_regressor_of<LinearDelta3>(const Robot&);
}  // namespace deltadyn::detail
