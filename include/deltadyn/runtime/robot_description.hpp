#pragma once

/// \file
/// A robot as data: what a robot file holds. The tools read it once and dispatch to the compile-time types.

#include <optional>
#include <string>
#include <vector>

#include "deltadyn/model/geometry.hpp"

namespace deltadyn {

/// Limits of one drive; infinite where not given. Units: rad, m as the drive is revolute or prismatic.
struct DriveLimits {
  double lower, upper;  ///< position [rad | m]
  double velocity;      ///< [rad/s | m/s]
  double acceleration;  ///< [rad/s^2 | m/s^2]
  double effort;        ///< [N m | N]
  DriveLimits();
};

struct RobotDescription {
  std::string name;                            ///< free text, the URDF robot name
  std::string type;                            ///< "delta3", "linear-delta3", "delta4", "axis"
  DriveKind drive_kind = DriveKind::revolute;  ///< of the limbs' drives; the telescope's drive is always revolute
  std::vector<LimbGeometry<double>> limbs;
  std::vector<PlatePart<double>> parts;  ///< one for a Delta, none for an axis
  std::optional<TelescopeGeometry<double>> telescope;
  std::vector<DriveLimits> limits;  ///< one for each drive (limbs first, then the telescope's)
  Vector3<double> gravity = Vector3<double>(0, 0, -9.81);

  [[nodiscard]] int drives() const { return static_cast<int>(limits.size()); }
  [[nodiscard]] DriveKind kind_of_drive(int drive) const {
    return drive < static_cast<int>(limbs.size()) ? drive_kind : DriveKind::revolute;
  }
  /// Throws deltadyn::Error if a length is not positive, a count is wrong, or a number is not finite. `where` names the
  /// file.
  void validate(const std::string& where) const;
};

}  // namespace deltadyn
