#pragma once

/// \file
/// The least value of a function of one variable by golden section (Kiefer 1953): one evaluation a step, no derivative.

#include <cmath>
#include <numbers>

namespace deltadyn {

/// Share of the interval that a step of golden section leaves.
inline constexpr double kGoldenShare = 1 / std::numbers::phi;

/// Where f is least between two ends: the middle of the interval that is left after `steps` steps. If f has several
/// minima, one of them. f is evaluated steps + 2 times, never at the ends.
/// \param f          double f(double)
/// \param low, high  ends, low <= high
template <class Function>
[[nodiscard]] double golden_section(const Function& f, double low, double high, int steps) {
  double a = high - kGoldenShare * (high - low), b = low + kGoldenShare * (high - low), f_a = f(a), f_b = f(b);
  for (int step = 0; step < steps; ++step) {
    if (f_a < f_b) {
      high = b;
      b = a;
      f_b = f_a;
      a = high - kGoldenShare * (high - low);
      f_a = f(a);
    } else {
      low = a;
      a = b;
      f_a = f_b;
      b = low + kGoldenShare * (high - low);
      f_b = f(b);
    }
  }
  return 0.5 * (low + high);
}

/// The same in the logarithm of the variable: where f is least between low and high, both above 0.
/// \param ratio  of the interval's ends at which it stops, above 1
template <class Function>
[[nodiscard]] double golden_section_in_logarithm(const Function& f, double low, double high, double ratio = 1.01) {
  int steps = 0;
  for (double width = std::log(high / low); width > std::log(ratio); width *= kGoldenShare) ++steps;
  return std::exp(golden_section([&](double x) { return f(std::exp(x)); }, std::log(low), std::log(high), steps));
}

}  // namespace deltadyn
