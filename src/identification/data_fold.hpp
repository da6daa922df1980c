#pragma once

/// \file
/// A log of any length folded into one small triangular factor a drive: the data term of (15) is linear in p, so
/// sum (tau - Y p)^2 = ||R p - d||^2 + remainder holds exactly for every p. One pass, constant memory.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "deltadyn/identification/log_processing.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// The folded rows of one drive.
struct DriveFold {
  Eigen::MatrixXd R;      ///< parameters x parameters, upper triangular
  Eigen::VectorXd d;      ///< parameters
  double remainder = 0;   ///< what no p can explain, [torque^2]
  double tau_square = 0;  ///< sum of tau^2
  double tau_max = 0;     ///< largest |tau|
  Eigen::Index rows = 0;

  explicit DriveFold(Eigen::Index parameters = 0);
  /// Adds rows: k x parameters and k torques.
  void add(const Eigen::Ref<const Eigen::MatrixXd>& Y, const Eigen::Ref<const Eigen::VectorXd>& tau);
  void add(const DriveFold& other);
  /// sum (tau - Y p)^2
  [[nodiscard]] double square_error(const Eigen::Ref<const Eigen::VectorXd>& p) const;
  /// Root mean square of tau - Y p; 0 without rows.
  [[nodiscard]] double rms(const Eigen::Ref<const Eigen::VectorXd>& p) const;
};

/// All drives, with the rows near reversals kept apart until it is known whether they do harm.
struct DataFold {
  std::vector<DriveFold> regular;   ///< one a drive
  std::vector<DriveFold> reversal;  ///< one a drive
  Eigen::Index samples = 0;         ///< of the logs

  void add(const DataFold& other);
  /// Folds of the drives, with the rows near reversals of those that keep them.
  [[nodiscard]] std::vector<DriveFold> with_reversals(const std::vector<bool>& keep) const;
  /// Folds to begin with, before it is known whether reversals do harm: regular rows that are fewer than those near
  /// reversals show little of the motion, and are taken together with them.
  [[nodiscard]] std::vector<DriveFold> to_begin_with() const;
};

/// Weight of one row in a fold, at least 0 (for robust fits). Arguments: drive, torque residual [N m | N].
using RowWeight = std::function<double(int, double)>;

/// Folds a prepared log with `threads` threads (0: all). The result does not depend on the number of threads.
/// \param p, weight  if given, each row is scaled by sqrt(weight(drive, tau - Y p))
[[nodiscard]] DataFold fold_log(const Robot& robot, const PreparedLog& log, int threads = 0,
                                const Eigen::VectorXd* p = nullptr, const RowWeight& weight = {});
/// The same for several logs together.
[[nodiscard]] DataFold fold_logs(const Robot& robot, const std::vector<PreparedLog>& logs, int threads = 0,
                                 const Eigen::VectorXd* p = nullptr, const RowWeight& weight = {});

}  // namespace deltadyn
