#include "deltadyn/signal/log_check.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

#include "deltadyn/runtime/error.hpp"

#include "checks/checks.hpp"

namespace deltadyn {
namespace {

using checks::CheckRoom;

/// In this order: a check may rely on those before it.
constexpr void (*kChecksOfFile[])(CheckRoom&) = {
    checks::check_length, checks::order_stamps,          checks::check_length,    checks::unwrap,
    checks::find_repeats, checks::find_frozen_positions, checks::drop_blind_rows, checks::measure_channels,
};

constexpr void (*kChecksOfPart[])(CheckRoom&) = {
    checks::put_on_grid,   checks::fill_missing_numbers, checks::move_to_grid,           checks::thin_to_fresh_rows,
    checks::repair_spikes, checks::check_positions,      checks::refuse_too_many_filled, checks::check_excitation,
    checks::check_stuck,   checks::leave_rest_out,       checks::check_constant_torque,  checks::check_saturation,
};

/// Rate and jitter of the file, and that nothing was lost if nothing was.
void add_figures(std::vector<Log>& parts, double largest_jitter, double recorded_rate_hz) {
  Log& first = parts.front();
  const auto add = [&](const char* key, double value, const char* unit, const std::string& text) {
    for (const Log& part : parts) {
      if (std::ranges::find(part.findings, key, &LogFinding::key) != part.findings.end()) return;
    }
    first.findings.push_back(
        {.key = key, .file = first.file, .value = value, .unit = unit, .text = first.file + ": " + text});
  };
  add("rate_hz", recorded_rate_hz, "Hz", fmt::format("recorded at {:.6g} Hz", recorded_rate_hz));
  add("jitter", largest_jitter, "",
      fmt::format("the time stamps are even to {:.2g} % of the time between samples", 100.0 * largest_jitter));
  add("lost_rows", 0.0, "rows", "no row is lost");
  add("held_rows", 0.0, "rows", "no row repeats the one before");
}

}  // namespace

std::vector<Log> check_and_split(Log log, const RobotDescription& robot, const LogCheckOptions& options) {
  double largest_jitter = 0;
  CheckRoom room{log, robot, options, largest_jitter};
  checks::check_counts(room);
  if (!options.motion) {
    checks::refuse_missing_numbers(room);
    checks::check_positions(room);
    return {std::move(log)};
  }
  for (const auto check : kChecksOfFile) check(room);
  std::vector<Log> parts = checks::split(room);
  std::vector<Log> usable;
  std::optional<Error> refused;
  // Of parts that are not used: what was said of the file as a whole stands with its first part
  std::vector<LogFinding> carried;
  std::vector<std::string> carried_notes;
  double recorded_rate_hz = 0;
  for (Log& part : parts) {
    CheckRoom of_part{part, robot, options, largest_jitter};
    of_part.stale_positions = room.stale_positions;
    of_part.stale_torques = room.stale_torques;
    of_part.thinning = room.thinning;
    try {
      for (const auto check : kChecksOfPart) {
        check(of_part);
        if (check == checks::put_on_grid && recorded_rate_hz == 0) recorded_rate_hz = 1.0 / of_part.grid.step_s;
      }
      usable.push_back(std::move(part));
    } catch (const checks::UnusablePart& error) {
      if (parts.size() == 1) throw;
      if (!refused) refused = error;
      carried.insert(carried.end(), part.findings.begin(), part.findings.end());
      carried_notes.insert(carried_notes.end(), part.notes.begin(), part.notes.end());
      carried_notes.push_back(fmt::format("{}: part {} is not used: {}", error.where(), part.part, error.problem()));
      carried.push_back({.level = FindingLevel::warning,
                         .key = "unusable_part",
                         .file = part.file,
                         .text = carried_notes.back(),
                         .mend = error.mend().empty() ? "record this part again if it is needed; the others are used"
                                                      : error.mend()});
    }
  }
  if (usable.empty()) throw *refused;
  for (std::size_t k = 0; k < usable.size(); ++k) usable[k].part = parts.size() > 1 ? static_cast<int>(k) + 1 : 0;
  Log& first = usable.front();
  first.notes.insert(first.notes.end(), carried_notes.begin(), carried_notes.end());
  first.findings.insert(first.findings.end(), carried.begin(), carried.end());
  add_figures(usable, largest_jitter, recorded_rate_hz);
  return usable;
}

void check_and_repair(Log& log, const RobotDescription& robot, const LogCheckOptions& options) {
  std::vector<Log> parts = check_and_split(log, robot, options);
  if (parts.size() > 1) {
    throw Error(fmt::format("the log falls into {} parts", parts.size()), log.file,
                "use check_and_split() and take the parts");
  }
  log = std::move(parts.front());
}

}  // namespace deltadyn
