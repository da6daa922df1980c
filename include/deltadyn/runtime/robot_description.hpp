#pragma once

/// \file
/// A robot as data: what a robot file holds. The tools read it once and dispatch to the compile-time types.

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/model/geometry.hpp"
#include "deltadyn/model/plate_shape.hpp"

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
  std::string type;                            ///< "delta3", "linear-delta3", "delta4", "h4", "i4", "par4", "axis"
  DriveKind drive_kind = DriveKind::revolute;  ///< of the limbs' drives; the telescope's drive is always revolute
  std::vector<LimbGeometry<double>> limbs;
  std::vector<PlatePart<double>> parts;  ///< one for a Delta, none for an axis; of an articulated plate by set_plate()
  std::optional<PlateShape> plate;       ///< of an articulated plate
  std::optional<TelescopeGeometry<double>> telescope;
  std::vector<DriveLimits> limits;  ///< one for each drive (limbs first, then the telescope's)
  Vector3<double> gravity = Vector3<double>(0, 0, -9.81);

  [[nodiscard]] int drives() const { return static_cast<int>(limits.size()); }
  [[nodiscard]] DriveKind kind_of_drive(int drive) const {
    return drive < static_cast<int>(limbs.size()) ? drive_kind : DriveKind::revolute;
  }
  /// A joint with friction that is no drive: "telescope", its slide; "plate", the joints of an articulated one; or "".
  [[nodiscard]] const char* inner_joint() const { return telescope ? "telescope" : (plate ? "plate" : ""); }
  /// Whether friction of the inner joint acts on a drive: a telescope's slide does not turn with the bar.
  [[nodiscard]] bool feels_inner_joint(int drive) const {
    return plate || (telescope && drive < static_cast<int>(limbs.size()));
  }
  /// Whether arms and struts are as long in every limb.
  [[nodiscard]] bool limbs_are_alike() const;
  /// Largest yaw of the tool to either side that an articulated plate allows [rad].
  [[nodiscard]] double plate_yaw_range() const { return plate ? std::abs(plate->ratio) * plate->range : 0.0; }
  /// Gives the robot an articulated plate and its parts. Throws deltadyn::Error if the type has none.
  void set_plate(const PlateShape& shape);
  /// Throws deltadyn::Error if a length is not positive, a count is wrong, or a number is not finite. `where` names the
  /// file.
  void validate(const std::string& where) const;
};

}  // namespace deltadyn
