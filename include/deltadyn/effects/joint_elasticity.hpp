#pragma once

namespace deltadyn {

/// A spring of stiffness k between motor and arm. To first order in 1/k the torque differs from the rigid one by c d2(tau)/dt2 with the
/// torque tau behind the spring; amplitude c [s^2]: J_motor/k > 0 if the encoder sits on the arm, -J_arm/k < 0 if on the motor.
/// Valid well below the resonance sqrt(k/J). Source: Spong, J. Dyn. Sys. Meas. Control 109, 1987 (the expansion in 1/k).
/// \param torque_dd  second time derivative of the rigid model's torque behind the spring [N m/s^2 | N/s^2]
template <class T>
T joint_elasticity(const T& torque_dd) {
  return torque_dd;
}

}  // namespace deltadyn
