#include "support/core_instances.hpp"

namespace deltadyn {
DELTADYN_SLOPE_INSTANCES(, LinearDelta3)
}  // namespace deltadyn
