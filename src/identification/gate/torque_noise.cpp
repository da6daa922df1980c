#include "torque_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "deltadyn/signal/motion_band.hpp"

namespace deltadyn::gate {

double relative_torque_noise(const std::vector<Log>& logs, const Sample& sample) {
  if (sample.stretches.empty() || !(sample.sigma_s > 0)) return 0;
  const Eigen::Index drives = sample.stretches.front().tau.cols();
  // Noise band of a Gaussian: the integral of its squared gain.
  const double band_hz = 1 / (4 * sample.sigma_s * std::sqrt(std::numbers::pi));
  double sum = 0;
  for (Eigen::Index j = 0; j < drives; ++j) {
    double density = 0, seconds = 0, square = 0, points = 0;
    for (const Log& log : logs) {
      if (log.samples() < 60) continue;  // too short for a stretch, too
      const double step_s = log.sample_time_s(), length_s = step_s * static_cast<double>(log.samples());
      density += length_s * motion_band(log.tau.col(j), 1 / step_s).noise_density;
      seconds += length_s;
    }
    for (const Stretch& stretch : sample.stretches) {
      square += stretch.tau.col(j).squaredNorm();
      points += static_cast<double>(stretch.points());
    }
    if (square > 0 && seconds > 0) sum += density / seconds * band_hz * points / square;
  }
  return std::sqrt(sum / static_cast<double>(std::max<Eigen::Index>(1, drives)));
}

}  // namespace deltadyn::gate
