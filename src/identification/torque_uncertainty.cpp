#include "deltadyn/identification/torque_uncertainty.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/workspace.hpp"

namespace deltadyn {

using Eigen::Index;

double TorqueUncertainty::worst_relative() const {
  double worst = 0;
  for (Index j = 0; j < std.size(); ++j) worst = std::max(worst, std(j) / std::max(rms_torque(j), 1e-300));
  return worst;
}

TorqueUncertainty torque_uncertainty(const Robot& robot, const BaseParameters& base, const Eigen::MatrixXd& covariance,
                                     const Eigen::VectorXd& p, const Eigen::MatrixXd& q, const Eigen::MatrixXd& qd,
                                     const Eigen::MatrixXd& qdd) {
  const Index n = robot.drives(), count = base.count();
  const auto fits = [&](const Eigen::MatrixXd& m) { return m.rows() == q.rows() && m.cols() == n; };
  if (!fits(q) || !fits(qd) || !fits(qdd) || p.size() != robot.parameters() || covariance.rows() != count ||
      covariance.cols() != count) {
    throw Error("states, parameters or covariance do not have the sizes of the robot", "uncertainty of the torque",
                fmt::format("give {} drives, {} parameters, {} base parameters", n, robot.parameters(), count),
                ExitCode::usage);
  }
  TorqueUncertainty out;
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(n), square = Eigen::VectorXd::Zero(n);
  Eigen::MatrixXd Y(n, robot.parameters());
  for (Index k = 0; k < q.rows(); ++k) {
    if (robot.regressor(q.row(k).transpose(), qd.row(k).transpose(), qdd.row(k).transpose(), Y) != Status::ok) continue;
    const Eigen::MatrixXd Y_B = Y(Eigen::all, base.independent);
    variance += (Y_B * covariance).cwiseProduct(Y_B).rowwise().sum().cwiseMax(0.0);
    square += (Y * p).cwiseAbs2();
    ++out.states;
  }
  if (out.states == 0) {
    throw Error("no state with a regular pose", "uncertainty of the torque", "check the lengths in the robot file");
  }
  out.std = (variance / static_cast<double>(out.states)).cwiseSqrt();
  out.rms_torque = (square / static_cast<double>(out.states)).cwiseSqrt();
  return out;
}

TorqueUncertainty torque_uncertainty_on_logs(const Robot& robot, const BaseParameters& base,
                                             const Eigen::MatrixXd& covariance, const Eigen::VectorXd& p,
                                             const Validation& logs, int states) {
  Index rows = 0;
  for (const ValidatedLog& log : logs.logs) rows += log.prediction.rows();
  const Index count = std::min<Index>(rows, states);
  Eigen::MatrixXd q(count, robot.drives()), qd = q, qdd = q;
  Index passed = 0, taken = 0;
  for (const ValidatedLog& log : logs.logs) {
    for (Index k = 0; k < log.prediction.rows(); ++k, ++passed) {
      if (taken == count || passed * count < taken * rows) continue;
      q.row(taken) = log.prediction.q.row(k);
      qd.row(taken) = log.prediction.qd.row(k);
      qdd.row(taken) = log.prediction.qdd.row(k);
      ++taken;
    }
  }
  return torque_uncertainty(robot, base, covariance, p, q.topRows(taken), qd.topRows(taken), qdd.topRows(taken));
}

TorqueUncertainty torque_uncertainty_in_workspace(const Robot& robot, const BaseParameters& base,
                                                  const Eigen::MatrixXd& covariance, const Eigen::VectorXd& p,
                                                  int states, std::uint64_t seed) {
  WorkspaceSampler sampler(robot, seed);
  Eigen::MatrixXd Q(states, robot.drives()), Qd = Q, Qdd = Q;
  Eigen::VectorXd q, qd, qdd;
  for (Index k = 0; k < states; ++k) {
    sampler.next(q, qd, qdd);
    Q.row(k) = q;
    Qd.row(k) = qd;
    Qdd.row(k) = qdd;
  }
  return torque_uncertainty(robot, base, covariance, p, Q, Qd, Qdd);
}

Eigen::VectorXd parameter_effect(const Robot& robot, const Eigen::VectorXd& p, int states, std::uint64_t seed) {
  WorkspaceSampler sampler(robot, seed);
  Eigen::MatrixXd Y(robot.drives(), robot.parameters()),
      square = Eigen::MatrixXd::Zero(robot.drives(), robot.parameters());
  Eigen::VectorXd torque_square = Eigen::VectorXd::Zero(robot.drives()), q, qd, qdd;
  for (int k = 0; k < states; ++k) {
    sampler.next(q, qd, qdd);
    if (robot.regressor(q, qd, qdd, Y) != Status::ok) continue;
    square += Y.cwiseAbs2();
    torque_square += (Y * p).cwiseAbs2();
  }
  const Eigen::MatrixXd share = torque_square.cwiseMax(1e-300).cwiseInverse().asDiagonal() * square;
  return share.colwise().maxCoeff().transpose().cwiseSqrt().cwiseProduct(p.cwiseAbs());
}

}  // namespace deltadyn
