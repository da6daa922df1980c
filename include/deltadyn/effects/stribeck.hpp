#pragma once

#include <cmath>

#include "deltadyn/effects/coulomb_friction.hpp"

namespace deltadyn {

/// Shape of the Stribeck effect.
template <class T>
struct StribeckShape {
  T rate =
      T(0.1);  ///< Stribeck rate vs > 0: where the lubricant begins to carry [rad/s | m/s]; 0.5 % to 50 % of the largest rate
  T exponent = T(1);  ///< delta: 1 (Tustin), 2 (Gauss), 0.5 (Armstrong-Helouvry); 0.5 to 2
};

/// Stribeck effect: dF exp(-|v/vs|^delta) sign(v), amplitude dF [N m | N], dF > 0: more friction at low speed than Coulomb's law says.
/// Valid for a joint that slides; at rest and just after a reversal `presliding` rules. Source: Armstrong-Helouvry, Dupont,
/// Canudas de Wit, Automatica 30(7), 1994, section 2.
template <class T>
T stribeck(const T& rate, const StribeckShape<T>& shape) {
  using std::abs;
  using std::exp;
  using std::pow;
  return exp(-pow(T(abs(rate) / shape.rate), shape.exponent)) * coulomb_friction(rate);
}

}  // namespace deltadyn
