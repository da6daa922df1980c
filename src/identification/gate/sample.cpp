#include "sample.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "deltadyn/signal/differentiate_log.hpp"
#include "deltadyn/signal/log_part.hpp"
#include "deltadyn/signal/motion_band.hpp"
#include "deltadyn/signal/reversal_mask.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;

constexpr double kMargin = 1.8;     // periods of the band that either end of a stretch loses to the filters
constexpr double kSearch_s = 0.06;  // further margin: delays are looked for so far
constexpr double kPerPeriod = 13;   // grid points a period of the band
// The motion's own filter ends well above the Gaussian that torque and regressor share: what it takes off the regressor
// alone would look like a lag.
constexpr double kMotionRatio = 2.0;
constexpr Index kFewestSamples = 60;       // of a stretch
constexpr double kPointsOfSample = 16000;  // of all stretches together, about
// The band falls until the noise of the acceleration is below this share of its rms
constexpr double kAccelerationNoise = 0.003;

/// Smallest step of a recorded position: the encoder's, where it counts.
double resolution(const Eigen::Ref<const Eigen::VectorXd>& position) {
  const double rounding = 1e-12 * position.cwiseAbs().maxCoeff();
  double smallest = 0;
  for (Index k = 1; k < position.size(); ++k) {
    const double step = std::abs(position(k) - position(k - 1));
    if (step > rounding && (smallest == 0 || step < smallest)) smallest = step;
  }
  return smallest;
}

/// Every `factor`-th row of a Gaussian mean over about one step of the coarse grid.
Eigen::MatrixXd thin(const Eigen::MatrixXd& columns, Index factor) {
  if (factor == 1) return columns;
  const double sigma = 0.6 * static_cast<double>(factor);
  const auto reach = static_cast<Index>(std::ceil(4 * sigma));
  Eigen::VectorXd weight(2 * reach + 1);
  for (Index k = -reach; k <= reach; ++k)
    weight(k + reach) = std::exp(-0.5 * std::pow(static_cast<double>(k) / sigma, 2));
  weight /= weight.sum();
  Eigen::MatrixXd out((columns.rows() + factor - 1) / factor, columns.cols());
  for (Index row = 0; row < out.rows(); ++row) {
    out.row(row).setZero();
    for (Index k = -reach; k <= reach; ++k) {
      const Index at = std::clamp<Index>(row * factor + k, 0, columns.rows() - 1);
      out.row(row) += weight(k + reach) * columns.row(at);
    }
  }
  return out;
}

Stretch stretch_of(const Log& piece, int file, double band_hz) {
  const double rate_hz = 1.0 / piece.sample_time_s();
  const double cutoff_hz = std::min(kMotionRatio * band_hz, 0.4 * rate_hz);
  const DriveMotion motion = differentiate_log(piece, cutoff_hz, 4, kMargin / band_hz);
  const Index factor = std::max<Index>(1, static_cast<Index>(rate_hz / (kPerPeriod * band_hz)));
  Stretch out;
  out.file = file;
  out.step_s = static_cast<double>(factor) / rate_hz;
  out.tau = thin(piece.tau, factor);
  const auto grid = Eigen::seqN(0, out.tau.rows(), factor);
  out.q = motion.q(grid, Eigen::all);
  out.qd = motion.qd(grid, Eigen::all);
  out.qdd = motion.qdd(grid, Eigen::all);
  out.first = (motion.first + factor - 1) / factor;
  out.last = std::min<Index>(out.points(), motion.last / factor);
  out.spoilt.assign(static_cast<std::size_t>(out.points()), 0);
  out.torque_out.setConstant(out.points(), piece.drives(), false);
  for (Index k = 0; k < piece.samples(); ++k) {
    const Index at = std::min(k / factor, out.points() - 1);
    if (piece.is_left_out(k)) out.spoilt[static_cast<std::size_t>(at)] = 1;
    if (piece.torque_out.size() > 0) out.torque_out.row(at) = out.torque_out.row(at) || piece.torque_out.row(k);
  }
  return out;
}

}  // namespace

