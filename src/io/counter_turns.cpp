#include "counter_turns.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "common_grid.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;

/// A machine may overshoot its limits, and a robot file round them, by this share of the range.
constexpr double kOvershoot = 0.02;

/// The range of numbers that a counter without a jump may have: a turn of its angle, or of counts the encoder's turn or
/// a usual number of bits. 0: none.
double likely_wrap(const ValueRange& recorded, const ChannelMap& map) {
  const auto unit = log_unit(map.unit);
  if (!unit) return 0.0;
  const auto holds = [&](double wrap) {
    const double slack = 1e-9 * wrap;
    return (recorded.low >= -slack && recorded.high <= wrap + slack) ||
           (recorded.low >= -wrap / 2 - slack && recorded.high <= wrap / 2 + slack);
  };
  if (unit->dimension == Dimension::angle) {
    const double turn = 2.0 * std::numbers::pi / unit->factor / std::abs(map.scale);
    return holds(turn) ? turn : 0.0;
  }
  if (unit->dimension != Dimension::counts || std::abs(map.scale) != 1.0) return 0.0;
  if (map.counts_per_turn && holds(*map.counts_per_turn)) return *map.counts_per_turn;
  for (const int bits : {16, 24, 32}) {
    if (holds(std::ldexp(1.0, bits))) return std::ldexp(1.0, bits);
  }
  return 0.0;
}

/// Numbers of turns of the counter with which the travel lies inside the limits.
struct Fitting {
  double first = 0, count = 0;
};

Fitting fitting_turns(const ValueRange& travel, double turn, const DriveLimits& limits) {
  const double slack = kOvershoot * (limits.upper - limits.lower);
  const double first = std::ceil((limits.lower - slack - travel.low) / turn);
  const double last = std::floor((limits.upper + slack - travel.high) / turn);
  return {first, std::max(0.0, last - first + 1.0)};
}

}  // namespace

std::string settle_counter(Eigen::Ref<Eigen::VectorXd> values, const ChannelMap& map, double factor, DriveKind kind,
                           const DriveLimits& limits) {
  double wrap = map.wrap ? *map.wrap : find_wrap(values, map.counts_per_turn.value_or(0.0));
  const bool seen = wrap > 0;
  const ValueRange recorded = range_of(values);
  const Index jumps = seen ? unwrap(values, wrap) : 0;
  std::string done;
  if (jumps > 0)
    done = fmt::format("the number begins again after {:.10g}; {} jump{} taken out", wrap, jumps,
                       jumps == 1 ? " was" : "s were");
  const std::string as_it_is =
      done.empty() || map.offset != 0
          ? done
          : done + ", and the first value taken as it is (offset in the column map if that is another turn)";
  if (!std::isfinite(limits.lower) || !std::isfinite(limits.upper)) return as_it_is;
  if (!seen) wrap = likely_wrap(recorded, map);
  const ValueRange numbers = range_of(values);
  const double one = factor * numbers.low, other = factor * numbers.high, shift = factor / map.scale * map.offset;
  const ValueRange travel{std::min(one, other) + shift, std::max(one, other) + shift};
  const double turn = std::abs(factor) * wrap;
  if (!(turn > 0) || !std::isfinite(travel.width())) return as_it_is;
  const Fitting fitting = fitting_turns(travel, turn, limits);
  const char* unit = kind == DriveKind::revolute ? "rad" : "m";
  const std::string inside =
      fmt::format("the limits of the robot file, {:.4g} to {:.4g} {}", limits.lower, limits.upper, unit);
  if (fitting.count == 1) {
    const double turns = factor > 0 ? fitting.first : -fitting.first;
    if (turns == 0) return done;
    values.array() += turns * wrap;
    const bool one_turn = std::abs(turns) == 1;
    return fmt::format("{}{}{:.0f} turn{} of {:.10g} {}, so that it moves inside {}", done, done.empty() ? "" : "; ",
                       std::abs(turns), one_turn ? "" : "s", wrap,
                       fmt::format("{} {}", one_turn ? "was" : "were", turns > 0 ? "added" : "subtracted"), inside);
  }
  if (fitting.count == 0 || !seen || jumps == 0 || map.offset != 0) return as_it_is;
  return fmt::format(
      "{}, and the first value taken as it is, which is open: {:.0f} turns of the counter fit {}; if the joint started "
      "elsewhere, give offset = {:.10g} [{}] times the turns it is off in the column map",
      done, fitting.count, inside, map.scale * wrap, map.unit);
}

}  // namespace deltadyn
