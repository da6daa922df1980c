#pragma once

/// \file
/// Whether the plate may be at a place: in reach, inside the drives' limits, how near a singular pose.

#include <limits>

#include "deltadyn/runtime/workspace.hpp"

namespace deltadyn {

/// Of dz_r/dq, beyond which a pose counts as singular: it says little about the machine in use.
inline constexpr double kLargestCondition = 50.0;

/// Condition number of dr/dq where the pose is allowed, infinity elsewhere.
class PoseCheck {
 public:
  explicit PoseCheck(const Robot& robot)
      : robot_(robot), z_(robot.drives()), q_(robot.drives()), J_(robot.drives(), robot.drives()) {}

  double condition(const Eigen::Vector3d& r, double yaw = 0) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    z_.setZero();
    z_.head<3>() = r;
    if (robot_.description().plate) z_(3) = yaw;
    if (robot_.inverse_kinematics(z_, q_) != Status::ok) return kNever;
    const RobotDescription& description = robot_.description();
    for (std::size_t i = 0; i < description.limbs.size(); ++i) {
      const double q = q_(static_cast<Eigen::Index>(i));
      if (q < description.limits[i].lower || q > description.limits[i].upper) return kNever;
    }
    if (robot_.jacobian(q_, J_) != Status::ok) return kNever;
    return plate_condition(description, J_);
  }

 private:
  const Robot& robot_;
  Eigen::VectorXd z_, q_;
  Eigen::MatrixXd J_;
};

}  // namespace deltadyn
