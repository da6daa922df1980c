#pragma once

/// \file
/// What a plant is made of: the robot file and the parameters with the effects built in.

#include <memory>
#include <string>
#include <vector>

#include "deltadyn/simulation/friction_law.hpp"
#include "deltadyn/simulation/mechanism.hpp"

namespace deltadyn::detail {

/// A drive whose motor hangs on the arm by a spring, with play if there is a gap.
struct SoftDrive {
  int drive = 0;
  double motor_inertia = 0;  ///< taken off the arm's side [kg m^2 | kg]
  double stiffness = 0;      ///< [N m/rad | N/m]
  double damping = 0;        ///< [N m s/rad | N s/m]
  double gap = 0;            ///< [rad | m]
  bool encoder_on_motor = true;

  /// Torque that the motor passes on for its lead over the arm.
  [[nodiscard]] double torque(double lead, double lead_rate) const;
  [[nodiscard]] double energy(double lead) const;
};

struct PlantParts {
  std::unique_ptr<Mechanism> mechanism;
  std::vector<FrictionLaw> laws;  ///< one a joint of the mechanism
  std::vector<SoftDrive> soft;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
  std::vector<Effect> plate_forces;  ///< effects that are forces on the plate, by their law
};

/// Throws deltadyn::Error for effects that the plant cannot have.
[[nodiscard]] PlantParts build_plant(const RobotDescription& description, const std::vector<std::string>& names,
                                     const Eigen::VectorXd& p, const std::vector<Effect>& effects);

}  // namespace deltadyn::detail
