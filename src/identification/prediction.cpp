#include "deltadyn/identification/prediction.hpp"

#include <algorithm>

#include "deltadyn/runtime/in_parallel.hpp"
#include "deltadyn/runtime/statistics.hpp"

namespace deltadyn {

double Prediction::rms_residual(int drive, bool with_reversals) const {
  return root_mean_square(tau.col(drive) - model.col(drive), usable(drive, with_reversals));
}

double Prediction::rms_torque(int drive, bool with_reversals) const {
  return root_mean_square(tau.col(drive), usable(drive, with_reversals));
}

Prediction predict(const Robot& robot, const PreparedLog& log, const Eigen::VectorXd& p, int threads) {
  constexpr Eigen::Index rows_per_block = 256;
  const int n = robot.drives();
  Prediction out;
  const auto samples = Eigen::seqN(log.first, log.rows, log.stride);
  out.t_s = log.t_s(samples);
  out.q = log.q(samples, Eigen::all);
  out.qd = log.qd(samples, Eigen::all);
  out.qdd = log.qdd(samples, Eigen::all);
  for (Eigen::MatrixXd* m : {&out.tau, &out.model}) m->resize(log.rows, n);
  out.use.resize(log.rows, n);
  const Eigen::Index blocks = (log.rows + rows_per_block - 1) / rows_per_block;
  const auto predict_block = [&](Eigen::Index k) {
    RowBlock block;
    const Eigen::Index first = k * rows_per_block;
    const Eigen::Index count = std::min(rows_per_block, log.rows - first);
    read_rows(robot, log, first, count, block);
    out.tau.middleRows(first, count) = block.tau;
    out.use.middleRows(first, count) = block.use;
    for (int j = 0; j < n; ++j) out.model.col(j).segment(first, count) = block.Y[static_cast<std::size_t>(j)] * p;
    if (block.ripple.size() > 0) {
      out.tau.middleRows(first, count) += block.ripple;
      out.model.middleRows(first, count) += block.ripple;
    }
  };
  in_parallel(blocks, predict_block, threads);
  return out;
}

}  // namespace deltadyn
