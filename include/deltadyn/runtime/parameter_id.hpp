#pragma once

/// \file
/// Which parameter of a robot a column is. Its name is made from this, and nothing else reads names but parameter_id(),
/// for files.

#include <optional>
#include <string>

#include "deltadyn/model/body.hpp"

namespace deltadyn {

enum class ParameterKind { inertial, viscous, coulomb, rotor_inertia, offset };
/// Joint with friction that is no drive: a telescope's slide, or the joints of an articulated plate together.
enum class InnerJointKind { telescope, plate };

struct ParameterId {
  ParameterKind kind = ParameterKind::inertial;
  /// Inertial: of the limb's own body or half plate from 1, or 0 where all share one. Else of the drive from 1; 0: the
  /// inner joint.
  int number = 0;
  Body body = Body::upper_arm;                       ///< inertial
  int entry = 0;                                     ///< inertial: place in kInertialNames
  InnerJointKind inner = InnerJointKind::telescope;  ///< of a joint with number 0

  friend bool operator==(const ParameterId&, const ParameterId&) = default;
  [[nodiscard]] bool is_friction() const { return kind == ParameterKind::viscous || kind == ParameterKind::coulomb; }
  /// Of the same body, or the same joint.
  [[nodiscard]] bool same_owner(const ParameterId& other) const;
};

/// "strut2" or "drive1"
[[nodiscard]] std::string owner_name(const ParameterId& id);
/// "Iyy" or "viscous"
[[nodiscard]] std::string quantity_name(const ParameterId& id);
/// "strut2.Iyy" or "drive1.viscous"
[[nodiscard]] std::string parameter_name(const ParameterId& id);

/// "kg*m^2" or "N*m*s/rad"
/// \param turns  the joint turns, or slides: of no account for bodies
[[nodiscard]] std::string parameter_unit(const ParameterId& id, bool turns);

/// The parameter with this name; nothing if no robot has one.
[[nodiscard]] std::optional<ParameterId> parameter_id(const std::string& name);

}  // namespace deltadyn
