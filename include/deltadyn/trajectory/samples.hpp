#pragma once

/// \file
/// A motion as samples: task space and drives at the same times, SI units.

#include <Eigen/Core>
#include <string>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// One row a sample, one column a drive (= task coordinate). For an axis the task coordinate is the drive's own.
struct TrajectorySamples {
  std::string file;         ///< where it came from, for messages; empty if computed
  Eigen::VectorXd t_s;      ///< N times, strictly increasing
  Eigen::MatrixXd z;        ///< N x drives [m; rad]
  Eigen::MatrixXd zd, zdd;  ///< N x drives [m/s; rad/s], [m/s^2; rad/s^2]
  Eigen::MatrixXd q;        ///< N x drives [rad | m]
  Eigen::MatrixXd qd, qdd;  ///< N x drives [rad/s | m/s], [rad/s^2 | m/s^2]

  [[nodiscard]] Eigen::Index samples() const { return t_s.size(); }
  [[nodiscard]] TaskState task(Eigen::Index sample) const {
    return {z.row(sample).transpose(), zd.row(sample).transpose(), zdd.row(sample).transpose()};
  }
};

/// Fills q, qd, qdd from t_s, z, zd, zdd. Throws Error(bad_input) that names the time of the first pose the robot
/// cannot take.
void complete_drives(const Robot& robot, TrajectorySamples& samples);

/// Fills z, zd, zdd from t_s, q, qd, qdd. Throws as complete_drives().
void complete_task(const Robot& robot, TrajectorySamples& samples);

}  // namespace deltadyn
