#include "deltadyn/identification/validate.hpp"

#include <algorithm>
#include <cmath>

namespace deltadyn {

using Eigen::Index;

std::vector<ValidatedDrive> drive_figures(const std::vector<ValidatedLog>& logs, std::size_t drives) {
  std::vector<ValidatedDrive> out(drives);
  const auto root_mean = [](double sum, Index count) { return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0; };
  for (std::size_t j = 0; j < drives; ++j) {
    const auto drive = static_cast<Index>(j);
    ValidatedDrive& figures = out[j];
    double square = 0, tau_square = 0, reversal_square = 0;
    for (const ValidatedLog& log : logs) {
      const Prediction& rows = log.prediction;
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
    }
    figures.rms_residual = root_mean(square, figures.rows);
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
    one.prediction = predict(robot, prepared, p, threads);
    out.logs.push_back(std::move(one));
  }
  out.drives = drive_figures(out.logs, static_cast<std::size_t>(robot.drives()));
  return out;
}

}  // namespace deltadyn
