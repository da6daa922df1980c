#include "residual_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "deltadyn/identification/prediction.hpp"
#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/motion_band.hpp"

#include "least_squares.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;

/// Least DriveNoise::correlation in units of that of white noise. What a fine encoder adds to the accelerations
/// alternates, so that little of it is left in slow sums; the steps of a coarse one follow the motion about its turning
/// points.
double least_correlation(const Eigen::Ref<const Eigen::VectorXd>& q, double noise_std) {
  // Of the usual rate: quantisation is white above (Widrow, Kollar 2008, chapter 4)
  constexpr double kCountsPerSample = 3;
  constexpr double kFine = 0.05, kCoarse = 0.25;
  const double step = std::sqrt(12.0) * noise_std;
  const Eigen::VectorXd moved = q.tail(q.size() - 1) - q.head(q.size() - 1);
  const double usual = root_mean_square(moved);
  return usual > kCountsPerSample * step ? kFine : kCoarse;
}

}  // namespace

std::vector<double> correlations(const Robot& robot, const std::vector<Log>& recorded,
                                 const std::vector<PreparedLog>& logs, const Eigen::VectorXd& p,
                                 const std::vector<bool>& keep, int threads) {
  std::vector<double> sum(keep.size(), 0.0), rows(keep.size(), 0.0);
  for (std::size_t l = 0; l < logs.size(); ++l) {
    const PreparedLog& log = logs[l];
    const Eigen::VectorXd position_noise = position_noise_std(recorded[l]);
    const Prediction prediction = predict(robot, log, p, threads);
    const double white = log.low_pass ? log.low_pass->white_correlation() : 1.0;
    for (std::size_t j = 0; j < keep.size(); ++j) {
      const auto drive = static_cast<int>(j);
      const auto usable = prediction.usable(drive, keep[j]);
      const auto count = static_cast<double>(usable.count());
      const Eigen::VectorXd residual = prediction.tau.col(drive) - prediction.model.col(drive);
      const double least = white * least_correlation(recorded[l].q.col(drive), position_noise(drive));
      sum[j] += count * std::max(least, residual_memory(residual, usable, log.row_rate_hz(), white));
      rows[j] += count;
    }
  }
  for (std::size_t j = 0; j < sum.size(); ++j) sum[j] = rows[j] > 0 ? sum[j] / rows[j] : 1.0;
  return sum;
}

std::vector<double> robust_scales(const Robot& robot, const std::vector<PreparedLog>& logs, const Eigen::VectorXd& p,
                                  const std::vector<bool>& keep, int threads) {
  std::vector<std::vector<double>> sizes(keep.size());
  for (const PreparedLog& log : logs) {
    const Prediction prediction = predict(robot, log, p, threads);
    for (std::size_t j = 0; j < keep.size(); ++j) {
      const auto drive = static_cast<int>(j);
      const auto usable = prediction.usable(drive, keep[j]);
      for (Index k = 0; k < prediction.rows(); ++k) {
        if (usable(k)) sizes[j].push_back(std::abs(prediction.tau(k, drive) - prediction.model(k, drive)));
      }
    }
  }
  std::vector<double> scales;
  for (std::vector<double>& size : sizes)
    scales.push_back(std::max(kMedianToSigma * upper_median(std::move(size)), 1e-12));
  return scales;
}

/// White up to the positions' cut-off f, of density D, encoder noise has the power (2 pi)^4 D f^5 / 5 in the
/// acceleration.
double acceleration_noise_share(const std::vector<Log>& logs, const std::vector<PreparedLog>& prepared,
                                const ProcessingOptions& processing) {
  const double f = processing.motion_over_pass * processing.cutoff_hz;
  double share = 0;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    const Eigen::VectorXd std = position_noise_std(logs[l]);
    for (Index j = 0; j < logs[l].drives(); ++j) {
      const double density = 2 * std(j) * std(j) / prepared[l].rate_hz;
      const double noise = std::pow(2 * std::numbers::pi, 4) * density * std::pow(f, 5) / 5;
      const double power = prepared[l].qdd.col(j).squaredNorm() / static_cast<double>(prepared[l].qdd.rows());
      if (power > 0) share = std::max(share, noise / power);
    }
  }
  return share;
}

}  // namespace deltadyn
