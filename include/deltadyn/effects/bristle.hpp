#pragma once

#include <cmath>

namespace deltadyn {

/// Bristle state of friction after a reversal (Dahl 1968; the state of LuGre without its Stribeck curve): it does not
/// jump but builds up over a displacement. State z in [-1, 1], the friction as a share of Coulomb's:
///   dz/dt = (v - |v| z) / x_s,   F = Fc z,   Fc > 0 [N m | N]
/// with the bristle displacement x_s > 0 [rad | m], 1e-5 to 0.1 rad. With damping of the bristles F = Fc (z + T dz/dt),
/// T = sigma_1 / sigma_0 of LuGre [s], 0 to 0.02 s: right after a reversal the friction is ahead of its state.
/// Valid between breakaway and gross sliding, any speed. Source: Canudas de Wit et al., IEEE TAC 40(3), 1995.
template <class T>
class Bristle {
 public:
  explicit Bristle(const T& displacement, const T& state = T(0)) : displacement_(displacement), state_(state) {}

  /// Moves the joint by `step` [rad | m] (exact for any size of step) and returns z.
  const T& move(const T& step) {
    using std::abs;
    using std::exp;
    if (step == T(0)) return state_;
    const T end = step > T(0) ? T(1) : T(-1);
    state_ = end + (state_ - end) * exp(-abs(step) / displacement_);
    return state_;
  }
  const T& state() const { return state_; }

 private:
  T displacement_, state_;
};

/// dz/dt.
template <class T>
T bristle_rate(const T& rate, const T& state, const T& displacement) {
  using std::abs;
  return (rate - abs(rate) * state) / displacement;
}

/// z + T dz/dt: what damped bristles hold of Coulomb's friction.
/// \param damping  T [s], at least 0
template <class T>
T damped_bristle(const T& rate, const T& state, const T& displacement, const T& damping) {
  return state + damping * bristle_rate(rate, state, displacement);
}

}  // namespace deltadyn
