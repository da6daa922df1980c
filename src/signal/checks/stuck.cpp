/// \file
/// Does the robot move, and do all encoders see it?

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/signal/log_columns.hpp"

#include "checks.hpp"
#include "statistics.hpp"

namespace deltadyn::checks {
namespace {

/// All other limb drives travel far while this one rests: the closed loops of a Delta make that a rare motion.
bool others_move(const CheckRoom& room, Index drive, Index begin, Index end) {
  const auto limbs = static_cast<Index>(room.robot.limbs.size());
  if (room.robot.parts.empty() || drive >= limbs || limbs < 2) return false;
  for (Index other = 0; other < limbs; ++other) {
    if (other != drive && room.travel(other, begin, end) < 0.2 * room.travel(other, 0, room.log.samples())) return false;
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
    for (Index i = begin + 1; i < end; ++i) steps.push_back(std::abs(q(i) - q(i - 1)));
    for (Index i = begin + 1; i + 1 < end; ++i) bends.push_back(std::abs(q(i + 1) - 2.0 * q(i) + q(i - 1)));
  }
  return {quantile(steps, 0.995), quantile(bends, 0.995)};
}

}  // namespace

void check_excitation(CheckRoom& room) {
  std::vector<std::string> still;
  for (Index d = 0; d < room.log.drives(); ++d) {
    if (!room.moves(d)) still.push_back(drive_columns(room.robot, static_cast<int>(d)).q);
  }
  if (static_cast<Index>(still.size()) == room.log.drives()) {
    throw UnusablePart("nothing moves, so nothing can be learned from the log", room.log.file,
                       "record a motion that uses the workspace, for example one of delta-excite");
  }
  for (Index d = 0; d < room.log.drives(); ++d) {
    if (room.moves(d)) continue;
    LogFinding finding;
    finding.level = FindingLevel::warning;
    finding.key = "hardly_moves";
    finding.drive = static_cast<int>(d);
    finding.value = room.travel(d, 0, room.log.samples());
    finding.unit = room.turns(d) ? "rad" : "m";
    finding.text = fmt::format("{}: column {} hardly moves", room.log.file, drive_columns(room.robot, static_cast<int>(d)).q);
    finding.mend = "record a motion that moves this drive";
    room.tell(std::move(finding));
  }
}

void check_stuck(CheckRoom& room) {
  const Log& log = room.log;
  const Index n = log.samples();
  const auto shortest = std::max<Index>(5, static_cast<Index>(std::lround(room.options.stuck_time_s / log.sample_time_s())));
  for (Index d = 0; d < log.drives(); ++d) {
    const auto q = log.q.col(d);
    const Usual usual = usual_of(q);
    Index begin = 0;
    while (begin < n) {
      Index end = begin + 1;
      while (end < n && q(end) == q(begin)) ++end;
      if (end - begin >= shortest) {
        // A drive that stops by itself slows down; an encoder that fails freezes in motion, or jumps when it reads again.
        const double before = begin >= 4 ? std::abs(q(begin) - q(begin - 3)) / 3.0 : 0.0;
        const double after = end + 3 < n ? std::abs(q(end + 3) - q(end)) / 3.0 : 0.0;
        const double jump = end < n ? std::abs(q(end) - q(end - 1)) : 0.0;
        const bool frozen_in_motion = before > 8.0 * usual.bend || after > 8.0 * usual.bend;
        const bool jumps = jump > 2.0 * usual.step && jump > 8.0 * usual.bend;
        if (frozen_in_motion || jumps || others_move(room, d, begin, end)) {
          throw Error(fmt::format("the position stays at exactly {:.9g} for {:.4g} s while the robot moves: a stuck encoder",
                                  q(begin), static_cast<double>(end - begin) * log.sample_time_s()),
                      room.where(begin, drive_columns(room.robot, static_cast<int>(d)).q),
                      "check the encoder and its cable, and record again; or cut this part out of the log");
        }
      }
      begin = end;
    }
  }
}

}  // namespace deltadyn::checks
