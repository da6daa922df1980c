#pragma once

/// \file
/// One step of the embedded Runge-Kutta pair 5(4) of Dormand and Prince (J. Comp. Appl. Math. 6, 1980).

namespace deltadyn {

/// x(t + h) to fifth order, with the difference to the fourth-order solution as an estimate of the error.
/// \tparam State   Eigen column vector
/// \tparam System  bool(double t, const State& x, State& derivative); false stops the step
/// \param rate_0   derivative at (t, x)
/// \param rate_1   derivative at (t + h, next): the first of the next step
/// \return false if the system could not be evaluated on the way
template <class State, class System>
[[nodiscard]] bool dormand_prince_step(System&& system, double t, double h, const State& x, const State& rate_0,
                                       State& next, State& rate_1, State& error) {
  State k2, k3, k4, k5, k6;
  const auto at = [&](double c, const auto& sum, State& k) {
    next = x + h * sum;
    return system(t + c * h, next, k);
  };
  const State& k1 = rate_0;
  if (!at(1.0 / 5, k1 / 5, k2)) return false;
  if (!at(3.0 / 10, (3.0 / 40) * k1 + (9.0 / 40) * k2, k3)) return false;
  if (!at(4.0 / 5, (44.0 / 45) * k1 - (56.0 / 15) * k2 + (32.0 / 9) * k3, k4)) return false;
  if (!at(8.0 / 9, (19372.0 / 6561) * k1 - (25360.0 / 2187) * k2 + (64448.0 / 6561) * k3 - (212.0 / 729) * k4, k5))
    return false;
  if (!at(1.0,
          (9017.0 / 3168) * k1 - (355.0 / 33) * k2 + (46732.0 / 5247) * k3 + (49.0 / 176) * k4 - (5103.0 / 18656) * k5,
          k6)) {
    return false;
  }
  if (!at(1.0, (35.0 / 384) * k1 + (500.0 / 1113) * k3 + (125.0 / 192) * k4 - (2187.0 / 6784) * k5 + (11.0 / 84) * k6,
          rate_1)) {
    return false;
  }
  error = h * ((71.0 / 57600) * k1 - (71.0 / 16695) * k3 + (71.0 / 1920) * k4 - (17253.0 / 339200) * k5 +
               (22.0 / 525) * k6 - (1.0 / 40) * rate_1);
  return true;
}

}  // namespace deltadyn
