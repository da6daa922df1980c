#include "../../excitation/task_regressor_of.hpp"
#include "../../runtime/effect_states_of.hpp"
#include "../../runtime/robot_of.hpp"
#include "../../simulation/mechanism_of.hpp"
#include "../instantiate.hpp"

DELTADYN_INSTANTIATE_ROBOT(Axis)
DELTADYN_INSTANTIATE_ROBOT(LinearAxis)
