#pragma once

/// \file
/// One run-time face for all robot types, so that the tools dispatch once on the robot file.
/// The mathematics stays in the fixed-size templates below; this only forwards to them.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "deltadyn/core/status.hpp"
#include "deltadyn/runtime/dynamics_terms.hpp"
#include "deltadyn/runtime/link_poses.hpp"
#include "deltadyn/runtime/parameter_id.hpp"
#include "deltadyn/runtime/path_pose.hpp"
#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

/// Which columns the parameter vector has.
struct ParameterOptions {
  bool individual_limbs = false;   ///< each limb has its own upper_armK and strutK
  bool tool = true;                ///< the tool's ten parameters (delta4)
  std::vector<int> rotor_inertia;  ///< drives, from 1, that have a column driveK.rotor_inertia
  bool offset = false;             ///< driveK.offset
};

/// Motion in task coordinates, one entry a drive in each vector: position, rate, acceleration.
struct TaskState {
  Eigen::VectorXd z, zd, zdd;
};

/// A robot with its parameter layout. Immutable after construction; safe to use from several threads. What is asked row
/// by row of a log takes a `path`, see PathPose.
class Robot {
 public:
  using Vector = Eigen::VectorXd;
  using ConstRef = Eigen::Ref<const Eigen::VectorXd>;

  virtual ~Robot() = default;

  [[nodiscard]] virtual const RobotDescription& description() const = 0;
  [[nodiscard]] virtual const ParameterOptions& parameter_options() const = 0;
  [[nodiscard]] int drives() const { return description().drives(); }
  /// What each column of the regressor is, the bodies first; paper (4) order in each body.
  [[nodiscard]] virtual const std::vector<ParameterId>& parameter_ids() const = 0;
  /// Their names, e.g. "strut.Iyy", "drive1.viscous".
  [[nodiscard]] virtual const std::vector<std::string>& parameter_names() const = 0;
  /// Unit of each parameter, e.g. "kg*m^2".
  [[nodiscard]] virtual const std::vector<std::string>& parameter_units() const = 0;
  [[nodiscard]] int parameters() const { return static_cast<int>(parameter_names().size()); }

  /// q = f_IK(z) (paper III.A).
  [[nodiscard]] virtual Status inverse_kinematics(const ConstRef& z, Eigen::Ref<Vector> q) const = 0;
  /// z = f_FK(q).
  [[nodiscard]] virtual Status forward_kinematics(const ConstRef& q, Eigen::Ref<Vector> z,
                                                  PathPose* path = nullptr) const = 0;
  /// Drive motion of a task-space motion.
  [[nodiscard]] virtual Status to_drives(const TaskState& task, Eigen::Ref<Vector> q, Eigen::Ref<Vector> qd,
                                         Eigen::Ref<Vector> qdd) const = 0;
  /// Task-space motion of a drive motion.
  [[nodiscard]] virtual Status to_task(const ConstRef& q, const ConstRef& qd, const ConstRef& qdd,
                                       TaskState& task) const = 0;
  /// Jacobian dz/dq (drives x drives).
  [[nodiscard]] virtual Status jacobian(const ConstRef& q, Eigen::Ref<Eigen::MatrixXd> J_q_z) const = 0;

  /// Where every link is, to be drawn or to be exported.
  [[nodiscard]] virtual Status link_poses(const ConstRef& q, LinkPoses& out) const = 0;

  /// Y(q, qd, qdd), drives x parameters (paper (3)-(7)).
  [[nodiscard]] virtual Status regressor(const ConstRef& q, const ConstRef& qd, const ConstRef& qdd,
                                         Eigen::Ref<Eigen::MatrixXd> Y, PathPose* path = nullptr) const = 0;
  /// tau = Y p without forming Y [N m | N].
  [[nodiscard]] virtual Status inverse_dynamics(const ConstRef& q, const ConstRef& qd, const ConstRef& qdd,
                                                const ConstRef& p, Eigen::Ref<Vector> tau,
                                                PathPose* path = nullptr) const = 0;
  /// M(q) of (1), drives x drives, symmetric.
  [[nodiscard]] virtual Status mass_matrix(const ConstRef& q, const ConstRef& p, Eigen::Ref<Eigen::MatrixXd> M,
                                           PathPose* path = nullptr) const = 0;
  /// qdd of drive torques tau, (1) solved by Cholesky's factorisation of M [rad/s^2 | m/s^2]. At rest Coulomb friction
  /// gives no torque (sign(0) = 0). out_of_range if M is not positive definite, i.e. p is not physically consistent.
  [[nodiscard]] virtual Status forward_dynamics(const ConstRef& q, const ConstRef& qd, const ConstRef& tau,
                                                const ConstRef& p, Eigen::Ref<Vector> qdd) const = 0;
  /// The equations of motion (1) term by term.
  [[nodiscard]] virtual Status equations_of_motion(const ConstRef& q, const ConstRef& qd, const ConstRef& p,
                                                   Coordinates coordinates, EquationTerms& terms) const = 0;
  [[nodiscard]] virtual Status energies(const ConstRef& q, const ConstRef& qd, const ConstRef& p,
                                        Energies& energies) const = 0;
  /// Derivatives of the drive torques by q, qd and qdd, exact; Coulomb friction counts as constant.
  [[nodiscard]] virtual Status inverse_dynamics_derivatives(const ConstRef& q, const ConstRef& qd, const ConstRef& qdd,
                                                            const ConstRef& p, TorqueSlopes& slopes) const = 0;
  /// Forces and moments in all joints, by Newton and Euler (dynamics/joint_reactions.hpp says what carries what).
  [[nodiscard]] virtual Status joint_reactions(const ConstRef& q, const ConstRef& qd, const ConstRef& qdd,
                                               const ConstRef& p, std::vector<JointReaction>& reactions) const = 0;
  /// Rates of the joints with friction: drives, then the inner joint if there is one [rad/s | m/s].
  [[nodiscard]] virtual Status friction_joint_rates(const ConstRef& q, const ConstRef& qd, Eigen::Ref<Vector> rates,
                                                    PathPose* path = nullptr) const = 0;
  [[nodiscard]] int friction_joints() const { return drives() + (*description().inner_joint() != 0 ? 1 : 0); }
};

/// Columns of the Coulomb friction of each joint, in the order of friction_joint_rates().
[[nodiscard]] std::vector<Eigen::Index> coulomb_columns(const Robot& robot);

/// Throws deltadyn::Error if the description is not a robot we know, or a rotor inertia is asked for of a drive that it
/// has not.
[[nodiscard]] std::unique_ptr<Robot> make_robot(const RobotDescription& description,
                                                const ParameterOptions& options = {});

}  // namespace deltadyn
