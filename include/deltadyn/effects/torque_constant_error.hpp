#pragma once

namespace deltadyn {

/// A wrong torque constant of one drive: the torque that the log states is (1 + eps) times the true one. Column: the drive's torque
/// [N m | N]; amplitude eps [1] of either sign, |eps| < 0.5. The same error on all drives scales every parameter and cannot be seen.
template <class T>
T torque_constant_error(const T& torque) {
  return torque;
}

}  // namespace deltadyn
