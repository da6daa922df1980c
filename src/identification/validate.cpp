#include "deltadyn/identification/validate.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/motion_band.hpp"

namespace deltadyn {

using Eigen::Index;

namespace {

/// Noise of each recorded torque that passes the low pass of the rows, taken as white: as dense as beyond the pass
/// band, in the median band of a third of an octave. 0 where a log is too short to show it.
Eigen::VectorXd torque_noise(const PreparedLog& log) {
  constexpr Index kShortest = 60;
  constexpr double kBeyond = 0.01;  // gain of the low pass
  Eigen::VectorXd noise = Eigen::VectorXd::Zero(log.tau.cols());
  if (log.tau.rows() < kShortest || !log.low_pass) return noise;
  for (Index j = 0; j < noise.size(); ++j) {
    const MotionBand band = motion_band(log.tau.col(j), log.rate_hz);
    std::vector<double> beyond;
    for (Index k = 0; k < band.density.size(); ++k) {
      if (std::abs(log.low_pass->gain(band.frequency_hz(k))) < kBeyond) beyond.push_back(band.density(k));
    }
    if (beyond.empty()) continue;
    noise(j) = std::sqrt(upper_median(std::move(beyond)) * log.rate_hz / 2 * log.low_pass->taps().squaredNorm());
  }
  return noise;
}

// Residual near reversals over that elsewhere: from here on friction follows another law there
constexpr double kOtherLaw = 3.0;

bool has_bristles(const ProcessingOptions& processing, Index drive) {
  return processing.presliding.size() > drive && processing.presliding(drive) > 0;
}

/// With the drive's own reversals in the model, what is left out near reversals is those of the telescope, and the rows
/// after the start of a log. A model that predicts them, too, is judged by them, too.
void use_predicted_reversals(Index drive, const ValidatedDrive& figures, std::vector<ValidatedLog>& logs) {
  const auto rows = static_cast<double>(figures.rows), reversal_rows = static_cast<double>(figures.reversal_rows);
  if (rows == 0 || reversal_rows == 0) return;
  const double all = figures.rms_with_reversals * figures.rms_with_reversals * (rows + reversal_rows);
  const double regular = figures.rms_residual * figures.rms_residual;
  if (all - regular * rows > kOtherLaw * kOtherLaw * regular * reversal_rows) return;
  for (ValidatedLog& log : logs) {
    auto use = log.prediction.use.col(drive);
    for (Index k = 0; k < use.size(); ++k) {
      if (use(k) == RowUse::reversal) use(k) = RowUse::regular;
    }
  }
}

}  // namespace

std::vector<ValidatedDrive> drive_figures(const std::vector<ValidatedLog>& logs, std::size_t drives) {
  std::vector<ValidatedDrive> out(drives);
  const auto root_mean = [](double sum, Index count) { return root_mean_square(sum, static_cast<double>(count)); };
  for (std::size_t j = 0; j < drives; ++j) {
    const auto drive = static_cast<Index>(j);
    ValidatedDrive& figures = out[j];
    double square = 0, tau_square = 0, reversal_square = 0, noise_square = 0;
    for (const ValidatedLog& log : logs) {
      const Prediction& rows = log.prediction;
      const Index before = figures.rows;
      for (Index k = 0; k < rows.rows(); ++k) {
        const double e = rows.tau(k, drive) - rows.model(k, drive);
        if (rows.use(k, drive) == RowUse::regular) {
          square += e * e;
          tau_square += rows.tau(k, drive) * rows.tau(k, drive);
          figures.max_residual = std::max(figures.max_residual, std::abs(e));
          ++figures.rows;
        } else if (rows.use(k, drive) == RowUse::reversal) {
          reversal_square += e * e;
          ++figures.reversal_rows;
        }
      }
      const double noise = log.torque_noise.size() > 0 ? log.torque_noise(drive) : 0.0;
      noise_square += noise * noise * static_cast<double>(figures.rows - before);
    }
    figures.torque_noise = root_mean(noise_square, figures.rows);
    figures.rms_residual = root_mean(square, figures.rows);
    figures.rms_torque = root_mean(tau_square, figures.rows);
    figures.relative_residual = tau_square > 0 ? std::sqrt(square / tau_square) : 0.0;
    figures.rms_with_reversals = root_mean(square + reversal_square, figures.rows + figures.reversal_rows);
  }
  return out;
}

Validation validate(const Robot& robot, const std::vector<Log>& logs, const Eigen::VectorXd& p,
                    const ProcessingOptions& processing, int threads) {
  Validation out;
  out.processing = processing;
  for (const Log& log : logs) {
    PreparedLog prepared = prepare_log(robot, log, processing);
    ValidatedLog one;
    one.file = log.file;
    one.samples = log.samples();
    one.rate_hz = prepared.rate_hz;
    one.row_rate_hz = prepared.rate_hz / static_cast<double>(prepared.stride);
    one.notes = std::move(prepared.notes);
    one.torque_noise = torque_noise(prepared);
    one.prediction = predict(robot, prepared, p, threads);
    out.logs.push_back(std::move(one));
  }
  const auto drives = static_cast<std::size_t>(robot.drives());
  out.drives = drive_figures(out.logs, drives);
  for (std::size_t j = 0; j < drives; ++j) {
    const auto drive = static_cast<Index>(j);
    if (has_bristles(processing, drive)) use_predicted_reversals(drive, out.drives[j], out.logs);
  }
  out.drives = drive_figures(out.logs, drives);
  for (std::size_t j = 0; j < drives; ++j) out.drives[j].bristles = has_bristles(processing, static_cast<Index>(j));
  return out;
}

}  // namespace deltadyn
