#pragma once

namespace deltadyn {

/// Play in a drive's gear, seen from the motor's encoder: after the load reverses, the motor crosses the gap alone and the rigid
/// model's load is missing: torque -A tau_load while in the gap, 0 <= A <= 1 (1: all of the load hangs behind the gap).
/// State: the motor's place in the gap, x in [-b/2, b/2]; it moves with the motor and stops at the side that the load presses on.
/// Gap b > 0 [rad | m], 1e-4 to 0.05 rad. Valid for stiff flanks without bounce. Source: Nordin, Gutman, Automatica 38, 2002.
template <class T>
class Backlash {
 public:
  explicit Backlash(const T& gap) : half_gap_(gap / T(2)), place_(gap / T(2)) {}

  /// Moves the motor by `step` [rad | m] under the load's torque [N m | N]; true while no flank carries.
  /// With load > 0 the motor has to push in the positive direction: the positive flank carries.
  bool move(const T& step, const T& load) {
    const T flank = load > T(0) ? half_gap_ : -half_gap_;
    if (place_ == flank) return false;  // the load presses the flank: motor and load move together
    // A free motor moves by its own step; what crosses the gap is that step and, if it runs the other way, its size.
    const T size = step > T(0) ? step : -step;
    place_ += load > T(0) ? size : -size;
    if (place_ > half_gap_) place_ = half_gap_;
    if (place_ < -half_gap_) place_ = -half_gap_;
    return place_ != flank;
  }
  const T& place() const { return place_; }

 private:
  T half_gap_, place_;
};

/// The missing torque per unit amplitude.
template <class T>
T backlash(bool in_gap, const T& load) {
  return in_gap ? T(-load) : T(0);
}

}  // namespace deltadyn
