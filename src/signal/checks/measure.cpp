/// \file
/// What is measured of every log and stands in summaries: resolution, noise, travel.

#include <cmath>
#include <fmt/format.h>

#include "deltadyn/signal/log_columns.hpp"

#include "checks.hpp"

namespace deltadyn::checks {
namespace {

void add(const CheckRoom& room, const char* key, Index drive, double value, const std::string& unit,
         const std::string& text) {
  room.tell({.key = key,
             .drive = static_cast<int>(drive),
             .value = value,
             .unit = unit,
             .text = room.log.file + ": " + text});
}

std::string step_in_words(const std::string& column, double step, const std::string& unit) {
  return step > 0 ? fmt::format("{} is quantised to {:.3g} {}", column, step, unit)
                  : column + " has no step that is visible beside its noise";
}

/// A channel that is fresh only now and again has numbers only there by now, and is measured at its own rate.
ChannelQuality quality_of(const Eigen::Ref<const Eigen::VectorXd>& values, int rows_a_value) {
  if (rows_a_value <= 1) return measure_channel(values);
  Eigen::VectorXd fresh(values.size());
  Index count = 0;
  for (const double value : values) {
    if (std::isfinite(value)) fresh(count++) = value;
  }
  return measure_channel(fresh.head(count));
}

}  // namespace

void measure_channels(CheckRoom& room) {
  const Log& log = room.log;
  for (Index d = 0; d < log.drives(); ++d) {
    const DriveColumns names = drive_columns(room.robot, static_cast<int>(d));
    const std::string length = room.turns(d) ? "rad" : "m";
    const std::string effort = room.turns(d) ? "N*m" : "N";
    const ChannelQuality q = quality_of(log.q.col(d), room.stale_positions[static_cast<std::size_t>(d)]);
    add(room, "step", d, q.step, length, step_in_words(names.q, q.step, length));
    add(room, "noise", d, q.noise, length, fmt::format("{} has noise of {:.3g} {}", names.q, q.noise, length));
    add(room, "travel", d, q.travel, length, fmt::format("{} travels {:.4g} {}", names.q, q.travel, length));
    if (room.stale_positions[static_cast<std::size_t>(d)] == 1) {
      add(room, "stale", d, 1.0, "rows", names.q + " is fresh in every row");
    }
    if (log.tau.size() == 0) continue;
    const ChannelQuality tau = measure_channel(log.tau.col(d));
    add(room, "torque_step", d, tau.step, effort, step_in_words(names.tau, tau.step, effort));
    add(room, "torque_noise", d, tau.noise, effort,
        fmt::format("{} has noise of {:.3g} {}", names.tau, tau.noise, effort));
  }
}

}  // namespace deltadyn::checks
