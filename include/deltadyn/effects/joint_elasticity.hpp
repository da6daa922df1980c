#pragma once

namespace deltadyn {

/// Which side of the spring the encoder measures.
enum class ElasticEncoder { arm = 0, motor = 1 };

/// A spring of stiffness k between motor and arm. To first order in 1/k (Spong, J. Dyn. Sys. Meas. Control 109, 1987, expands in it) the
/// motor leads the arm by tau/k, tau being the torque that passes the spring. With the encoder on the arm the motor's inertia alone
/// feels it: the drive's torque grows by J_motor/k d2(tau)/dt2. With the encoder on the motor the arm lags behind what is measured,
/// and all drives feel it: the torques of the rigid model fall by its derivative along that lag.
/// Valid well below the resonance sqrt(k/J).

/// Encoder on the arm; amplitude J_motor/k [s^2].
/// \param torque_dd  second time derivative of the torque that passes the spring [N m/s^2 | N/s^2]
template <class T>
T joint_elasticity(const T& torque_dd) {
  return torque_dd;
}

/// Encoder on the motor; amplitude J_arm/k [s^2].
/// \param along_lag       change of a drive's torque in the rigid model, motor included, for a lag of the elastic joint as large as the
///                        torque that passes the spring, per unit of it
/// \param motor_torque_dd motor inertia times torque_dd at the elastic drive, which does not lag; 0 at the others
/// \param arm_inertia     inertia of the drive without its motor [kg m^2 | kg]
template <class T>
T joint_elasticity(const T& along_lag, const T& motor_torque_dd, const T& arm_inertia) {
  return (motor_torque_dd - along_lag) / arm_inertia;
}

}  // namespace deltadyn