double noise_limited_band_hz(const std::vector<Log>& pieces, const SampleOptions& options, bool* coarse) {
  double rate_hz = 1e300;
  for (const Log& piece : pieces) rate_hz = std::min(rate_hz, 1.0 / piece.sample_time_s());
  const double highest = std::min(options.highest_band_hz, 0.15 * rate_hz);
  const double lowest = std::min(highest, options.lowest_band_hz);
  const Index drives = pieces.front().drives();
  // Strongest acceleration of each drive, seen through the lowest filter, and the noise beside it.
  Eigen::VectorXd acceleration = Eigen::VectorXd::Zero(drives), noise = acceleration;
  for (const Log& piece : pieces) {
    const DriveMotion motion = differentiate_log(piece, lowest, 4, 0.0);
    for (Index j = 0; j < drives; ++j) {
      const double square = motion.qdd.col(j).squaredNorm() / static_cast<double>(motion.qdd.rows());
      const double own = std::max(position_noise(piece.q.col(j)), resolution(piece.q.col(j)) / std::sqrt(12.0));
      const double unrest = derivative_noise(own, rate_hz, lowest, 4, 2);
      acceleration(j) = std::max(acceleration(j), std::sqrt(std::max(0.0, square - unrest * unrest)));
      noise(j) = std::max(noise(j), own);
    }
  }
  double cutoff = highest;
  const auto too_noisy = [&](double hz) {
    for (Index j = 0; j < drives; ++j) {
      if (derivative_noise(noise(j), rate_hz, hz, 4, 2) > kAccelerationNoise * acceleration(j)) return true;
    }
    return false;
  };
  while (cutoff > lowest && too_noisy(cutoff)) cutoff = std::max(lowest, cutoff / 1.26);
  if (coarse != nullptr) *coarse = too_noisy(cutoff);
  return cutoff;
}

std::vector<int> file_numbers(const std::vector<Log>& logs) {
  std::vector<std::string> names;
  std::vector<int> out;
  for (const Log& log : logs) {
    const auto found = std::find(names.begin(), names.end(), log.file);
    out.push_back(static_cast<int>(found - names.begin()));
    if (found == names.end()) names.push_back(log.file);
  }
  return out;
}

std::vector<Eigen::VectorXd> recorded_torque(const Sample& sample, Index drive) {
  std::vector<Eigen::VectorXd> out;
  for (const Stretch& stretch : sample.stretches) out.emplace_back(stretch.tau.col(drive));
  return out;
}

Sample take_sample(const std::vector<Log>& logs, const SampleOptions& options) {
  std::vector<Log> pieces;
  std::vector<int> owner;
  const std::vector<int> files = file_numbers(logs);
  const double margin_s = kMargin / options.highest_band_hz + kSearch_s;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    const Log& log = logs[l];
    if (log.samples() < kFewestSamples) continue;
    const double rate_hz = 1.0 / log.sample_time_s();
    const double grid_hz = std::min(rate_hz, kPerPeriod * options.highest_band_hz);
    const double share_s = kPointsOfSample / static_cast<double>(logs.size()) / grid_hz;
    const double length_s = static_cast<double>(log.samples()) / rate_hz;
    const int count = length_s <= 1.5 * share_s ? 1 : options.stretches;
    const auto samples = count == 1 ? log.samples() : static_cast<Index>((share_s / count + 2 * margin_s) * rate_hz);
    for (int k = 0; k < count; ++k) {
      const Index from = count == 1 ? 0 : k * (log.samples() - samples) / (count - 1);
      pieces.push_back(part_of(log, from, samples));
      owner.push_back(files[l]);
    }
  }
  Sample out;
  if (pieces.empty()) return out;
  out.band_hz = noise_limited_band_hz(pieces, options, &out.coarse);
  out.sigma_s = std::sqrt(2 * std::numbers::ln2) / (2 * std::numbers::pi * out.band_hz);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const double length_s = static_cast<double>(pieces[k].samples()) * pieces[k].sample_time_s();
    if (length_s < 2 * (kMargin / out.band_hz + kSearch_s) + 10 / out.band_hz) continue;
    out.stretches.push_back(stretch_of(pieces[k], owner[k], out.band_hz));
  }
  return out;
}

double relative_torque_noise(const std::vector<Log>& logs, const Sample& sample) {
  if (sample.stretches.empty() || !(sample.sigma_s > 0)) return 0;
  const Index drives = sample.stretches.front().tau.cols();
  // Noise band of a Gaussian: the integral of its squared gain.
  const double band_hz = 1 / (4 * sample.sigma_s * std::sqrt(std::numbers::pi));
  double sum = 0;
  for (Index j = 0; j < drives; ++j) {
    double density = 0, seconds = 0, square = 0, points = 0;
    for (const Log& log : logs) {
      if (log.samples() < kFewestSamples) continue;
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
  return std::sqrt(sum / static_cast<double>(std::max<Index>(1, drives)));
}

}  // namespace deltadyn::gate
