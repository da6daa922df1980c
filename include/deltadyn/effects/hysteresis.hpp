#pragma once

#include <cmath>

namespace deltadyn {

/// Shape of a Bouc-Wen loop.
template <class T>
struct HysteresisShape {
  T displacement = T(0.1);  ///< D > 0 [rad | m], over which the loop closes: 0.02 to 1 rad, wider than presliding
  T exponent = T(2);        ///< n >= 1: how sharp the knee is; n = 1 is Dahl's law
};

/// Hysteresis of flexsplines, cables and belts (Bouc 1967, Wen 1976): state z in [-1, 1],
///   dz/dt = (v - (|v| |z|^(n-1) z + v |z|^n) / 2) / D,   torque A z, A > 0 [N m | N].
/// Valid for loops that do not depend on the rate. Source: Ismail, Ikhouane, Rodellar, Arch. Comput. Methods Eng. 16, 2009.
template <class T>
T hysteresis_rate(const T& rate, const T& state, const HysteresisShape<T>& shape) {
  using std::abs;
  using std::pow;
  const T size = abs(state);
  const T power = size > T(0) ? T(pow(size, shape.exponent)) : T(0);
  const T sign = state > T(0) ? T(1) : (state < T(0) ? T(-1) : T(0));
  return (rate - T(0.5) * (abs(rate) * power * sign + rate * power)) / shape.displacement;
}

/// The loop over a sampled motion.
template <class T>
class Hysteresis {
 public:
  explicit Hysteresis(const HysteresisShape<T>& shape, const T& state = T(0)) : shape_(shape), state_(state) {}

  /// Moves the joint by `step` [rad | m] and returns z.
  const T& move(const T& step) {
    using std::abs;
    // In steps of at most a twentieth of the displacement, midpoint rule: the error stays below 1e-3.
    const int parts =
        1 +
        static_cast<int>(T(20) * abs(step) / shape_.displacement < T(1000) ? T(20) * abs(step) / shape_.displacement : T(1000));
    const T part = step / T(parts);
    for (int k = 0; k < parts; ++k) {
      const T middle = state_ + T(0.5) * hysteresis_rate(part, state_, shape_);
      state_ += hysteresis_rate(part, middle, shape_);
      if (state_ > T(1)) state_ = T(1);
      if (state_ < T(-1)) state_ = T(-1);
    }
    return state_;
  }
  const T& state() const { return state_; }

 private:
  HysteresisShape<T> shape_;
  T state_;
};

}  // namespace deltadyn
