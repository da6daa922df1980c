#include "encoder_uncertainty.hpp"

#include <algorithm>
#include <random>

#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/differentiate_log.hpp"
#include "deltadyn/signal/log_part.hpp"
#include "deltadyn/signal/requantise.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kPhases = 8;          // tell a standard deviation to a quarter
constexpr Index kSamples = 20'000;  // of each log: longer ones average no less
// Passed in a usual sample: their error is white (Widrow, Kollar 2008, chapter 4); with fewer it may follow the motion
constexpr double kFineSteps = 20;
constexpr std::uint64_t kSeed = 1;

constexpr double kFewSteps = 3;  // the same: their error lies about the turning points of the motion

/// Does a drive pass fewer steps in a sample, rms over its log?
bool coarse(const Log& log, const VectorXd& step, double steps) {
  for (Index j = 0; j < log.drives(); ++j) {
    const VectorXd moved = log.q.col(j).tail(log.samples() - 1) - log.q.col(j).head(log.samples() - 1);
    const double usual = root_mean_square(moved);
    if (step(j) > 0 && usual > 0 && usual < steps * step(j)) return true;
  }
  return false;
}

}  // namespace

bool has_coarse_encoders(const std::vector<Log>& logs) {
  return std::any_of(logs.begin(), logs.end(), [](const Log& log) {
    const Log middle = middle_of(log, kSamples);
    return coarse(middle, position_steps(middle), kFewSteps);
  });
}

Eigen::MatrixXd encoder_covariance(const std::vector<Log>& logs, double motion_hz,
                                   const std::function<VectorXd(const std::vector<Log>&)>& estimate) {
  std::vector<Log> middles;
  std::vector<VectorXd> steps;
  bool any = false;
  for (const Log& log : logs) {
    middles.push_back(middle_of(log, kSamples));
    steps.push_back(position_steps(middles.back()));
    any = any || coarse(middles.back(), steps.back(), kFineSteps);
  }
  if (!any) return {};
  std::vector<Eigen::MatrixXd> smooth;
  for (const Log& log : middles) smooth.push_back(differentiate_log(log, motion_hz).q);
  std::mt19937_64 random(kSeed);
  std::vector<VectorXd> found;
  VectorXd mean;
  for (int k = 0; k < kPhases; ++k) {
    std::vector<Log> again;
    for (std::size_t l = 0; l < middles.size(); ++l)
      again.push_back(requantised(middles[l], smooth[l], steps[l], random));
    found.push_back(estimate(again));
    mean = k == 0 ? found.back() : VectorXd(mean + found.back());
  }
  mean /= kPhases;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(mean.size(), mean.size());
  for (const VectorXd& one : found) covariance += (one - mean) * (one - mean).transpose();
  return covariance / (kPhases - 1);
}

}  // namespace deltadyn
