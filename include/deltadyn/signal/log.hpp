#pragma once

/// \file
/// A recorded motion in memory, SI units.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace deltadyn {

struct Log {
  std::string file;         ///< where it came from, for messages
  Eigen::VectorXd t_s;      ///< N time stamps, strictly increasing, even to rounding
  Eigen::MatrixXd q;        ///< N x drives [rad | m]
  Eigen::MatrixXd qd;       ///< N x drives or empty [rad/s | m/s]
  Eigen::MatrixXd qdd;      ///< N x drives or empty [rad/s^2 | m/s^2]
  Eigen::MatrixXd tau;      ///< N x drives [N m | N]; empty if the file holds a motion only
  std::vector<std::string> notes;  ///< what the reader repaired or wants to say, with line numbers

  [[nodiscard]] Eigen::Index samples() const { return t_s.size(); }
  [[nodiscard]] Eigen::Index drives() const { return q.cols(); }
  [[nodiscard]] double sample_time_s() const {
    return samples() < 2 ? 0.0 : (t_s(samples() - 1) - t_s(0)) / static_cast<double>(samples() - 1);
  }
};

}  // namespace deltadyn
