#pragma once

namespace deltadyn {

/// Inertia of rotor and gear of a drive: torque I qdd, parameter I [kg m^2 | kg] as seen at the output, I > 0.
/// Leaves out the gyroscopic torque of a rotor whose axis moves; the drives of a Delta stand on the base, so there is none.
template <class T>
T rotor_inertia(const T& drive_acceleration) {
  return drive_acceleration;
}

}  // namespace deltadyn
