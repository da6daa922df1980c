#include "deltadyn/excitation/reversals.hpp"

#include <cmath>
#include <vector>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/fir_decimator.hpp"
#include "deltadyn/signal/reversal_mask.hpp"

namespace deltadyn {

using Eigen::Index;
using Eigen::VectorXd;

double reversal_reach_s(double low_pass_hz, double rate_hz) {
  return static_cast<double>(FirDecimator(rate_hz, low_pass_hz, 1).half_width()) / rate_hz;
}

VectorXd share_away_from_reversals(const Robot& robot, const TrajectorySamples& samples, double reach_s, double floor) {
  const Index count = samples.samples();
  const int n = robot.drives(), joints = robot.friction_joints();
  if (count < 2) throw Error("the motion has no length", "reversals", "give two samples or more", ExitCode::usage);
  Eigen::MatrixXd rates(count, joints);
  VectorXd v(joints);
  for (Index i = 0; i < count; ++i) {
    const Status status = robot.friction_joint_rates(samples.q.row(i).transpose(), samples.qd.row(i).transpose(), v);
    if (status != Status::ok)
      throw Error(message(status), "reversals", "keep the motion inside the reach of the robot");
    rates.row(i) = v.transpose();
  }
  const double step_s = (samples.t_s(count - 1) - samples.t_s(0)) / static_cast<double>(count - 1);
  const auto grow = static_cast<Index>(std::lround(reach_s / step_s));
  std::vector<std::vector<char>> near;
  for (int j = 0; j < joints; ++j)
    near.push_back(reversal_mask(rates.col(j), floor * rates.col(j).cwiseAbs().maxCoeff(), grow));
  VectorXd share(n);
  for (int j = 0; j < n; ++j) {
    const bool with_inner = robot.description().feels_inner_joint(j);
    Index away = 0;
    for (Index i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      away += near[static_cast<std::size_t>(j)][at] == 0 && !(with_inner && near.back()[at] != 0) ? 1 : 0;
    }
    share(j) = static_cast<double>(away) / static_cast<double>(count);
  }
  return share;
}

SmoothDistance distance_from_reversal(double rate, double acceleration, double reach_s, double least_rate) {
  // v^4 / (v^4 + (reach a)^4 + floor): steep enough to count instants, smooth enough to be differentiated.
  const double lost = reach_s * acceleration;
  const double v4 = std::pow(rate, 4), other = std::pow(lost, 4) + std::pow(least_rate, 4), sum = v4 + other;
  SmoothDistance distance;
  if (!(sum > 0)) return {0, 0, 0};
  distance.value = v4 / sum;
  distance.by_rate = 4 * std::pow(rate, 3) * other / (sum * sum);
  distance.by_acceleration = -v4 * 4 * std::pow(lost, 3) * reach_s / (sum * sum);
  return distance;
}

}  // namespace deltadyn
