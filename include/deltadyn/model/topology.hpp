#pragma once

/// \file
/// The robots as types: everything that is known at compile time.
///
/// A Delta-like robot is: n limbs, a travelling plate, and possibly a telescope bar (Gnad et al. 2024, II.A).

namespace deltadyn {

enum class DriveKind { revolute, prismatic };

/// Three revolute limbs, the plate only translates.
struct Delta3 {
  static constexpr const char* kName = "delta3";
  static constexpr int kLimbs = 3;
  static constexpr int kDrives = 3;
  static constexpr bool kTelescope = false;
  static constexpr bool kPlateTurns = false;  ///< the plate has an inner coordinate theta (H4, I4, Par4)
  static constexpr int kPlateParts = 1;
  static constexpr DriveKind kDrive = DriveKind::revolute;
};

/// Three prismatic limbs, the plate only translates.
struct LinearDelta3 : Delta3 {
  static constexpr const char* kName = "linear-delta3";
  static constexpr DriveKind kDrive = DriveKind::prismatic;
};

/// Delta3 with a telescope bar, turned by the fourth drive, that carries the tool.
struct Delta4 : Delta3 {
  static constexpr const char* kName = "delta4";
  static constexpr int kDrives = 4;
  static constexpr bool kTelescope = true;
};

/// One revolute drive with one arm: a drive on its test bench.
struct Axis {
  static constexpr const char* kName = "axis";
  static constexpr int kLimbs = 1;
  static constexpr int kDrives = 1;
  static constexpr bool kTelescope = false;
  static constexpr bool kPlateTurns = false;
  static constexpr int kPlateParts = 0;  ///< no plate, no struts
  static constexpr DriveKind kDrive = DriveKind::revolute;
};

/// One prismatic drive with one carriage.
struct LinearAxis : Axis {
  static constexpr DriveKind kDrive = DriveKind::prismatic;
};

/// Coordinates of the plate that the limbs hold: r, and theta if the plate turns.
template <class Robot>
inline constexpr int kPlateCoordinates = Robot::kPlateParts == 0 ? 0 : (Robot::kPlateTurns ? 4 : 3);

template <class Robot>
inline constexpr bool kHasPlate = Robot::kPlateParts > 0;

}  // namespace deltadyn
