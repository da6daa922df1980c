#pragma once

/// \file
/// Which numbers a Delta-like robot can have: one set of rules for every door (robot files, flags, config files,
/// parameter files).
///
/// A number that no such machine has is nearly always one in another unit: millimetres, degrees, grams, N mm, kg mm^2.
/// Taken as it stands it would give a prior of 4e8 kg, or a motion that breaks the machine. The rules are wide: arms
/// from a few millimetres to some metres, the fastest and the heaviest machines built, and a margin beyond; each says
/// why it stands where it does. What is outside is refused in words that name the unit in which the number would make
/// sense.

#include <string>

#include "deltadyn/model/body.hpp"
#include "deltadyn/model/inertial_parameters.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/parameter_id.hpp"
#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn::plausibility {

/// Another unit in which the same quantity is often given.
struct OtherUnit {
  const char* name = nullptr;  ///< "millimetres"; null: none
  double si = 1;               ///< one of it in SI units
};

/// The numbers that one quantity can have.
struct Rule {
  double lowest, highest;  ///< both allowed, in `unit`
  const char* unit;        ///< SI
  OtherUnit other;
  const char* reason;  ///< why no machine is outside: a clause that follows "but"
};

// Single numbers, as flags and configuration files hold them.
extern const Rule kLength;             ///< a length in a robot [m]
extern const Rule kOffset;             ///< a coordinate in a robot: as a length, of either sign [m]
extern const Rule kDiameter;           ///< a diameter, width or wall of a part [m]
extern const Rule kDensity;            ///< [kg/m^3]
extern const Rule kMass;               ///< of a part, whatever the robot's size [kg]
extern const Rule kGravity;            ///< size of gravity [m/s^2]
extern const Rule kPlateVelocity;      ///< [m/s]
extern const Rule kPlateAcceleration;  ///< [m/s^2]
extern const Rule kYawVelocity;        ///< [rad/s]
extern const Rule kYawAcceleration;    ///< [rad/s^2]
extern const Rule kTilt;               ///< of a rail against the vertical [rad]
extern const Rule kAzimuth;            ///< of a limb or half plate [rad]
extern const Rule kLimbTilt;           ///< of a limb frame about its own x [rad]
extern const Rule kPlateTurn;          ///< of an articulated plate to either side [rad]
extern const Rule kGearRatio;          ///< between the turn of an articulated plate and its tool
extern const Rule kShare;              ///< a standard deviation as a share of the value
extern const Rule kYaw;                ///< angle of the tool to either side [rad]

/// Throws deltadyn::Error with `code` if the value is not finite or outside the rule.
/// \param what   the quantity in words, e.g. "--upper-arm" or "limb 2: the strut length"
/// \param where  file and place, may be empty
void require(const Rule& rule, double value, const std::string& what, const std::string& where,
             ExitCode code = ExitCode::bad_input);

/// Lengths on their own and beside one another (a limb in millimetres beside two in metres), and gravity.
/// The description's counts must be right (RobotDescription::validate sees to that, then calls this).
void require_geometry(const RobotDescription& robot, const std::string& where);

/// Limits of one drive, from 0; infinite ones do not limit. Uses the lengths of the robot: how fast the elbow moves.
void require_limits(const RobotDescription& robot, int drive, const DriveLimits& limits, const std::string& where,
                    ExitCode code = ExitCode::bad_input);

/// Limits asked for against those of the robot file, which are the machine's.
/// \returns what is worth telling if they are exceeded by little, else empty. Throws if they are exceeded by far.
[[nodiscard]] std::string compare_limits(const RobotDescription& robot, int drive, const DriveLimits& asked,
                                         const std::string& where);

/// Mass, first moments and inertias of a body against the size of the robot; a mass of zero (not given) passes, a
/// negative one does not.
/// \param what the body in words
void require_body(const RobotDescription& robot, Body body, const InertialVector<double>& p, const std::string& what,
                  const std::string& where, ExitCode code = ExitCode::bad_input);

/// Any other parameter.
void require_joint_parameter(ParameterKind kind, double value, const std::string& what, const std::string& where,
                             ExitCode code = ExitCode::bad_input);

}  // namespace deltadyn::plausibility
