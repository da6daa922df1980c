#pragma once

namespace deltadyn {

/// Constant offset of a drive's measured torque: parameter c [N m | N], of either sign (amplifier offset, asymmetric friction).
template <class T>
T torque_offset() {
  return T(1);
}

}  // namespace deltadyn
