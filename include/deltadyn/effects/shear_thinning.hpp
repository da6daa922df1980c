#pragma once

#include <cmath>

#include "deltadyn/effects/coulomb_friction.hpp"

namespace deltadyn {

/// Law of the shear rate.
enum class ShearLaw {
  exponential,  ///< -exp(-|v|/v0) sign(v): Coulomb friction that builds up with speed
  power         ///< |v/v0|^a sign(v) with a < 1: the viscosity of grease falls with speed
};

template <class T>
struct ShearThinningShape {
  T rate = T(1);        ///< v0 > 0 [rad/s | m/s]; 1 % to 100 % of the largest rate
  T exponent = T(0.5);  ///< a of the power law, 0 < a < 1; without meaning for the exponential law
};

/// Shear-thinning grease: a deficit of friction at low speed beside a straight line through the high speeds, as drive 4 of the paper
/// (VIII.C) has it. Amplitude dF [N m | N], dF > 0. Valid in the full lubricant film at constant temperature.
/// Source: Ostwald-de Waele power law; Hamrock, Fundamentals of Fluid Film Lubrication, 2004, chapter 4.
template <class T>
T shear_thinning(const T& rate, const ShearThinningShape<T>& shape, ShearLaw law = ShearLaw::exponential) {
  using std::abs;
  using std::exp;
  using std::pow;
  const T x = abs(rate) / shape.rate;
  if (law == ShearLaw::power) return x > T(0) ? T(pow(x, shape.exponent) * coulomb_friction(rate)) : T(0);
  return -exp(-x) * coulomb_friction(rate);
}

}  // namespace deltadyn
