#pragma once

/// \file
/// Which parameter stands in which column of the regressor, at compile time.
///
/// Order: the bodies (ten columns each, paper (4)), then for each joint with friction its viscous and Coulomb column
/// (drives first, then the telescope's prismatic joint), then rotor inertias, then torque offsets.

#include "deltadyn/model/body.hpp"
#include "deltadyn/model/topology.hpp"

namespace deltadyn {

enum class Limbs { shared, individual };

/// Columns of a robot whose limbs are all alike (shared) or each on its own (individual).
template <class Robot, Limbs kSharing>
struct ParameterLayout {
  static constexpr int kLimbSets = kSharing == Limbs::shared ? 1 : Robot::kLimbs;
  static constexpr int kStruts = kHasPlate<Robot> ? kLimbSets : 0;
  static constexpr int kTelescopeBodies = Robot::kTelescope ? 3 : 0;  ///< tool and the two parts of the bar
  static constexpr int kBodies = kLimbSets + kStruts + Robot::kPlateParts + kTelescopeBodies;
  static constexpr int kFrictionJoints = Robot::kDrives + (Robot::kTelescope ? 1 : 0);

  static constexpr int kFriction = kInertialParameters * kBodies;
  static constexpr int kRotorInertia = kFriction + 2 * kFrictionJoints;
  static constexpr int kOffset = kRotorInertia + Robot::kDrives;
  static constexpr int kColumns = kOffset + Robot::kDrives;

  /// Number of the body in the parameter vector; its first column is ten times that.
  /// \param index the limb (upper_arm, strut) or the part of the plate, from 0
  static constexpr int body(Body kind, int index) {
    const int limb = kSharing == Limbs::shared ? 0 : index;
    const int fixed = kLimbSets + kStruts;
    switch (kind) {
      case Body::upper_arm: return limb;
      case Body::strut: return kLimbSets + limb;
      case Body::platform: return fixed + index;
      case Body::tool: return fixed + Robot::kPlateParts;
      case Body::telescope_upper: return fixed + Robot::kPlateParts + 1;
      case Body::telescope_lower: return fixed + Robot::kPlateParts + 2;
    }
    return -1;
  }
  static constexpr int viscous(int joint) { return kFriction + 2 * joint; }
  static constexpr int coulomb(int joint) { return kFriction + 2 * joint + 1; }
};

}  // namespace deltadyn
