#include "deltadyn/identification/validate.hpp"

#include <algorithm>
#include <cmath>

namespace deltadyn {

Validation validate(const Robot& robot, const std::vector<Log>& logs, const Eigen::VectorXd& p,
                    const ProcessingOptions& processing, int threads) {
  Validation out;
  out.processing = processing;
  out.drives.resize(static_cast<std::size_t>(robot.drives()));
  std::vector<double> square(out.drives.size(), 0), tau_square(out.drives.size(), 0), reversal_square(out.drives.size(), 0);
  for (const Log& log : logs) {
    PreparedLog prepared = prepare_log(robot, log, processing);
    ValidatedLog one;
    one.file = log.file;
    one.samples = log.samples();
    one.rate_hz = prepared.rate_hz;
    one.row_rate_hz = prepared.rate_hz / static_cast<double>(prepared.stride);
    one.notes = std::move(prepared.notes);
    one.prediction = predict(robot, prepared, p, threads);
    const Eigen::MatrixXd residual = one.prediction.residual();
    for (std::size_t j = 0; j < out.drives.size(); ++j) {
      const auto drive = static_cast<Eigen::Index>(j);
      for (Eigen::Index k = 0; k < residual.rows(); ++k) {
        const double e = residual(k, drive);
        if (one.prediction.use(k, drive) == RowUse::regular) {
          square[j] += e * e;
          tau_square[j] += one.prediction.tau(k, drive) * one.prediction.tau(k, drive);
          out.drives[j].max_residual = std::max(out.drives[j].max_residual, std::abs(e));
          ++out.drives[j].rows;
        } else if (one.prediction.use(k, drive) == RowUse::reversal) {
          reversal_square[j] += e * e;
          ++out.drives[j].reversal_rows;
        }
      }
    }
    out.logs.push_back(std::move(one));
  }
  const auto root_mean = [](double sum, Eigen::Index count) {
    return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
  };
  for (std::size_t j = 0; j < out.drives.size(); ++j) {
    ValidatedDrive& drive = out.drives[j];
    drive.rms_residual = root_mean(square[j], drive.rows);
    drive.relative_residual = tau_square[j] > 0 ? std::sqrt(square[j] / tau_square[j]) : 0.0;
    drive.rms_with_reversals = root_mean(square[j] + reversal_square[j], drive.rows + drive.reversal_rows);
  }
  return out;
}

}  // namespace deltadyn
