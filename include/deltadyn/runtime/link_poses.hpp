#pragma once

/// \file
/// Where the links of a robot are at one pose.

#include <Eigen/Core>
#include <vector>

namespace deltadyn {

/// In W, lengths in m, angles in rad.
struct LinkPoses {
  struct Limb {
    Eigen::Matrix3d R_WL = Eigen::Matrix3d::Identity();  ///< of the limb frame; a drive turns about its y
    Eigen::Vector3d elbow = Eigen::Vector3d::Zero();     ///< middle of the struts' upper joints
    Eigen::Vector3d plate = Eigen::Vector3d::Zero();     ///< middle of their lower joints
    Eigen::Vector3d strut = Eigen::Vector3d::Zero();     ///< unit vector from elbow to plate
    double beta = 0, gamma = 0;                          ///< strut angles: R_LS = Ry(beta) Rz(gamma)
  };
  struct PlatePart {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< of its origin
    double angle = 0;                                 ///< about z
  };
  struct Telescope {
    double a = 0, b = 0;  ///< of its upper universal joint: R_WT = Rz(psi) Rx(a) Ry(b)
    double length = 0;    ///< from joint to joint
  };

  std::vector<Limb> limbs;
  Eigen::Vector3d plate = Eigen::Vector3d::Zero();  ///< the plate's centre r
  std::vector<PlatePart> parts;                     ///< of an articulated plate
  Telescope telescope;                              ///< of robots that have one
};

}  // namespace deltadyn
