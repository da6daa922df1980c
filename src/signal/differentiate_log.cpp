#include "deltadyn/signal/differentiate_log.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/butterworth.hpp"
#include "deltadyn/signal/differentiate.hpp"

namespace deltadyn {

DriveMotion differentiate_log(const Log& log, double cutoff_hz, int order, double trim_s) {
  constexpr int kHalfWidth = 3;
  const double sample_time_s = log.sample_time_s();
  const double trim = trim_s >= 0 ? trim_s : 1.5 / cutoff_hz;
  const Eigen::Index n = log.samples();
  const auto trimmed =
      std::isfinite(trim) && sample_time_s > 0 ? static_cast<Eigen::Index>(std::ceil(trim / sample_time_s)) : n;
  DriveMotion motion;
  motion.first = std::max<Eigen::Index>(kHalfWidth, trimmed);
  motion.last = n - motion.first;
  if (motion.last <= motion.first) {
    throw Error(fmt::format("the log of {} samples is too short for a cut-off of {:.4g} Hz", n, cutoff_hz), log.file,
                fmt::format("record at least {:.3g} s more, or raise the cut-off", 2.0 * trim));
  }
  motion.q = zero_phase_filter(log.q, 1.0 / sample_time_s, cutoff_hz, order);
  motion.qd = differentiate(motion.q, sample_time_s, 1, kHalfWidth);
  motion.qdd = differentiate(motion.q, sample_time_s, 2, kHalfWidth);
  return motion;
}

}  // namespace deltadyn
