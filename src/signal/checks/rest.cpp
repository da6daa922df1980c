/// \file
/// A drive at rest is held by static friction, which takes any value: its torque says nothing about the model.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "checks.hpp"

namespace deltadyn::checks {
namespace {

/// Shorter is a reversal: within two encoder steps a drive turns round in 2 sqrt(2 band / acceleration), which for 13
/// bits and 1 rad/s^2 is 0.11 s.
constexpr double kShortestRest_s = 0.3;
constexpr double kShareOfRange = 1e-5;  // a log without noise: less is no motion

/// How far the position wanders while the drive rests.
double band_of(const ChannelQuality& quality) {
  // A quantised position flickers between two counts, a controller may hunt by one more; white noise of some hundred
  // samples stays within seven standard deviations.
  const double scatter =
      quality.step > 0 && quality.noise < 0.6 * quality.step ? 2.05 * quality.step : 7.0 * quality.noise;
  return std::max(scatter, kShareOfRange * quality.travel);
}

/// Extends [begin, end) as long as the position stays within `band` altogether.
void extend(const Eigen::Ref<const Eigen::VectorXd>& q, double band, Index& begin, Index& end) {
  double low = q.segment(begin, end - begin).minCoeff();
  double high = q.segment(begin, end - begin).maxCoeff();
  const auto takes = [&](Index i) {
    const double l = std::min(low, q(i));
    const double h = std::max(high, q(i));
    if (h - l > band) return false;
    low = l;
    high = h;
    return true;
  };
  while (end < q.size() && takes(end)) ++end;
  while (begin > 0 && takes(begin - 1)) --begin;
}

void tell_moving(const CheckRoom& room, Index drive, double share) {
  room.tell(
      {.key = "moving",
       .drive = static_cast<int>(drive),
       .value = share,
       .text = fmt::format("{}: drive {} moves in {:.3g} % of the samples", room.log.file, drive + 1, 100.0 * share)});
}

}  // namespace

void leave_rest_out(CheckRoom& room) {
  const Log& log = room.log;
  if (log.tau.size() == 0) return;
  const Index n = log.samples();
  const auto shortest = static_cast<Index>(std::lround(kShortestRest_s / log.sample_time_s()));
  // A rest that is long enough holds a whole block of half its length.
  const Index block = std::max<Index>(4, shortest / 2);
  Eigen::Index all = 0;
  for (Index d = 0; d < log.drives(); ++d) {
    if (!room.moves(d)) {  // another finding says so
      tell_moving(room, d, 0);
      continue;
    }
    const auto q = log.q.col(d);
    const double band = band_of(measure_channel(q));
    Index resting = 0;
    Index done = 0;
    for (Index at = 0; at + block <= n; at += block) {
      if (at < done) continue;
      const auto part = q.segment(at, block);
      if (part.maxCoeff() - part.minCoeff() > band) continue;
      Index begin = at, end = at + block;
      extend(q, band, begin, end);
      begin = std::max(begin, done);
      done = end;
      if (end - begin < shortest) continue;
      room.log.leave_torque_out(d, begin, end);
      resting += end - begin;
    }
    all += resting;
    tell_moving(room, d, 1.0 - static_cast<double>(resting) / static_cast<double>(n));
  }
  const double share = static_cast<double>(all) / static_cast<double>(n * log.drives());
  room.tell({.key = "standstill",
             .value = share,
             .text = fmt::format(
                 "{}: the drives are at rest in {:.3g} % of the samples, which take no part in fits (static friction)",
                 log.file, 100.0 * share)});
}

}  // namespace deltadyn::checks
