#pragma once

#include "deltadyn/core/types.hpp"

namespace deltadyn {

/// Hose or cable on the plate: a force on the plate that depends on its place only, K (r - r0) with stiffnesses along the base's axes:
/// the drives bear J^T (f0 + K (r - r_ref)). Amplitudes: f0 [N] of either sign at the reference r_ref, K [N/m] > 0.
/// Six columns: f0 along x, y, z and K along x, y, z. f0 along z is borne as a change of the plate's mass would be.
/// Valid for slack loops that hang softly; no damping, no hysteresis.
template <class T>
Vector3<T> hose_stretch(const Vector3<T>& position, const Vector3<T>& reference) {
  return position - reference;
}

}  // namespace deltadyn
