/// \file
/// Does the robot move, and do all encoders see it?

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/log_columns.hpp"

#include "checks.hpp"
#include "sample_stretches.hpp"

namespace deltadyn::checks {
namespace {

constexpr double kStuck_s = 0.1;  // a position constant for longer while it should move is a stuck encoder

/// Rows of a position that is constant for too long.
Index shortest_hold(double step_s) {
  return std::max<Index>(5, static_cast<Index>(std::lround(kStuck_s / step_s)));
}

/// All other limb drives travel far while this one rests: the closed loops of a Delta make that a rare motion.
bool others_move(const CheckRoom& room, Index drive, Index begin, Index end) {
  const auto limbs = static_cast<Index>(room.robot.limbs.size());
  if (room.robot.parts.empty() || drive >= limbs || limbs < 2) return false;
  for (Index other = 0; other < limbs; ++other) {
    if (other != drive && room.travel(other, begin, end) < 0.2 * room.travel(other, 0, room.log.samples()))
      return false;
    if (other != drive && !room.moves(other)) return false;
  }
  return true;
}

/// Sizes that are usual for the changes of a position, and for the changes of its change.
struct Usual {
  double step = 0;
  double bend = 0;
};

Usual usual_of(const Eigen::Ref<const Eigen::VectorXd>& q) {
  std::vector<double> steps, bends;
  for (const auto& [begin, end] : sample_stretches(q.size(), 256)) {
    for (Index i = begin + 1; i < end; ++i) {
      const double step = std::abs(q(i) - q(i - 1));
      if (std::isfinite(step)) steps.push_back(step);  // numbers may be missing
    }
    for (Index i = begin + 1; i + 1 < end; ++i) {
      const double bend = std::abs(q(i + 1) - 2.0 * q(i) + q(i - 1));
      if (std::isfinite(bend)) bends.push_back(bend);
    }
  }
  return {quantile(steps, 0.995), quantile(bends, 0.995)};
}

/// Does the position of a drive that is constant in [begin, end) freeze in motion, or jump when it reads again? A drive
/// that stops by itself slows down.
bool breaks_off(const Eigen::Ref<const Eigen::VectorXd>& q, const Usual& usual, Index begin, Index end) {
  const double before = begin >= 4 ? std::abs(q(begin) - q(begin - 3)) / 3.0 : 0.0;
  const double after = end + 3 < q.size() ? std::abs(q(end + 3) - q(end)) / 3.0 : 0.0;
  const double jump = end < q.size() ? std::abs(q(end) - q(end - 1)) : 0.0;
  const bool frozen_in_motion = before > 8.0 * usual.bend || after > 8.0 * usual.bend;
  return frozen_in_motion || (jump > 2.0 * usual.step && jump > 8.0 * usual.bend);
}

/// First sample after `begin` in which any position differs from that in `begin`.
Index end_of_hold(const Eigen::MatrixXd& q, Index begin) {
  Index end = begin + 1;
  while (end < q.rows() && q.row(end) == q.row(begin)) ++end;
  return end;
}

}  // namespace

void find_frozen_positions(CheckRoom& room) {
  Log& log = room.log;
  const Index n = log.samples(), drives = log.drives();
  if (log.tau.size() == 0 || n < 10 || drives < 2) return;  // of a single drive it may be the encoder
  const double step_s = (log.t_s(n - 1) - log.t_s(0)) / static_cast<double>(n - 1);
  const Index shortest = shortest_hold(step_s);
  std::vector<Usual> usual;
  Tally tally;
  for (Index begin = 0, end = 0; begin < n; begin = end) {
    end = end_of_hold(log.q, begin);
    if (end - begin < shortest || end - begin == n) continue;
    for (Index d = 0; d < drives && static_cast<Index>(usual.size()) < drives; ++d)
      usual.push_back(usual_of(log.q.col(d)));
    bool broken = false;
    for (Index d = 0; d < drives; ++d)
      broken = broken || breaks_off(log.q.col(d), usual[static_cast<std::size_t>(d)], begin, end);
    if (!broken) continue;
    // The first one was measured.
    const Index from = begin == 0 ? 0 : begin + 1;
    log.q.middleRows(from, end - from).setConstant(std::numeric_limits<double>::quiet_NaN());
    tally.add(from, end - from);
  }
  if (tally.count == 0) return;
  room.tell(FindingLevel::mended, "frozen_positions", tally.first, "", -1, static_cast<double>(tally.count) * step_s,
            "s",
            fmt::format(
                "the positions of all drives stand still and go on with a jump, {:.3g} s in all: servo or recorder was "
                "off; taken as missing",
                static_cast<double>(tally.count) * step_s));
}

void check_excitation(CheckRoom& room) {
  bool anything = false;
  for (Index d = 0; d < room.log.drives(); ++d) anything = anything || room.moves(d);
  if (!anything) {
    throw UnusablePart("nothing moves, so nothing can be learned from the log", room.log.file,
                       "record a motion that uses the workspace, for example one of delta-excite");
  }
  for (Index d = 0; d < room.log.drives(); ++d) {
    if (room.moves(d)) continue;
    const auto drive = static_cast<int>(d);
    room.tell({.level = FindingLevel::warning,
               .key = "hardly_moves",
               .drive = drive,
               .value = room.travel(d, 0, room.log.samples()),
               .unit = room.turns(d) ? "rad" : "m",
               .text = fmt::format("{}: column {} hardly moves", room.log.file, drive_columns(room.robot, drive).q),
               .mend = "record a motion that moves this drive"});
  }
}

void check_stuck(CheckRoom& room) {
  const Log& log = room.log;
  const Index shortest = shortest_hold(log.sample_time_s());
  for (Index d = 0; d < log.drives(); ++d) {
    const auto q = log.q.col(d);
    const Usual usual = usual_of(q);
    for_each_run(q, [&](Index begin, Index end) {
      if (end - begin >= shortest && (breaks_off(q, usual, begin, end) || others_move(room, d, begin, end))) {
        throw Error(
            fmt::format("the position stays at exactly {:.9g} for {:.4g} s while the robot moves: a stuck encoder",
                        q(begin), static_cast<double>(end - begin) * log.sample_time_s()),
            room.where(begin, drive_columns(room.robot, static_cast<int>(d)).q),
            "check the encoder and its cable, and record again; or cut this part out of the log");
      }
    });
  }
}

}  // namespace deltadyn::checks
