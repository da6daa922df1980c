#pragma once

/// \file
/// A torque column moved in time, or freed from a first-order low pass.

#include <Eigen/Core>

namespace deltadyn {

/// Behind the low pass T dy/dt + y = x, exact for an x that is linear between its samples; starts at rest in x(0).
/// \param T_s  above 0 [s]
[[nodiscard]] Eigen::VectorXd first_order_low_pass(const Eigen::Ref<const Eigen::VectorXd>& x, double step_s,
                                                   double T_s);

/// What was recorded, set right: x(t) = y(t + delay) for a delay alone, with a lag the inverse of the low pass besides.
/// Band-limited interpolation by a windowed sinc. The inverse of a low pass lifts noise with frequency; it ends where
/// it would lift more than four times, well above the band of a motion. The ends, where the record does not reach, hold
/// the nearest value.
/// \param delay_s  positive: the record is late
/// \param lag_s    positive: the record is behind this low pass; negative: the record is to be put behind it
/// \return         as long as y
[[nodiscard]] Eigen::VectorXd mend_timing(const Eigen::Ref<const Eigen::VectorXd>& y, double step_s, double delay_s,
                                          double lag_s);

/// The same for a delay that changes from sample to sample: x(t) = y(t + delay(t)).
/// \param delay_s  one a sample [s]
[[nodiscard]] Eigen::VectorXd mend_delays(const Eigen::Ref<const Eigen::VectorXd>& y, double step_s,
                                          const Eigen::Ref<const Eigen::VectorXd>& delay_s);

}  // namespace deltadyn
