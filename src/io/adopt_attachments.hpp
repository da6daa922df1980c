#pragma once

/// \file
/// How the limbs of a CAD robot end on the plate.

#include <string>
#include <vector>

#include "adopt_parts.hpp"

namespace deltadyn::cad {

/// What is known of the limbs before: all in the root link's frame.
struct LimbPlace {
  Vec elbow = Vec::Zero();     ///< centre between the elbow joints
  Vec outwards = Vec::Zero();  ///< unit, from the robot's middle axis along the limb
  Vec across = Vec::Zero();    ///< unit, along the drive's axis
  double radius = 0;           ///< of the elbow about the middle axis [m]
};

struct Attachments {
  std::vector<Vec> offsets;     ///< centre between the ends of a limb's struts from the plate's centre
  std::vector<double> lengths;  ///< of the struts [m]
  std::vector<Vec> directions;  ///< unit, from elbow to plate as the CAD draws them
  Vec plate_centre = Vec::Zero();
  bool assembled = true;  ///< false: the parts do not stand in a pose of the robot, and only lengths could be used
  std::string note;       ///< how they were found, empty if the tree shows them
};

/// The point nearest to the lines that leave `points` at right angles to `across` and `up`, at their mean height: where
/// the limbs of a base or of a plate meet.
/// \param across, up  unit
[[nodiscard]] Vec middle_of(const std::vector<Vec>& points, const std::vector<Vec>& across, const Vec& up);

/// \param up  unit, normal of the base
[[nodiscard]] Attachments find_attachments(const UrdfTree& tree, const Parts& parts, const AdoptOptions& options,
                                           const std::vector<LimbPlace>& limbs, const Vec& up);

}  // namespace deltadyn::cad
