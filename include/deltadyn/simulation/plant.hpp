#pragma once

/// \file
/// The virtual robot: equations of motion (1) with dry friction that really sticks, integrated with error control.
///
/// Every joint with dry friction is at any time sliding up, sliding down, or stuck. In between the motion is smooth and
/// goes through an embedded Runge-Kutta pair (Dormand, Prince 1980); where a rate passes zero or a force breaks a joint
/// loose, the instant is located and all joints at rest are decided on together (stick_slip.hpp). A stuck joint is a
/// constraint, so it stays exactly where it is.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "deltadyn/runtime/effect_catalogue.hpp"
#include "deltadyn/runtime/robot_description.hpp"
#include "deltadyn/simulation/friction_law.hpp"
#include "deltadyn/simulation/mechanism.hpp"

namespace deltadyn {

struct PlantOptions {
  /// Of one step, relative to 1 rad, 1 m, 1 rad/s, 1 m/s or the value itself if that is larger
  double tolerance = 1e-9;
  double current_lag_s = 0;  ///< time constant with which a drive's torque follows its command [s]
};

/// What the plant has done so far.
struct PlantCounts {
  long steps = 0;
  long reversals = 0;   ///< joints that came to rest, and went on or stuck
  long breakaways = 0;  ///< joints that broke loose
  double stuck_s = 0;   ///< time with at least one joint stuck [s]
};

class Plant {
 public:
  /// \param names, p   parameters as in a parameter file, e.g. Robot::parameter_names() and their values; shared limbs
  ///               allowed
  /// \param effects    of the catalogue; those that concern only the log are left to the sensors (sensors.hpp)
  /// Throws deltadyn::Error for options out of range and effects that the plant cannot have.
  Plant(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p,
        const std::vector<Effect>& effects = {}, const PlantOptions& options = {});
  ~Plant();
  Plant(Plant&&) noexcept;

  /// Puts the robot at rest or in motion at time 0. Throws deltadyn::Error if the pose is out of reach or singular, or
  /// the parameters leave no mass matrix that is positive definite there.
  void start(const DriveVector& q, const DriveVector& qd);
  /// Torque that the drives are told to give from now on, held until the next call [N m | N].
  void command(const DriveVector& tau);
  /// Moves on. Throws Error(no_convergence) if the robot leaves its reach or meets a singular pose.
  void advance(double seconds);

  [[nodiscard]] double time() const;
  /// What the encoders would read without quantisation; with an elastic drive that is the side the encoder sits on.
  [[nodiscard]] DriveVector q() const;
  [[nodiscard]] DriveVector qd() const;
  /// Just after the present instant, with the torque that holds from now on.
  [[nodiscard]] DriveVector qdd() const;
  /// Torque of the drives at the present instant [N m | N].
  [[nodiscard]] DriveVector torque() const;
  /// Direction of each joint: +1, -1, 0 stuck. Drives, inner joint, passive joints.
  [[nodiscard]] std::vector<int> directions() const;
  [[nodiscard]] const PlantCounts& counts() const;
  /// Work of the drives and losses in friction, springs' dampers, drag and hoses since start() [J].
  [[nodiscard]] double work() const;
  [[nodiscard]] double losses() const;
  /// Kinetic and potential energy, and that of springs in elastic drives [J].
  [[nodiscard]] double energy() const;

  /// Torque of the drives that a given motion takes, effects included, without integrating anything; for studies free
  /// of control. Effects with memory go on from the sample before. A joint at exactly rate 0 has no Coulomb friction,
  /// as in the regressor. Throws Error(usage) for elastic drives and drives with play, and Error(bad_input) for poses
  /// out of reach.
  [[nodiscard]] DriveVector inverse(double time, const DriveVector& q, const DriveVector& qd, const DriveVector& qdd);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace deltadyn
