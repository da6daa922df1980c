#pragma once

/// \file
/// The rigid robot as a simulation sees it: M, bias and all joints that can stick, at one state of the drives. One
/// virtual call a state; the mathematics stays in the fixed-size templates of kinematics/ and dynamics/.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "deltadyn/core/status.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

inline constexpr int kMaxDrives = 4;
/// Drives, the inner joint, and the passive joints: three kinds a limb and two angles of a telescope.
inline constexpr int kMaxJoints = kMaxDrives + 1 + 3 * kMaxDrives + 2;

/// Vectors and matrices that live on the stack, because a simulation evaluates them some ten thousand times a second.
using DriveVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDrives, 1>;
using DriveMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxDrives, kMaxDrives>;
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints, 1>;
using JointRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJoints, kMaxDrives>;

/// Everything at one state (q, qd). tau = M qdd + bias + sum_j J_j^T F_j with the forces F_j that joint j resists with.
struct MechanismTerms {
  DriveMatrix M;     ///< mass matrix with rotor inertias
  DriveVector bias;  ///< C qd + g, without friction and offsets [N m | N]
  /// Of each joint [rad | m]; of passive joints 0: nothing depends on it
  JointVector position;
  JointVector rate;                                                ///< J qd [rad/s | m/s]
  JointVector bias_rate;                                           ///< joint acceleration at qdd = 0 [rad/s^2 | m/s^2]
  JointRows J;                                                     ///< joints x drives
  Eigen::Vector3d r = Eigen::Vector3d::Zero();                     ///< the tool's point in W [m]
  Eigen::Vector3d v = Eigen::Vector3d::Zero();                     ///< its velocity [m/s]
  Eigen::Vector3d a_bias = Eigen::Vector3d::Zero();                ///< its acceleration at qdd = 0 [m/s^2]
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxDrives> J_r;  ///< dr/dq
  Eigen::Vector3d bar = Eigen::Vector3d::UnitZ();                  ///< unit vector along the telescope
};

/// What makes the plant of a simulation differ from the robot file.
struct MechanismOptions {
  bool passive_joints = false;  ///< list the ball and universal joints, too
  DriveVector home_offset;      ///< true drive coordinate minus the one that the encoder knows [rad | m]; empty: none
};

/// Immutable; safe to use from several threads.
class Mechanism {
 public:
  virtual ~Mechanism() = default;
  /// q is what the encoders know; out of reach or singular poses are told by the status.
  [[nodiscard]] virtual Status evaluate(const DriveVector& q, const DriveVector& qd, MechanismTerms& terms) const = 0;
  /// Of the bodies under gravity [J], zero for a mass at the origin of the base frame.
  [[nodiscard]] virtual Status potential_energy(const DriveVector& q, double& joule) const = 0;
  [[nodiscard]] int drives() const { return drives_; }
  /// Drives, then the inner joint, then passive joints.
  [[nodiscard]] int joints() const { return static_cast<int>(multiplicity_.size()); }
  [[nodiscard]] int inner_joint() const { return inner_joint_; }  ///< -1 if there is none
  /// How many equal joints of the robot an entry stands for: 1 for drives and the inner joint, 4 for the strut's turn
  /// about its z.
  [[nodiscard]] double multiplicity(int joint) const { return multiplicity_[static_cast<std::size_t>(joint)]; }

 protected:
  int drives_ = 0, inner_joint_ = -1;
  std::vector<double> multiplicity_;
};

/// The columns that make_mechanism() wants: every limb on its own, tool, all rotor inertias and offsets.
[[nodiscard]] ParameterOptions mechanism_options(const RobotDescription& description);

/// \param p  as of a Robot with mechanism_options(); friction and offsets in it are ignored, they are the plant's
///           business
/// Throws deltadyn::Error if the description is not a robot we know.
[[nodiscard]] std::unique_ptr<Mechanism> make_mechanism(const RobotDescription& description, const Eigen::VectorXd& p,
                                                        const MechanismOptions& options = {});

}  // namespace deltadyn
