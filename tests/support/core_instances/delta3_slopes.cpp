#include "support/core_instances.hpp"

namespace deltadyn {
DELTADYN_SLOPE_INSTANCES(, Delta3)
}  // namespace deltadyn
