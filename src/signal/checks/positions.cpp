/// \file
/// Positions and rates that the robot cannot have are in another unit.

#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/log_columns.hpp"

#include "checks.hpp"
#include "sample_stretches.hpp"

namespace deltadyn::checks {
namespace {

constexpr double kLargestLimbAngle = 3.3;  // rad; no arm of a Delta turns beyond half a turn

void check_rate(const CheckRoom& room, Index d, const std::string& column) {
  const Log& log = room.log;
  const double allowed = room.robot.limits[static_cast<std::size_t>(d)].velocity;
  if (!std::isfinite(allowed) || allowed <= 0) return;
  std::vector<double> speeds;
  for (const auto& [begin, end] : sample_stretches(log.samples(), 256)) {
    for (Index i = begin; i + 1 < end; ++i)
      speeds.push_back(std::abs(log.q(i + 1, d) - log.q(i, d)) / log.sample_time_s());
  }
  const double usual_largest = quantile(speeds, 0.95);
  if (usual_largest > 10.0 * allowed) {
    throw Error(
        fmt::format(
            "a velocity of {:.4g} is far beyond the drive's limit of {:.4g} (SI); positions or time have another unit",
            usual_largest, allowed),
        room.where(0, column), "give positions in rad or m, or name the column _deg; give the time in seconds");
  }
}

}  // namespace

void check_positions(CheckRoom& room) {
  const Log& log = room.log;
  const RobotDescription& robot = room.robot;
  for (Index d = 0; d < log.q.cols(); ++d) {
    const auto drive = static_cast<int>(d);
    const std::string column = drive_columns(robot, drive).q;
    const bool limb = static_cast<std::size_t>(d) < robot.limbs.size();
    const bool delta = !robot.parts.empty();
    Index at = 0;
    const double largest = log.q.col(d).cwiseAbs().maxCoeff(&at);
    const double value = log.q(at, d);
    const bool refuse = room.options.refuse_positions && limb && delta;
    if (refuse && room.turns(d) && largest > kLargestLimbAngle) {
      throw Error(fmt::format("an arm angle of {:.9g} rad is beyond half a turn; it looks like degrees", value),
                  room.where(at, column), fmt::format("name the column q{}_deg, or convert it to rad", d + 1));
    }
    if (refuse && !room.turns(d)) {
      const auto& geometry = robot.limbs[static_cast<std::size_t>(d)];
      const double reach = 10.0 * (geometry.strut + geometry.p_WD.norm() + geometry.p_DE_0.norm());
      if (largest > reach) {
        throw Error(
            fmt::format("a carriage position of {:.9g} m is far beyond the robot; it looks like millimetres", value),
            room.where(at, column), "convert the column to m");
      }
    }
    if (room.options.refuse_positions && room.options.motion && log.samples() >= 3) check_rate(room, d, column);
  }
}

}  // namespace deltadyn::checks
