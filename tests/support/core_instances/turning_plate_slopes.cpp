#include "support/core_instances.hpp"

namespace deltadyn {
DELTADYN_SLOPE_INSTANCES(, testing_support::TurningPlate)
}  // namespace deltadyn
