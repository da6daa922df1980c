#include "support/core_instances.hpp"

namespace deltadyn {
DELTADYN_NUMBER_INSTANCES(, Delta3)
}  // namespace deltadyn
