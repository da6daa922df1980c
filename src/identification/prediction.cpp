#include "deltadyn/identification/prediction.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/runtime/in_parallel.hpp"
#include "deltadyn/runtime/statistics.hpp"

namespace deltadyn {

Eigen::Array<bool, Eigen::Dynamic, 1> Prediction::usable(int drive, bool with_reversals) const {
  if (with_reversals) return use.col(drive) != RowUse::unusable;
  return use.col(drive) == RowUse::regular;
}

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
  out.t_s.resize(log.rows);
  for (Eigen::MatrixXd* m : {&out.tau, &out.model, &out.q, &out.qd, &out.qdd}) m->resize(log.rows, n);
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
    for (Eigen::Index row = first; row < first + count; ++row) {
      const Eigen::Index sample = sample_of_row(log, row);
      out.t_s(row) = log.t_s(sample);
      out.q.row(row) = log.q.row(sample);
      out.qd.row(row) = log.qd.row(sample);
      out.qdd.row(row) = log.qdd.row(sample);
    }
  };
  in_parallel(blocks, predict_block, threads);
  return out;
}

}  // namespace deltadyn
