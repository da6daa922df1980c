/// \file
/// A torque that is cut off at a level.

#include <algorithm>
#include <fmt/format.h>

#include "deltadyn/signal/log_columns.hpp"

#include "checks.hpp"
#include "sample_stretches.hpp"

namespace deltadyn::checks {
namespace {

constexpr double kMostCutOff = 0.05;  // of samples where the torque is cut off; fewer are only left out of fits
constexpr Index kShortestRun = 3;     // equal values in a row at the level
constexpr Index kFewestClipped = 6;   // rows; fewer are chance
constexpr Index kMostBeyond = 3;      // rows beyond a level that is still the level of a cut: spikes

using Flags = Eigen::Array<bool, Eigen::Dynamic, 1>;

/// The rows of one drive at a level where its torque is cut off.
struct Cut {
  double level = 0;
  std::vector<Index> rows;
};

/// The top of a smooth torque in steps: the levels just below hold as many rows, where a cut leaves few.
bool is_rounded_top(const Eigen::Ref<const Eigen::VectorXd>& tau, const Cut& cut, double sign, double step) {
  if (step <= 0) return false;
  const Eigen::ArrayXd below = sign * (cut.level - tau.array());
  const auto near = (below > 0.5 * step && below < 2.5 * step).count();
  return static_cast<Index>(cut.rows.size()) < 3 * near;
}

/// Runs of at least kShortestRun equal values at the extreme of one sign. A few single samples beyond it are taken for
/// spikes.
Cut cut_of(const Eigen::Ref<const Eigen::VectorXd>& tau, const Flags& out, double step, double sign) {
  Cut best;
  const auto counts = [&](Index begin, Index end) { return end - begin >= kShortestRun && !out(begin); };
  // The extreme among values that occur in runs.
  bool any = false;
  for_each_run(tau, [&](Index begin, Index end) {
    if (!counts(begin, end) || (any && sign * tau(begin) <= sign * best.level)) return;
    best.level = tau(begin);
    any = true;
  });
  if (!any) return best;
  Index beyond = 0;
  for_each_run(tau, [&](Index begin, Index end) {
    if (tau(begin) == best.level && counts(begin, end)) {
      for (Index i = begin; i < end; ++i) best.rows.push_back(i);
    } else if (sign * tau(begin) > sign * best.level) {
      beyond += end - begin;
    }
  });
  if (beyond > kMostBeyond || is_rounded_top(tau, best, sign, step)) best.rows.clear();
  return best;
}

}  // namespace

void check_saturation(CheckRoom& room) {
  const Log& log = room.log;
  const Index n = log.samples();
  for (Index d = 0; d < log.tau.cols(); ++d) {
    const auto tau = log.tau.col(d);
    const std::string column = drive_columns(room.robot, static_cast<int>(d)).tau;
    if (tau.maxCoeff() == tau.minCoeff()) continue;
    // A servo that is off also repeats a value; it was found before.
    Flags out = Flags::Constant(n, false);
    if (log.torque_out.size() > 0) out = log.torque_out.col(d);
    const double step = measure_channel(tau).step;
    const Cut above = cut_of(tau, out, step, 1.0);
    const Cut below = cut_of(tau, out, step, -1.0);
    std::vector<Index> rows;
    std::ranges::merge(above.rows, below.rows, std::back_inserter(rows));
    const auto clipped = static_cast<Index>(rows.size());
    // Where the other values repeat too, equality means nothing.
    const Index repeats = (tau.tail(n - 1).array() == tau.head(n - 1).array() && !out.tail(n - 1)).count();
    const Index repeated_elsewhere = std::max<Index>(0, repeats - clipped);
    if (clipped < kFewestClipped || repeated_elsewhere > (n - clipped) / 5) continue;
    const double share = static_cast<double>(clipped) / static_cast<double>(n);
    const std::string levels = above.rows.empty()   ? fmt::format("{:.9g}", below.level)
                               : below.rows.empty() ? fmt::format("{:.9g}", above.level)
                                                    : fmt::format("{:.9g} or {:.9g}", below.level, above.level);
    if (share > kMostCutOff) {
      throw Error(
          fmt::format("the torque is at its extreme ({}) in {:.2g} % of the samples, the first one here: it is cut off",
                      levels, 100.0 * share),
          room.where(rows.front(), column), "record a gentler motion, or widen the range of the recorder");
    }
    for (const Index i : rows) room.log.leave_torque_out(d, i, i + 1);
    room.tell(FindingLevel::mended, "torque_cut_off", rows.front(), column, static_cast<int>(d),
              static_cast<double>(clipped), "rows",
              fmt::format("the torque is cut off at {} from here on in {} samples, left out of fits", levels, clipped));
  }
}

}  // namespace deltadyn::checks
