#pragma once

/// \file
/// Nominal parameters from simple shapes and materials (paper VIII.A): the regularisation values p_reg of (15).

#include <Eigen/Core>

#include "deltadyn/model/inertial_parameters.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// What the moving parts look like. Lengths that the robot file holds (arm, strut) are not repeated here.
struct PartShapes {
  // Upper arm: a tube from the drive axis to the elbow, and a hub, a solid cylinder about the drive axis.
  double upper_arm_outer_diameter, upper_arm_wall;     ///< [m]
  double upper_arm_density;                            ///< [kg/m^3]
  double upper_arm_hub_mass;                           ///< [kg]
  double upper_arm_hub_diameter, upper_arm_hub_width;  ///< [m]
  // Carriage of a prismatic drive: a solid cylinder along the rail, in place of the upper arm.
  double carriage_mass, carriage_diameter, carriage_length;  ///< [kg], [m]
  // Strut: a tube from ball to ball, and a socket, a thicker tube, at each end.
  double strut_outer_diameter, strut_wall;            ///< [m]
  double strut_density;                               ///< [kg/m^3]
  double strut_sockets_mass;                          ///< both sockets of one strut [kg]
  double strut_socket_diameter, strut_socket_length;  ///< [m]
  // Plate and tool: solid cylinders; the tool hangs below the plate's centre.
  double platform_mass, platform_diameter, platform_thickness;
  double tool_mass, tool_diameter, tool_length;
  // Articulated plate: each half and each crossbar a solid round bar, the half from one attachment to the other.
  double half_plate_mass, half_plate_diameter, crossbar_mass, crossbar_diameter;
  // Telescope bar: a solid rod hanging from the base joint, a tube standing on the platform joint.
  double telescope_mass;         ///< both parts [kg]
  double telescope_upper_share;  ///< of that mass
  double telescope_upper_length, telescope_upper_diameter;
  double telescope_lower_length, telescope_lower_outer_diameter, telescope_lower_inner_diameter;
  // Friction: of a limb's drive [N m s/rad, N m | N s/m, N], the telescope's drive, the sliding of the bar [N s/m, N],
  // and all joints of an articulated plate together, by its turn theta [N m s/rad, N m].
  double drive_viscous, drive_coulomb;
  double telescope_drive_viscous, telescope_drive_coulomb;
  double telescope_viscous, telescope_coulomb;
  double plate_viscous, plate_coulomb;
  // Assumed standard deviation as a share of the value.
  double body_std = 0.5, friction_std = 1.0;

  /// The parts of the paper's robot, each scaled to the lengths of this one. What the paper leaves open is assumed so
  /// that the values of its Table I come out.
  explicit PartShapes(const RobotDescription& robot);
};

/// One value for each name of Robot::parameter_names(). A value of zero has a standard deviation, too: the second
/// moments bound every product (Cauchy-Schwarz), so their geometric mean sets its scale.
struct NominalParameters {
  Eigen::VectorXd value, std;
};

/// Every body is physically consistent. Throws deltadyn::Error(usage) if a shape is not possible (wall thicker than the
/// tube, mass not positive) and names it.
[[nodiscard]] NominalParameters nominal_parameters(const Robot& robot, const PartShapes& shapes);

/// Standard deviations of a body's ten parameters for the same relative error `share` of every moment of its mass
/// distribution.
[[nodiscard]] InertialVector<double> inertial_std(const InertialVector<double>& p, double share);

}  // namespace deltadyn
