#pragma once

/// \file
/// Torque and position recorded by two clocks that do not run alike: the delay between them grows with the time.

#include <optional>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn::gate {

/// Delay of the torque in one file: `delay_s` at `t_s`, and from there on `rate` more each second.
struct ClockDrift {
  double t_s = 0, delay_s = 0;
  double rate = 0, rate_std = 0;   ///< [s/s]
  double first_s = 0, last_s = 0;  ///< delay at the ends of the file [s]
};

struct ClockDrifts {
  std::vector<ClockDrift> files;  ///< one a file, in the order of file_numbers()
  /// Relative residual with one delay for all, and with a delay for each part of the files.
  double rms_before = 0, rms_after = 0;
};

/// Looks for it by the delays of parts of the files. Nothing unless these lie on a line that rises or falls clearly,
/// and take a quarter of the residual away.
/// \param highest_band_hz  of the sample in which delays are looked for
[[nodiscard]] std::optional<ClockDrifts> find_clock_drift(const Robot& robot, const BaseParameters& base,
                                                          const std::vector<Log>& logs, double highest_band_hz);

/// The torque of all drives as it would be with one clock; what lies beyond the ends of the record is left out.
void take_drift_out(const ClockDrift& drift, Log& log);

}  // namespace deltadyn::gate
