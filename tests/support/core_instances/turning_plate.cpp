#include "support/core_instances.hpp"

namespace deltadyn {
DELTADYN_NUMBER_INSTANCES(, testing_support::TurningPlate)
}  // namespace deltadyn
