#pragma once

#include <cmath>

#include "deltadyn/core/rotation.hpp"

namespace deltadyn {

/// One limb differs from the others: its upper arm has another first moment along the arm and another inertia about the drive axis
/// (a cable, a gripper valve, a repair). The two columns of a revolute drive for arm parameters (mcx, Iyy):
///   d(mcx) (-g cos q)  and  d(Iyy) qdd,   amplitudes [kg m] and [kg m^2] of either sign.
/// Valid as long as the struts stay alike; with gravity along -z of the base frame.
template <class T>
struct LimbMismatch {
  T moment;   ///< per kg m
  T inertia;  ///< per kg m^2
};

template <class T>
LimbMismatch<T> limb_inertia_mismatch(const T& position, const T& acceleration, const T& gravity) {
  using std::cos;
  return {T(-gravity * cos(position)), acceleration};
}

}  // namespace deltadyn
