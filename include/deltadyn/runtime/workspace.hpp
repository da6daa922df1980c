#pragma once

/// \file
/// Random states of a robot in its task space (paper IV.A): what base parameters and statements over the workspace are
/// computed on.

#include <Eigen/Core>
#include <cstdint>
#include <random>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// A ball in task space around the home pose that is inside the reach with room to spare.
struct WorkspaceBall {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the plate, in W [m]
  double radius = 0.0;                               ///< [m]
};

/// Condition number of the plate's velocity by the drives', from dz/dq: how near a pose is to a singular one of limbs
/// or plate. The turn of an articulated plate counts by the path of its halves, in metres as the rest.
[[nodiscard]] double plate_condition(const RobotDescription& robot, const Eigen::MatrixXd& J);

/// Draws drive states (q, qd, qdd) whose task-space state is uniform in a ball, with poses that are near-singular left
/// out. Same seed, same states. For an axis the drive coordinate itself is drawn.
class WorkspaceSampler {
 public:
  /// Throws deltadyn::Error if no regular pose can be found: then the geometry is wrong.
  explicit WorkspaceSampler(const Robot& robot, std::uint64_t seed = 1);

  [[nodiscard]] const WorkspaceBall& ball() const { return ball_; }
  /// Next state; velocities and accelerations are of the size that a fast motion of this robot has.
  void next(Eigen::VectorXd& q, Eigen::VectorXd& qd, Eigen::VectorXd& qdd);
  /// Next pose only.
  void next(Eigen::VectorXd& q);

 private:
  double uniform(double lower, double upper);
  void draw_task(TaskState& task);
  [[nodiscard]] bool regular(const Eigen::VectorXd& q) const;

  const Robot& robot_;
  std::mt19937_64 random_;
  WorkspaceBall ball_;
};

}  // namespace deltadyn
