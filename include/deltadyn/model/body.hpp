#pragma once

/// \file
/// The moving bodies of a Delta-like robot and the ten parameters of each.

namespace deltadyn {

/// half_plate: a part of an articulated plate that two limbs hold and that only translates; crossbar: a part between
/// the halves that turns.
enum class Body { upper_arm, strut, platform, tool, telescope_upper, telescope_lower, half_plate, crossbar };

inline constexpr const char* kBodyNames[] = {"upper_arm",       "strut",           "platform",   "tool",
                                             "telescope_upper", "telescope_lower", "half_plate", "crossbar"};
constexpr const char* name(Body body) {
  return kBodyNames[static_cast<int>(body)];
}

/// Paper (4): mass [kg], first moments [kg m], inertia about the body frame's origin [kg m^2].
inline constexpr int kInertialParameters = 10;
inline constexpr const char* kInertialNames[kInertialParameters] = {"m",   "mcx", "mcy", "mcz", "Ixx",
                                                                    "Iyy", "Izz", "Ixy", "Iyz", "Ixz"};
inline constexpr const char* kInertialUnits[kInertialParameters] = {"kg",     "kg*m",   "kg*m",   "kg*m",   "kg*m^2",
                                                                    "kg*m^2", "kg*m^2", "kg*m^2", "kg*m^2", "kg*m^2"};

}  // namespace deltadyn
