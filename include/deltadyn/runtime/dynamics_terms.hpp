#pragma once

/// \file
/// What Robot gives beside torques and accelerations, as run-time sized data.

#include <Eigen/Core>
#include <string>

namespace deltadyn {

/// Coordinates of the equations of motion: of the drives, q; or of the task, z = (r, psi).
enum class Coordinates { drives, task };

/// The terms of M qdd + C qd + g + f = tau (paper (1)) at one state, see EquationsOfMotion.
struct EquationTerms {
  Eigen::MatrixXd M, C;  ///< C + C^T = Mdot, so Mdot - 2C is skew-symmetric
  Eigen::VectorXd g, f;  ///< gravity; friction and offsets
};

/// [J]; the potential is zero for a mass at the origin of the base frame.
struct Energies {
  double kinetic = 0, potential = 0;
};

/// Row: torque of a drive, column: coordinate of a drive.
struct TorqueSlopes {
  Eigen::MatrixXd by_q, by_qd, by_qdd;
};

/// What one body exerts on another in a joint; vectors in the base frame.
struct JointReaction {
  /// "drive1", "strut1a.elbow", "strut1a.plate", "telescope.base", "telescope.slide", "tool.bearing", ...
  std::string joint;
  std::string from, onto;  ///< names of the bodies, e.g. "upper_arm1" onto "strut1a"
  Eigen::Vector3d place;   ///< centre of the joint [m]
  Eigen::Vector3d force;   ///< [N]
  Eigen::Vector3d moment;  ///< about `place` [N m]
  double axial = 0;        ///< force along the strut, tension positive [N]; only of strutKs.plate
};

}  // namespace deltadyn
