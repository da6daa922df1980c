/// \file
/// A counter that ran over (16 bits, one turn) jumps by its whole range; that is undone.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <optional>

#include "deltadyn/runtime/statistics.hpp"

#include "checks.hpp"

namespace deltadyn::checks {
namespace {

/// A value that runs over goes from one end of its range to the other; lost counts and spikes do not.
constexpr double kWrapShareOfRange = 0.85;
constexpr double kShareOfTurn = 0.9;

/// The modulus that a jump of this size comes from: a whole turn or a power of two of quantisation steps.
std::optional<double> known_modulus(double jump, double step, double tolerance, bool turns) {
  if (turns && std::abs(jump - 2.0 * std::numbers::pi) <= tolerance) return 2.0 * std::numbers::pi;
  if (step <= 0) return std::nullopt;
  for (int bits = 8; bits <= 32; ++bits) {
    const double modulus = std::ldexp(step, bits);
    // The step is known to some parts in a thousand.
    if (std::abs(jump - modulus) <= tolerance + 2e-3 * modulus) return modulus;
  }
  return std::nullopt;
}

/// A torque that is constant on one side of the jump was switched, not counted over.
bool is_switched(const Eigen::Ref<const Eigen::VectorXd>& x, Index i) {
  constexpr Index kSame = 3;
  if (i < kSame || i + kSame > x.size()) return true;
  return (x.segment(i, kSame).array() == x(i)).all() || (x.segment(i - kSame, kSame).array() == x(i - 1)).all();
}

struct Jumps {
  std::vector<Index> rows;  ///< first row behind each jump
  double modulus = 0;
};

/// Size of the jump into row i without what the value itself moves in that step, as it moves in the steps beside it.
double size_of_jump(const Eigen::Ref<const Eigen::VectorXd>& x, Index i, double least) {
  double moved = 0, steps = 0;
  for (const Index k : {i - 1, i + 1}) {
    if (k < 1 || k >= x.size()) continue;
    const double step = x(k) - x(k - 1);
    if (!(std::abs(step) < least)) continue;  // another jump, or a missing number
    moved += step;
    ++steps;
  }
  return std::abs(x(i) - x(i - 1) - (steps > 0 ? moved / steps : 0.0));
}

/// The jumps of at least `least`, if they look like a counter that runs over.
std::optional<Jumps> find_jumps(const Eigen::Ref<const Eigen::VectorXd>& x, const ChannelQuality& quality, double least,
                                bool turns) {
  Jumps jumps;
  std::vector<double> sizes;
  bool up = false, down = false;
  double usual = 0;
  for (Index i = 1; i < x.size(); ++i) {
    const double change = x(i) - x(i - 1);
    if (!(std::abs(change) > least)) {
      usual = std::max(usual, std::abs(change));  // NaN compares false and is passed over
      continue;
    }
    jumps.rows.push_back(i);
    sizes.push_back(size_of_jump(x, i, least));
    (change > 0 ? up : down) = true;
  }
  if (jumps.rows.empty() || usual > 0.4 * least) return std::nullopt;
  const double size = lower_median(sizes);
  const auto modulus = known_modulus(size, quality.step, usual, turns);
  // Several jumps there and back of one size, wider than all else: the size itself is the modulus, to the change of one
  // sample.
  const bool switched = std::ranges::any_of(jumps.rows, [&](Index row) { return is_switched(x, row); });
  if (!modulus && (switched || sizes.size() < 2 || !up || !down)) return std::nullopt;
  jumps.modulus = modulus.value_or(size);
  for (const double one : sizes) {
    if (std::abs(one - size) > 2.0 * usual) return std::nullopt;
  }
  return jumps;
}

/// Whole moduli to add to each row, such that most rows stay as they are.
std::vector<int> turns_of(const Eigen::Ref<const Eigen::VectorXd>& x, const Jumps& jumps) {
  std::vector<int> turns(static_cast<std::size_t>(x.size()), 0);
  int now = 0;
  std::size_t next = 0;
  for (Index i = 0; i < x.size(); ++i) {
    if (next < jumps.rows.size() && jumps.rows[next] == i) {
      now += x(i) > x(i - 1) ? -1 : 1;
      ++next;
    }
    turns[static_cast<std::size_t>(i)] = now;
  }
  const int most = upper_median(turns);
  for (int& turn : turns) turn -= most;
  return turns;
}

/// A torque that jumps where its drive turns back is friction: a counter runs over where the torque is largest.
bool jumps_with_reversals(const Eigen::Ref<const Eigen::VectorXd>& position, const Jumps& jumps) {
  constexpr Index kReach = 3;
  const auto turns_back = std::ranges::count_if(jumps.rows, [&](Index row) {
    const Index before = std::max<Index>(0, row - kReach), after = std::min<Index>(position.size() - 1, row + kReach);
    return (position(row) - position(before)) * (position(after) - position(row)) <= 0;
  });
  return 2 * turns_back >= static_cast<std::ptrdiff_t>(jumps.rows.size());
}

}  // namespace

void unwrap(CheckRoom& room) {
  for (const Channel& channel : room.channels()) {
    if (channel.block != &room.log.q && channel.block != &room.log.tau) continue;
    auto x = channel.block->col(channel.drive);
    const ChannelQuality quality = measure_channel(x);
    if (quality.range <= 0) continue;
    const bool turns_round = channel.position && room.turns(channel.drive);
    auto jumps = find_jumps(x, quality, kWrapShareOfRange * quality.range, turns_round);
    // A whole turn is one also where the drive itself turns further.
    if (!jumps && turns_round) jumps = find_jumps(x, quality, kShareOfTurn * 2.0 * std::numbers::pi, turns_round);
    if (!jumps || (!channel.position && jumps_with_reversals(room.log.q.col(channel.drive), *jumps))) continue;
    // A spike there and back also jumps twice; but it is over after a few samples, and few samples are no evidence of a
    // counter.
    const std::vector<int> turns = turns_of(x, *jumps);
    const auto moved = std::ranges::count_if(turns, [](int turn) { return turn != 0; });
    if (moved < 12) continue;
    for (Index i = 0; i < x.size(); ++i) x(i) += jumps->modulus * turns[static_cast<std::size_t>(i)];
    room.tell(
        FindingLevel::mended, channel.position ? "wrap" : "torque_wrap", jumps->rows.front(), channel.name,
        static_cast<int>(channel.drive), jumps->modulus, "",
        fmt::format("the value jumps by {:.6g} here and {} times in all, the whole range of its counter: unwrapped",
                    jumps->modulus, jumps->rows.size()));
  }
}

}  // namespace deltadyn::checks
