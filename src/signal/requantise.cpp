#include "deltadyn/signal/requantise.hpp"

#include "deltadyn/runtime/random.hpp"

#include "checks/channel_quality.hpp"

namespace deltadyn {

using Eigen::Index;

Eigen::VectorXd position_steps(const Log& log) {
  Eigen::VectorXd step(log.drives());
  for (Index j = 0; j < log.drives(); ++j) step(j) = checks::measure_channel(log.q.col(j)).step;
  return step;
}

Log requantised(const Log& log, const Eigen::MatrixXd& smooth, const Eigen::VectorXd& step, std::mt19937_64& random) {
  Log out = log;
  for (Index j = 0; j < log.drives(); ++j) {
    const double phase = canonical(random);
    out.q.col(j) = smooth.col(j);
    if (step(j) > 0) out.q.col(j) = step(j) * ((smooth.col(j) / step(j)).array() + phase).round() - step(j) * phase;
  }
  return out;
}

}  // namespace deltadyn
