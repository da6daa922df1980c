#pragma once

/// \file
/// Which parameter stands in which column of the regressor, at compile time.
///
/// Order: the bodies (ten columns each, paper (4)), then for each joint with friction its viscous and Coulomb column
/// (drives first, then the inner joint: the telescope's slide, or all joints of an articulated plate), then rotor
/// inertias, then torque offsets.

#include "deltadyn/model/body.hpp"
#include "deltadyn/model/topology.hpp"

namespace deltadyn {

enum class Limbs { shared, individual };

/// Columns of a robot whose limbs are all alike (shared) or each on its own (individual). Halves of a plate go with the
/// limbs that they hold; other parts of a kind are alike.
template <class Robot, Limbs kSharing>
struct ParameterLayout {
  static constexpr int kLimbSets = kSharing == Limbs::shared ? 1 : Robot::kLimbs;
  static constexpr int kStruts = kHasPlate<Robot> ? kLimbSets : 0;

  /// Place of a part of the plate among the plate's bodies in the parameter vector.
  static constexpr int plate_set(int part) {
    int sets = 0;
    for (int k = 0; k <= part; ++k) {
      int first = 0;
      while (Robot::kParts[first] != Robot::kParts[k]) ++first;
      const bool own = first == k || (kSharing == Limbs::individual && Robot::kParts[k] == Body::half_plate);
      if (k == part && !own) return plate_set(first);
      sets += own ? 1 : 0;
    }
    return sets - 1;
  }
  static constexpr int plate_sets() {
    int most = 0;
    for (int k = 0; k < Robot::kPlateParts; ++k) most = plate_set(k) + 1 > most ? plate_set(k) + 1 : most;
    return most;
  }

  static constexpr int kPlateSets = plate_sets();
  static constexpr int kTelescopeBodies = Robot::kTelescope ? 3 : 0;  ///< tool and the two parts of the bar
  static constexpr int kBodies = kLimbSets + kStruts + kPlateSets + kTelescopeBodies;
  static constexpr int kFrictionJoints = Robot::kDrives + (kHasInnerJoint<Robot> ? 1 : 0);

  static constexpr int kFriction = kInertialParameters * kBodies;
  static constexpr int kRotorInertia = kFriction + 2 * kFrictionJoints;
  static constexpr int kOffset = kRotorInertia + Robot::kDrives;
  static constexpr int kColumns = kOffset + Robot::kDrives;

  /// Number of the body in the parameter vector; its first column is ten times that.
  /// \param index the limb (upper_arm, strut) or the part of the plate, from 0; of no account for a telescope's bodies
  static constexpr int body(Body kind, int index) {
    const int limb = kSharing == Limbs::shared ? 0 : index;
    const int plate = kLimbSets + kStruts;
    switch (kind) {
      case Body::upper_arm: return limb;
      case Body::strut: return kLimbSets + limb;
      case Body::tool: return Robot::kTelescope ? plate + kPlateSets : plate + plate_set(tool_part<Robot>());
      case Body::telescope_upper: return plate + kPlateSets + 1;
      case Body::telescope_lower: return plate + kPlateSets + 2;
      case Body::platform:
      case Body::half_plate:
      case Body::crossbar: return plate + plate_set(index);
    }
    return -1;
  }
  static constexpr int viscous(int joint) { return kFriction + 2 * joint; }
  static constexpr int coulomb(int joint) { return kFriction + 2 * joint + 1; }
};

}  // namespace deltadyn
