#pragma once

/// \file
/// An articulated plate as a tree: half plate 1 hangs on a strut, and every other part on it by at most two joints that
/// move with theta. That says where each part is at any theta, whichever way the part is held in the machine.

#include <string>
#include <vector>

#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn::robot_file {

/// A joint of the plate; its coordinate is `gain` times theta. z is its axis, or the direction of a slide `along`.
struct PlateJoint {
  std::string name;
  bool slides = false;
  double gain = 0;                                   ///< [1], of a slide [m/rad]
  Vector3<double> along = Vector3<double>::UnitZ();  ///< in the frame of half plate 1
  [[nodiscard]] bool moves() const { return gain != 0; }
};

struct PlateBody {
  int part = 0;
  std::string name;    ///< "half_plate2", "crossbar1", "tool"
  std::string shared;  ///< the same where alike parts share their parameters
  double turn = 0;     ///< of its frame from that of half plate 1, at theta = 0 [rad]
  /// From half plate 1, in its frame, at theta = 0: the first joint, and the body's origin where the second joint is
  Vector3<double> first = Vector3<double>::Zero(), origin = Vector3<double>::Zero();
  PlateJoint swing;  ///< or slide; carries the second
  PlateJoint level;  ///< turns the body on its own origin
};

/// Names of all parts, half plate 1 first.
[[nodiscard]] std::vector<PlateBody> plate_bodies(const RobotDescription& robot);

/// The joint whose coordinate is theta, among those of plate_bodies(): it holds the friction of all of them.
[[nodiscard]] std::string theta_joint(const std::vector<PlateBody>& bodies);

/// The link of the plate that holds a limb.
[[nodiscard]] std::string plate_link(const RobotDescription& robot, const LimbGeometry<double>& limb);

/// A point of a limb on its plate part, given from the part's origin in W, in the frame of that link.
[[nodiscard]] Vector3<double> on_plate_link(const RobotDescription& robot, const LimbGeometry<double>& limb,
                                            const Vector3<double>& p_BA);

}  // namespace deltadyn::robot_file
