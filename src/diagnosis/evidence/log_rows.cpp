#include "log_rows.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

std::vector<MatrixXd> base_rows(const Robot& robot, const BaseParameters& base, const PreparedLog& log) {
  const Index n = robot.drives();
  const auto b = static_cast<Index>(base.count());
  const Index N = log.t_s.size();
  MatrixXd raw(N, n * b);
  MatrixXd Y(n, robot.parameters());
  const std::vector<Index> coulomb = log.coulomb_share.size() > 0 ? coulomb_columns(robot) : std::vector<Index>{};
  PathPose path;
  for (Index k = 0; k < N; ++k) {
    const Status status =
        robot.regressor(log.q.row(k).transpose(), log.qd.row(k).transpose(), log.qdd.row(k).transpose(), Y, &path);
    if (status != Status::ok)
      throw Error(message(status), log.file, "check that the robot file belongs to this machine");
    for (std::size_t joint = 0; joint < coulomb.size(); ++joint)
      Y.col(coulomb[joint]) *= log.coulomb_share(k, static_cast<Index>(joint));
    for (Index j = 0; j < n; ++j) raw.row(k).segment(j * b, b) = Y.row(j)(base.independent);
  }
  const MatrixXd rows = low_passed_rows(log, raw);
  std::vector<MatrixXd> out;
  for (Index j = 0; j < n; ++j) out.push_back(rows.middleCols(j * b, b));
  return out;
}

LogRows make_log_rows(const Robot& robot, const BaseParameters& base, PreparedLog log, int number) {
  LogRows out;
  out.log = std::move(log);
  out.number = number;
  const PreparedLog& from = out.log;
  const Index n = robot.drives();
  out.Y = base_rows(robot, base, from);
  out.tau = low_passed_rows(from, from.tau);
  if (from.ripple.size() > 0) {
    out.ripple = low_passed_rows(from, from.ripple);
    out.tau -= out.ripple;
  }
  out.t_s.resize(from.rows);
  for (MatrixXd* m : {&out.q, &out.qd, &out.qdd}) m->resize(from.rows, n);
  out.usable.assign(static_cast<std::size_t>(n), RowMask::Constant(from.rows, true));
  out.present = out.usable;
  for (Index j = 0; j < n; ++j)
    out.unknown.push_back(unknown_torque(from, j, out.present[static_cast<std::size_t>(j)]));
  const Index reach = from.low_pass ? from.low_pass->half_width() : 0;
  for (Index row = 0; row < from.rows; ++row) {
    const Index centre = sample_of_row(from, row);
    out.t_s(row) = from.t_s(centre);
    out.q.row(row) = from.q.row(centre);
    out.qd.row(row) = from.qd.row(centre);
    out.qdd.row(row) = from.qdd.row(centre);
    const Index first = centre - reach, count = 2 * reach + 1;
    for (Index j = 0; j < n; ++j) {
      const bool filled = left_out(from, static_cast<int>(j), first, count);
      if (filled) out.present[static_cast<std::size_t>(j)](row) = false;
      if (filled || from.reversal.col(j).segment(first, count).any())
        out.usable[static_cast<std::size_t>(j)](row) = false;
    }
  }
  return out;
}

VectorXd without_model(const Eigen::Ref<const VectorXd>& torque, const MatrixXd& Y, const MatrixXd& effects,
                       const VectorXd& beta) {
  const Index b = Y.cols(), amplitudes = beta.size() - b;
  return torque - Y * beta.head(b) - effects.leftCols(amplitudes) * beta.tail(amplitudes);
}

VectorXd closest_parameters(const BaseParameters& base, const VectorXd& beta, const VectorXd& around) {
  const MatrixXd& B = base.B;
  return around + B.transpose() * dense::solve_symmetric(B * B.transpose(), VectorXd(beta - B * around));
}

VectorXd refit_parameters(const BaseParameters& base, const std::vector<LogRows>& logs, const VectorXd& around) {
  const auto b = static_cast<Index>(base.count());
  const std::size_t n = logs.front().usable.size();
  VectorXd weight = VectorXd::Ones(static_cast<Index>(n));
  VectorXd beta = VectorXd::Zero(b);
  for (int pass = 0; pass < 3; ++pass) {
    MatrixXd information = MatrixXd::Zero(b, b);
    VectorXd right = VectorXd::Zero(b);
    for (std::size_t j = 0; j < n; ++j) {
      const auto drive = static_cast<Index>(j);
      for (const LogRows& log : logs) {
        const VectorXd use = log.usable[j].cast<double>();
        const MatrixXd weighted = weight(drive) * weight(drive) * (use.asDiagonal() * log.Y[j].leftCols(b));
        information += weighted.transpose() * log.Y[j].leftCols(b);
        right += weighted.transpose() * log.tau.col(drive);
      }
    }
    const VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
    beta = scale.asDiagonal() * dense::least_norm(scaled, scale.asDiagonal() * right);
    for (std::size_t j = 0; j < n; ++j) {
      double square = 0, count = 0;
      for (const LogRows& log : logs) {
        const VectorXd e = log.tau.col(static_cast<Index>(j)) - log.Y[j].leftCols(b) * beta;
        square += log.usable[j].select(e.array(), 0.0).square().sum();
        count += static_cast<double>(log.usable[j].count());
      }
      weight(static_cast<Index>(j)) = 1.0 / std::max(std::sqrt(square / std::max(count, 1.0)), 1e-9);
    }
  }
  return closest_parameters(base, beta, around);
}

}  // namespace deltadyn
