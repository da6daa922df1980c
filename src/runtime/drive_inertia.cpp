#include "deltadyn/runtime/drive_inertia.hpp"

#include <cmath>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

Eigen::VectorXd drive_inertia(const Robot& robot, const Eigen::VectorXd& p) {
  const RobotDescription& description = robot.description();
  const Eigen::Index n = robot.drives();
  Eigen::VectorXd q = Eigen::VectorXd::Zero(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const DriveLimits& limits = description.limits[static_cast<std::size_t>(j)];
    if (std::isfinite(limits.lower + limits.upper)) q(j) = 0.5 * (limits.lower + limits.upper);
  }
  Eigen::MatrixXd M(n, n);
  if (robot.mass_matrix(q, p, M) != Status::ok && robot.mass_matrix(Eigen::VectorXd::Zero(n), p, M) != Status::ok) {
    throw Error(
        "the inertia of the drives cannot be had: neither the middle of the limits nor 0 is a pose of this robot",
        description.name, "mend the limits of the drives in the robot file");
  }
  return M.diagonal();
}

}  // namespace deltadyn
