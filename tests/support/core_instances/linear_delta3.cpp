#include "support/core_instances.hpp"

namespace deltadyn {
DELTADYN_NUMBER_INSTANCES(, LinearDelta3)
}  // namespace deltadyn
