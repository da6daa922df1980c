#pragma once

namespace deltadyn {

/// A geometry parameter kappa that is not what the robot file says: the torque changes by d(Y p)/d(kappa) per unit.
/// Kinds: the home position of a drive (q + delta in place of q [rad | m]), an arm's length [m], a strut's length [m].
/// Amplitude of either sign: below 0.05 rad, 1 % of a length. Valid to first order. Differentiated by a central difference of width
/// `kinematic_step`, small beside any real error and large beside rounding.
enum class KinematicOffset { home, arm, strut };

template <class T>
T kinematic_step() {
  return T(1e-4);
}

/// d(tau)/d(kappa) from the torques at kappa + step and kappa - step.
/// \tparam T  a scalar, or an Eigen array of one torque a drive
template <class T, class Scalar>
T kinematic_offset(const T& torque_plus, const T& torque_minus, const Scalar& step) {
  return (torque_plus - torque_minus) / (Scalar(2) * step);
}

}  // namespace deltadyn
