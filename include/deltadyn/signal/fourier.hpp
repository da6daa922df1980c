#pragma once

/// \file
/// Periodic motions: the period, a Fourier series with exact derivatives, and the mean over the periods.

#include <Eigen/Core>
#include <optional>

#include "deltadyn/signal/log.hpp"

namespace deltadyn {

/// x(t) = c_0 + sum_k a_k cos(k omega t) + b_k sin(k omega t), for several channels.
struct FourierFit {
  double base_frequency_hz = 0.0;
  int harmonics = 0;
  Eigen::MatrixXd coefficients;  ///< (1 + 2 harmonics) x channels: c_0, a_1, b_1, a_2, b_2, ...

  /// Value (derivative 0) or exact derivative at the given times; times x channels.
  [[nodiscard]] Eigen::MatrixXd evaluate(const Eigen::Ref<const Eigen::VectorXd>& t_s, int derivative = 0) const;
};

/// Least squares over all samples.
/// \param t_s      N times [s], any spacing, N > 1 + 2 harmonics
/// \param columns  N x channels
/// Throws Error(usage) if an argument is out of range.
[[nodiscard]] FourierFit fit_fourier(const Eigen::Ref<const Eigen::VectorXd>& t_s,
                                     const Eigen::Ref<const Eigen::MatrixXd>& columns, double base_frequency_hz,
                                     int harmonics);

struct Period {
  double period_s = 0.0;  ///< not necessarily a whole number of samples
  int whole_periods = 0;  ///< in the log
};

/// Shortest period with which all drives repeat, seen twice at least; nothing if the motion is not periodic.
[[nodiscard]] std::optional<Period> find_period(const Log& log);

/// One period, averaged.
struct PeriodMean {
  Log log;            ///< one period; q, qd, qdd of the Fourier series, tau the mean over the periods
  FourierFit series;  ///< of q, with time counted from the start of the whole log
  int periods = 0;    ///< that were averaged
};

/// Fits the series to all whole periods and averages the torque over them (interpolated if a period is no whole number
/// of samples). Samples that were filled in do not enter the torque; a phase without a sample is marked in
/// PeriodMean::log.filled. Throws Error(bad_input) if the log holds fewer than two periods.
[[nodiscard]] PeriodMean average_periods(const Log& log, double period_s, int harmonics);

}  // namespace deltadyn
