#include "support/core_instances.hpp"

namespace deltadyn {
DELTADYN_NUMBER_INSTANCES(, Axis)
}  // namespace deltadyn
