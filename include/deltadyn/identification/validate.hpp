#pragma once

/// \file
/// Torque prediction on logs that took no part in a fit.

#include <string>
#include <vector>

#include "deltadyn/identification/prediction.hpp"

namespace deltadyn {

struct ValidatedLog {
  std::string file;
  Eigen::Index samples = 0;
  double rate_hz = 0;      ///< of the log
  double row_rate_hz = 0;  ///< of the rows
  Prediction prediction;
  Eigen::VectorXd torque_noise;  ///< white noise of each drive's recorded torque, rms in the rows [N m | N]
  std::vector<std::string> notes;
};

/// Figures of one drive over all logs, rows near velocity reversals left out.
struct ValidatedDrive {
  double rms_residual = 0;        ///< [N m | N]
  double rms_torque = 0;          ///< measured, over the same rows
  double relative_residual = 0;   ///< rms residual over rms torque
  double max_residual = 0;        ///< largest |residual|
  double rms_with_reversals = 0;  ///< rows near reversals included
  double torque_noise = 0;        ///< rms over the logs, weighted by their rows
  Eigen::Index rows = 0, reversal_rows = 0;
  /// The model holds how its friction builds up: rows near reversals count where they are predicted
  bool bristles = false;
};

struct Validation {
  std::vector<ValidatedLog> logs;
  std::vector<ValidatedDrive> drives;
  ProcessingOptions processing;  ///< as used
};

/// Figures of each drive over the given logs.
[[nodiscard]] std::vector<ValidatedDrive> drive_figures(const std::vector<ValidatedLog>& logs, std::size_t drives);

/// Predicts every log with parameters p. Rows near reversals count as others for drives with presliding if the model
/// predicts them as it does the others. Throws deltadyn::Error as prepare_log does.
[[nodiscard]] Validation validate(const Robot& robot, const std::vector<Log>& logs, const Eigen::VectorXd& p,
                                  const ProcessingOptions& processing, int threads = 0);

}  // namespace deltadyn
