/// \file
/// The time stamps themselves: rows that are there twice, single wrong stamps, a clock too coarse for the rate, several
/// recordings in one file.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/statistics.hpp"

#include "checks.hpp"
#include "sample_stretches.hpp"

namespace deltadyn::checks {
namespace {

/// A clock repeats stamps for more rows than this share only if it is too coarse; fewer are single mistakes.
constexpr double kCoarseStampShare = 0.02;

bool same_row(const CheckRoom& room, Index a, Index b) {
  const Log& log = room.log;
  for (const Eigen::MatrixXd* block : {&log.q, &log.qd, &log.qdd, &log.tau}) {
    for (Index d = 0; d < block->cols(); ++d) {
      const double x = (*block)(a, d);
      const double y = (*block)(b, d);
      if (x != y && !(std::isnan(x) && std::isnan(y))) return false;
    }
  }
  return true;
}

void drop_rows_twice(CheckRoom& room) {
  Log& log = room.log;
  std::vector<Index> rows;
  Tally twice;
  for (Index i = 0; i < log.samples(); ++i) {
    if (!std::isfinite(log.t_s(i))) {
      throw Error("the time stamp is missing or not finite", room.where(i, "t_s"),
                  "remove the row or correct the time");
    }
    if (!rows.empty() && log.t_s(i) == log.t_s(rows.back()) && same_row(room, i, rows.back())) {
      twice.add(i);
      continue;
    }
    rows.push_back(i);
  }
  if (twice.count == 0) return;
  const std::string sentence =
      twice.count == 1 ? std::string("the row is there twice, once was enough")
                       : fmt::format("the row is there twice, once was enough; the first of {} such rows", twice.count);
  room.tell(FindingLevel::mended, "rows_twice", twice.first, "", -1, static_cast<double>(twice.count), "rows",
            sentence);
  room.keep(rows);
}

/// Size of the change of all positions over the rows that `counts`, for one row.
template <class Counts>
double mean_change(const Log& log, Counts counts) {
  double sum = 0, rows = 0;
  for (Index i = 1; i < log.samples(); ++i) {
    if (!counts(i)) continue;
    const double change = (log.q.row(i) - log.q.row(i - 1)).cwiseAbs().sum();
    if (!std::isfinite(change)) continue;
    sum += change;
    rows += 1.0;
  }
  return rows > 0 ? sum / rows : 0.0;
}

/// Stamps that repeat because the clock, or the digits written, are coarser than the sampling: the rows are even, the
/// stamps are not.
/// \return false if the log is not of this kind
bool mend_coarse_clock(CheckRoom& room) {
  Log& log = room.log;
  const Index n = log.samples();
  Tally repeated;
  double coarse = 0;
  for (Index i = 1; i < n; ++i) {
    const double step = log.t_s(i) - log.t_s(i - 1);
    if (step < 0) return false;
    if (step == 0) repeated.add(i);
    coarse = std::max(coarse, step);
  }
  if (static_cast<double>(repeated.count) < kCoarseStampShare * static_cast<double>(n)) return false;
  const double step = (log.t_s(n - 1) - log.t_s(0)) / static_cast<double>(n - 1);
  // Rows of one stamp that differ by less than the motion between two samples were taken at one time, by two sources.
  const auto at_once = [&](Index i) { return log.t_s(i) == log.t_s(i - 1); };
  const double within = mean_change(log, at_once);
  const double between = mean_change(log, [&](Index i) { return !at_once(i); });
  if (within < 0.25 * between) {
    throw Error(
        fmt::format(
            "the time stamp {:.9g} s is repeated, with other values, and so are {} more: two rows of the same moment",
            log.t_s(repeated.first), repeated.count - 1),
        room.where(repeated.first, "t_s"), "write one row a sample, with all channels in it");
  }
  const Eigen::ArrayXd row = Eigen::ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1));
  Index worst = 0;
  const double off = (log.t_s.array() - log.t_s(0) - step * row).abs().maxCoeff(&worst);
  // Even rows stay within one tick of the clock; more means lost rows, whose place the stamps no longer tell.
  if (off > 1.5 * coarse + step) {
    throw Error(
        fmt::format(
            "the time stamps are too coarse: {} are repeated, with other values, and the rows are not even between",
            repeated.count),
        room.where(worst, "t_s"), "write the time with more digits");
  }
  log.t_s = Eigen::VectorXd::LinSpaced(n, log.t_s(0), log.t_s(n - 1));
  room.tell(FindingLevel::mended, "coarse_stamps", repeated.first, "t_s", -1, coarse, "s",
            fmt::format("the time stamps advance by {:.3g} s where the samples are {:.4g} s apart, so that {} stamps "
                        "repeat; taken as even",
                        coarse, step, repeated.count));
  return true;
}

/// A single stamp that does not lie between its neighbours, which are themselves two steps apart.
void mend_single_stamps(CheckRoom& room, double step) {
  Eigen::VectorXd& t = room.log.t_s;
  Tally wrong;
  const auto mend = [&](Index i) {
    if (i < 1 || i + 1 >= t.size() || std::abs(t(i + 1) - t(i - 1) - 2.0 * step) > 0.5 * step) return false;
    t(i) = 0.5 * (t(i - 1) + t(i + 1));
    wrong.add(i);
    return true;
  };
  for (Index i = 1; i < t.size(); ++i) {
    if (t(i) > t(i - 1)) continue;
    // Either this stamp is wrong or the one before.
    if (!mend(i)) mend(i - 1);
  }
  if (wrong.count == 0) return;
  room.tell(FindingLevel::mended, "wrong_stamps", wrong.first, "t_s", -1, static_cast<double>(wrong.count), "rows",
            wrong.count == 1
                ? std::string("this time stamp is wrong, as its neighbours are two steps apart; set between them")
                : fmt::format("this time stamp is wrong, as its neighbours are two steps apart; it and {} more are "
                              "set between their neighbours",
                              wrong.count - 1));
}

}  // namespace

void order_stamps(CheckRoom& room) {
  drop_rows_twice(room);
  if (mend_coarse_clock(room)) return;
  Log& log = room.log;
  const double step = lower_median(steps_of(log.t_s));
  mend_single_stamps(room, step);
  for (Index i = 1; i < log.samples(); ++i) {
    if (log.t_s(i) == log.t_s(i - 1)) {
      throw Error(fmt::format("the time stamp {:.9g} s is repeated, with other values", log.t_s(i)),
                  room.where(i, "t_s"), "write the time with more digits, or remove one of the rows");
    }
    if (log.t_s(i) < log.t_s(i - 1)) room.recordings.push_back(i);
  }
  if (room.recordings.empty()) return;
  const Index first = room.recordings.front();
  room.tell(FindingLevel::mended, "recordings", first, "t_s", -1, static_cast<double>(room.recordings.size() + 1), "",
            fmt::format("the time stamps decrease, from {:.9g} s to {:.9g} s: the file holds {} recordings, used as "
                        "parts of their own",
                        log.t_s(first - 1), log.t_s(first), room.recordings.size() + 1));
}

}  // namespace deltadyn::checks
