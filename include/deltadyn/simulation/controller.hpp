#pragma once

/// \file
/// Controllers of the virtual robot, as a drive runs them: sampled, on encoder readings, with a model for the
/// feed-forward.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/simulation/reference_motion.hpp"

namespace deltadyn {

enum class ControlLaw {
  pd_feedforward,   ///< tau = tau_ff(q_r, qd_r, qdd_r) + Kp e + Kd ed, every drive on its own
  computed_torque,  ///< tau = M(q)(qdd_r + kp e + kd ed) + C(q, qd) qd + g(q) + f(qd_r) (Khalil; paper ref. 1)
  /// tau = M(q) qdd_r + C(q, qd) qd_r + g(q) + f(qd_r) + Kp e + Kd ed (Kelly, Carelli 1993; paper ref. 3)
  augmented_pd
};

struct ControllerOptions {
  ControlLaw law = ControlLaw::pd_feedforward;
  /// Of the closed loop: kp = (2 pi b)^2, kd = 2 z 2 pi b, times the drive's inertia in Kp and Kd, or less of it where
  /// coupled drives have far less in some direction
  double bandwidth_hz = 12;
  double damping_ratio = 0.9;  ///< z
  /// One a drive [N m/rad | N/m], [N m s/rad | N s/m]; computed torque [1/s^2], [1/s]; empty: above
  std::vector<double> kp, kd;
  double rate_filter_hz = 60;  ///< first-order low pass of the differenced position error
  bool feed_forward = true;    ///< false: Kp e + Kd ed alone (pd-feedforward only)

  /// Throws deltadyn::Error(usage) naming the field.
  void validate(int drives) const;
};

/// One controller with its memory.
class Controller {
 public:
  /// \param robot, p   the model that the controller knows, and its parameters
  /// \param home       pose whose mass matrix sets the gains
  /// Throws deltadyn::Error if that pose is out of reach, or an option is out of range.
  Controller(const Robot& robot, const Eigen::VectorXd& p, const ControllerOptions& options, double period_s,
             const Eigen::VectorXd& home);

  /// Torque for the next period [N m | N].
  /// \param measured  encoder readings now
  [[nodiscard]] Eigen::VectorXd torque(const ReferenceMotion::State& reference, const Eigen::VectorXd& measured);

  [[nodiscard]] const Eigen::VectorXd& kp() const { return kp_; }
  [[nodiscard]] const Eigen::VectorXd& kd() const { return kd_; }

 private:
  [[nodiscard]] Eigen::VectorXd inverse(const Eigen::VectorXd& q, const Eigen::VectorXd& qd, const Eigen::VectorXd& qdd,
                                        const Eigen::VectorXd& p) const;

  const Robot& robot_;
  Eigen::VectorXd p_, rigid_;  ///< with and without friction
  ControllerOptions options_;
  double period_, filter_;
  Eigen::VectorXd kp_, kd_, error_, error_rate_;
  bool begun_ = false;
};

}  // namespace deltadyn
