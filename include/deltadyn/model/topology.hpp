#pragma once

/// \file
/// The robots as types: everything that is known at compile time.
///
/// A Delta-like robot is: n limbs, a travelling plate, and possibly a telescope bar (Gnad et al. 2024, II.A). This file
/// holds the robots with a rigid plate; those with an articulated one have a file each (h4.hpp, i4.hpp, par4.hpp), and
/// robot_types.hpp lists all.

#include "deltadyn/model/body.hpp"

namespace deltadyn {

enum class DriveKind { revolute, prismatic };

/// Three revolute limbs, the plate only translates.
struct Delta3 {
  static constexpr const char* kName = "delta3";
  static constexpr const char* kClass = "Delta3";  ///< this type, for code that is written
  static constexpr int kLimbs = 3;
  static constexpr int kDrives = 3;
  static constexpr bool kTelescope = false;
  static constexpr bool kPlateTurns = false;  ///< the plate has an inner coordinate theta (H4, I4, Par4)
  static constexpr int kPlateParts = 1;
  static constexpr Body kParts[] = {Body::platform};  ///< what each part of the plate is
  static constexpr DriveKind kDrive = DriveKind::revolute;
};

/// Three prismatic limbs, the plate only translates.
struct LinearDelta3 : Delta3 {
  static constexpr const char* kName = "linear-delta3";
  static constexpr const char* kClass = "LinearDelta3";
  static constexpr DriveKind kDrive = DriveKind::prismatic;
};

/// Delta3 with a telescope bar, turned by the fourth drive, that carries the tool.
struct Delta4 : Delta3 {
  static constexpr const char* kName = "delta4";
  static constexpr const char* kClass = "Delta4";
  static constexpr int kDrives = 4;
  static constexpr bool kTelescope = true;
};

/// One revolute drive with one arm: a drive on its test bench.
struct Axis {
  static constexpr const char* kName = "axis";
  static constexpr const char* kClass = "Axis";
  static constexpr int kLimbs = 1;
  static constexpr int kDrives = 1;
  static constexpr bool kTelescope = false;
  static constexpr bool kPlateTurns = false;
  static constexpr int kPlateParts = 0;  ///< no plate, no struts
  static constexpr Body kParts[] = {Body::platform};
  static constexpr DriveKind kDrive = DriveKind::revolute;
};

/// One prismatic drive with one carriage.
struct LinearAxis : Axis {
  static constexpr const char* kClass = "LinearAxis";
  static constexpr DriveKind kDrive = DriveKind::prismatic;
};

/// Coordinates of the plate that the limbs hold: r, and theta if the plate turns.
template <class Robot>
inline constexpr int kPlateCoordinates = Robot::kPlateParts == 0 ? 0 : (Robot::kPlateTurns ? 4 : 3);

template <class Robot>
inline constexpr bool kHasPlate = Robot::kPlateParts > 0;

/// The part of the plate that is the tool; the last part where none is.
template <class Robot>
constexpr int tool_part() {
  int part = 0;
  while (part < Robot::kPlateParts - 1 && Robot::kParts[part] != Body::tool) ++part;
  return part;
}

/// Has a joint with friction that is no drive: the telescope bar's slide, or the joints of an articulated plate, which
/// all move with theta and so count as one. Such a robot turns its tool, which is a body of its own.
template <class Robot>
inline constexpr bool kHasInnerJoint = Robot::kTelescope || Robot::kPlateTurns;

/// A single crossbar leaves each half of the plate a turn about its hinge (H4), which the struts must prevent; two bars
/// or a slide keep the halves parallel.
template <class Robot>
constexpr bool halves_turn_apart() {
  int crossbars = 0;
  for (const Body part : Robot::kParts) crossbars += part == Body::crossbar ? 1 : 0;
  return crossbars == 1;
}

}  // namespace deltadyn
