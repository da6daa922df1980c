#include "deltadyn/runtime/plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <vector>

namespace deltadyn::plausibility {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr OtherUnit kMillimetres{"millimetres", 1e-3};
constexpr OtherUnit kDegrees{"degrees", kPi / 180};
constexpr OtherUnit kGrams{"grams", 1e-3};
constexpr OtherUnit kNone{};

// Limits of drives. A gear of 10 or more between a motor of 6000 rpm and an arm, or a torque motor without a gear,
// gives 60 rad/s; a small arm may turn faster, as long as its elbow stays slow. The fastest Deltas move their plate at
// 10 m/s.
constexpr double kArmRate = 60;      // [rad/s]
constexpr double kSmallElbow = 6;    // [m/s], an elbow this slow may turn at any rate
constexpr double kElbowSpeed = 15;   // [m/s]
constexpr double kElbowRise = 1200;  // [m/s^2]; the record is 100 g at the plate (R4, Montpellier)
constexpr Rule kArmAngle{-2 * kPi, 2 * kPi, "rad", kDegrees,
                         "an arm that carries struts cannot turn further than once round"};
constexpr Rule kManyTurns{-100, 100, "rad", kDegrees,
                          "more than 16 turns are no range: leave the limit out if the drive turns without end"};
constexpr Rule kMotorRate{0, 1100, "rad/s", kDegrees, "no servo motor turns faster than 10500 rpm"};
constexpr Rule kSlide{-20, 20, "m", kMillimetres, "no rail of such a robot is longer than 20 m"};
constexpr Rule kSlideRate{0, 15, "m/s", kMillimetres, "no linear drive is faster than 15 m/s"};
constexpr Rule kSlideRise{0, 1200, "m/s^2", kMillimetres, "no linear drive does more than 120 times gravity"};
constexpr Rule kArmTorque{0, 5000, "N m", {"N mm", 1e-3}, "the largest Deltas have gears for 1000 N m"};
constexpr Rule kYawTorque{0, 500, "N m", {"N mm", 1e-3}, "a tool is turned by a few N m"};
constexpr Rule kAnyTorque{0, 1e5, "N m", {"N mm", 1e-3}, "no single drive has that much"};
constexpr Rule kSlideForce{0, 1e5, "N", {"mN", 1e-3}, "no linear drive of such a robot has that much"};

// Joint parameters: wide, for they differ by orders of magnitude between a needle bearing and a gear that is cold.
constexpr Rule kViscous{
    0, 1e5, "N m s/rad or N s/m", {"N mm s/rad", 1e-3}, "friction is not negative, and not that large"};
constexpr Rule kCoulomb{0, 1e4, "N m or N", {"N mm", 1e-3}, "friction is not negative, and not that large"};
constexpr Rule kRotor{-1e4, 1e4, "kg m^2 or kg", {"kg mm^2", 1e-6}, "no rotor is that heavy behind its gear"};
constexpr Rule kTorqueOffset{-1e4, 1e4, "N m or N", {"N mm", 1e-3}, "no amplifier is off by that much"};

// Lengths beside one another.
constexpr double kStrutToArm = 20;   // either way; a Delta has 2 to 3, and centimetres beside metres would have 40
constexpr double kAlike = 20;        // the same length in two limbs; calibration moves them by a part in a thousand
constexpr double kReachShare = 3;    // base and plate against arm and strut; to close they need 1
constexpr double kSpacingShare = 2;  // distance of the two struts against their length

// How far mass lies from the frame's origin, against the robot's size: moments in kg mm are a thousand times as large.
// A motor behind a gear that is not modelled on its own may stand in the arm's inertia, so there is room.
constexpr double kLever = 10;

[[noreturn]] void refuse(const Rule& rule, double value, const std::string& what, const std::string& why,
                         const std::string& where, ExitCode code) {
  constexpr double kFar = 1.2;  // over the limit; what is nearer is in no other unit
  std::string other, mend = fmt::format("give it in {}", rule.unit);
  const double meant = value * rule.other.si;
  const bool far = value > 0 ? value > kFar * rule.highest || kFar * value < rule.lowest : value < kFar * rule.lowest;
  if (rule.other.name != nullptr && far && meant >= rule.lowest && meant <= rule.highest) {
    other = fmt::format("; it looks like {}", rule.other.name);
    mend += fmt::format(": {:.6g} {} are {:.4g} {}", value, rule.other.name, meant, rule.unit);
  }
  throw Error(fmt::format("{} is {:.6g} {}, but {}{}", what, value, rule.unit, why, other), where, mend, code);
}

bool turns(const RobotDescription& robot, int drive) {
  return robot.kind_of_drive(drive) == DriveKind::revolute;
}
bool is_limb(const RobotDescription& robot, int drive) {
  return drive < static_cast<int>(robot.limbs.size());
}

/// Longest arm (or none), longest strut.
double longest_arm(const RobotDescription& robot) {
  double length = 0;
  if (robot.drive_kind == DriveKind::revolute)
    for (const auto& limb : robot.limbs) length = std::max(length, limb.p_DE_0.norm());
  return length;
}
double longest_strut(const RobotDescription& robot) {
  double length = 0;
  if (!robot.parts.empty())
    for (const auto& limb : robot.limbs) length = std::max(length, limb.strut);
  return length;
}
double size_of(const RobotDescription& robot) {
  return longest_arm(robot) + longest_strut(robot);
}

/// The same length of all limbs.
void require_alike(const std::vector<double>& lengths, const char* what, const std::string& where) {
  const auto least = std::ranges::min_element(lengths), most = std::ranges::max_element(lengths);
  if (*most <= kAlike * *least) return;
  throw Error(fmt::format("{} of limb {} is {:.6g} m, but that of limb {} is {:.6g} m: one of them is in another unit",
                          what, most - lengths.begin() + 1, *most, least - lengths.begin() + 1, *least),
              where, "give all lengths in metres");
}

/// The lengths of one limb beside one another. \param arms  the drives have arms, else they slide
void require_one_size(const LimbGeometry<double>& limb, std::size_t number, bool arms, const std::string& where) {
  const double arm = arms ? limb.p_DE_0.norm() : 0, reach = arm + limb.strut;
  const auto beside = [&](const char* what, double value, double largest) {
    if (value <= largest) return;
    throw Error(fmt::format("limb {}: the {} is {:.6g} m, which does not go with arm and strut of {:.6g} m: one of "
                            "them is in another unit",
                            number, what, value, reach),
                where, "give all lengths in metres");
  };
  if (arms && (limb.strut > kStrutToArm * arm || arm > kStrutToArm * limb.strut))
    throw Error(fmt::format("limb {}: an upper arm of {:.6g} m does not go with struts of {:.6g} m: one of them is in "
                            "another unit",
                            number, arm, limb.strut),
                where, "give all lengths in metres");
  beside("distance of the two struts", limb.strut_spacing, kSpacingShare * limb.strut);
  beside("distance of the attachment from the plate's centre", limb.p_BA.norm(), kReachShare * reach);
  // A rail may be long, and its zero anywhere on it.
  if (arms) beside("distance of the drive from the base's origin", limb.p_WD.norm(), kReachShare * reach);
}

void require_rate(const Rule& rule, double value, const std::string& what, const std::string& where, ExitCode code) {
  if (!std::isinf(value)) require(rule, value, what, where, code);
}

/// Velocity and acceleration of a drive with an arm, by what they do to the elbow.
void require_arm_rates(double arm, const DriveLimits& limits, const std::string& name, const std::string& where,
                       ExitCode code) {
  const double fastest = std::min(kElbowSpeed / arm, std::max(kArmRate, kSmallElbow / arm));
  if (std::isfinite(limits.velocity) && limits.velocity > fastest)
    refuse({0, fastest, "rad/s", kDegrees, ""}, limits.velocity, name + ": the velocity limit",
           fmt::format("it would move the elbow at {:.3g} m/s, and no arm of {:.3g} m does more than {:.3g} rad/s",
                       limits.velocity * arm, arm, fastest),
           where, code);
  const double rise = kElbowRise / arm;
  if (std::isfinite(limits.acceleration) && limits.acceleration > rise)
    refuse({0, rise, "rad/s^2", kDegrees, ""}, limits.acceleration, name + ": the acceleration limit",
           fmt::format(
               "it would accelerate the elbow at {:.3g} m/s^2, and no arm of {:.3g} m does more than {:.3g} rad/s^2",
               limits.acceleration * arm, arm, rise),
           where, code);
}

void require_range(const Rule& rule, const DriveLimits& limits, const std::string& name, const std::string& where,
                   ExitCode code) {
  for (const double end : {limits.lower, limits.upper})
    if (!std::isinf(end)) require(rule, end, name + ": a position limit", where, code);
}

/// Largest mass [kg] of a body of a robot of this size. Each is a part of solid steel of the thickest shape that still
/// makes a moving part, and a constant for hubs, sockets and grippers that do not shrink with the robot; a gram taken
/// for a kilogram is beyond it for robots of all sizes.
double heaviest(const RobotDescription& robot, Body body) {
  if (robot.parts.empty()) return kMass.highest;  // what a single drive moves may be anything
  const double strut = longest_strut(robot), arm = longest_arm(robot), size = 1.3 * strut + arm;
  switch (body) {
    case Body::upper_arm:  // diameter a fifth of the length; a carriage carries its bearings
      return arm > 0 ? std::min(300.0, 0.3 + 250 * arm * arm * arm) : std::min(300.0, 3 + 200 * strut * strut * strut);
    case Body::strut: return std::min(100.0, 0.1 + 20 * strut * strut * strut);  // diameter a twentieth
    case Body::platform:
    case Body::half_plate:
    case Body::crossbar:
    case Body::tool: return std::min(200.0, 0.5 + 30 * size * size);
    case Body::telescope_upper:
    case Body::telescope_lower: return std::min(200.0, 0.5 + 20 * size * size);
  }
  return kMass.highest;
}

}  // namespace

const Rule kLength{1e-4, 10, "m", kMillimetres, "a length of a moving robot is between 0.1 mm and 10 m"};
const Rule kOffset{-10, 10, "m", kMillimetres, "no Delta robot is that large"};
const Rule kDiameter{1e-5, 2, "m", kMillimetres, "no part of a moving robot is that thick or that thin"};
const Rule kDensity{
    20, 25000, "kg/m^3", {"g/cm^3", 1000}, "the lightest foam has 20 and the densest metal 22600 kg/m^3"};
const Rule kMass{0, 5000, "kg", kGrams, "no part of a moving robot is that heavy, and none is lighter than nothing"};
// On Earth 9.76 to 9.84; people write 9.8 and 10.
const Rule kGravity{9.5, 10.1, "m/s^2", {"mm/s^2", 1e-3}, "gravity on Earth is 9.76 to 9.84 m/s^2"};
const Rule kPlateVelocity{0, 30, "m/s", kMillimetres, "the fastest Deltas do 10 m/s"};
const Rule kPlateAcceleration{0, 1500, "m/s^2", kMillimetres, "the record of a Delta is 100 times gravity"};
const Rule kYawVelocity{0, 150, "rad/s", kDegrees, "no Delta turns its tool faster than 1400 rpm"};
const Rule kYawAcceleration{0, 3000, "rad/s^2", kDegrees, "no Delta turns its tool that suddenly"};
const Rule kTilt{-kPi, kPi, "rad", kDegrees, "a tilt is half a turn at most"};
const Rule kAzimuth{-2 * kPi, 2 * kPi, "rad", kDegrees, "an azimuth is once round at most"};
const Rule kLimbTilt{-1.55, 1.55, "rad", kDegrees, "a drive's axis tilts by less than 90 deg"};
const Rule kPlateTurn{1e-3, 2 * kPi, "rad", kDegrees, "a plate turns by a milliradian at least and once round at most"};
const Rule kGearRatio{0.05, 100, "turns a turn", kNone, "no gear or belt of a plate does that"};
const Rule kShare{1e-6, 10, "times the value", {"per cent", 0.01}, "that says nothing about the value"};
const Rule kYaw{-100, 100, "rad", kDegrees,
                "more than 16 turns are no range: leave the limit out if the tool turns without end"};

void require(const Rule& rule, double value, const std::string& what, const std::string& where, ExitCode code) {
  if (value >= rule.lowest && value <= rule.highest) return;  // false for NaN
  if (!std::isfinite(value))
    throw Error(fmt::format("{} is {}, which is not a finite number", what, value), where,
                fmt::format("give a number in {}", rule.unit), code);
  refuse(rule, value, what, rule.reason, where, code);
}

void require_geometry(const RobotDescription& robot, const std::string& where) {
  require(kGravity, robot.gravity.norm(), "the size of gravity", where);
  const bool plate = !robot.parts.empty(), arms = robot.drive_kind == DriveKind::revolute;
  std::vector<double> arm_lengths, struts, spacings;
  for (std::size_t i = 0; i < robot.limbs.size(); ++i) {
    const LimbGeometry<double>& limb = robot.limbs[i];
    const auto name = [i](const char* what) { return fmt::format("limb {}: the {}", i + 1, what); };
    require(kAzimuth, limb.azimuth, name("azimuth"), where);
    require(kLimbTilt, limb.tilt, name("tilt"), where);
    require(kOffset, limb.p_WD.norm(), name("distance of the drive from the base's origin"), where);
    if (limb.p_DE_0.norm() > 0) require(kLength, limb.p_DE_0.norm(), name("length of the upper arm"), where);
    if (!plate) continue;
    require(kLength, limb.strut, name("strut length"), where);
    require(kLength, limb.strut_spacing, name("distance of the two struts"), where);
    require(kOffset, limb.p_BA.norm(), name("distance of the attachment from the plate's centre"), where);
    arm_lengths.push_back(limb.p_DE_0.norm());
    struts.push_back(limb.strut);
    spacings.push_back(limb.strut_spacing);
  }
  if (!plate) return;
  if (arms) require_alike(arm_lengths, "the upper arm", where);
  require_alike(struts, "the strut", where);
  require_alike(spacings, "the distance of the two struts", where);
  for (std::size_t i = 0; i < robot.limbs.size(); ++i) require_one_size(robot.limbs[i], i + 1, arms, where);
  if (!robot.telescope) return;
  const double reach = kReachShare * size_of(robot);
  for (const auto& [what, place] : {std::pair{"upper", robot.telescope->p_WU}, {"lower", robot.telescope->p_BV}})
    if (place.norm() > reach)
      throw Error(
          fmt::format("telescope: the {} joint lies {:.6g} m from the origin, which does not go with arm and strut of "
                      "{:.6g} m: one of them is in another unit",
                      what, place.norm(), size_of(robot)),
          where, "give all lengths in metres");
}

void require_limits(const RobotDescription& robot, int drive, const DriveLimits& limits, const std::string& where,
                    ExitCode code) {
  const std::string name = fmt::format("drive {}", drive + 1);
  const auto rates = [&](const Rule& velocity, const Rule& acceleration, const Rule& effort) {
    require_rate(velocity, limits.velocity, name + ": the velocity limit", where, code);
    require_rate(acceleration, limits.acceleration, name + ": the acceleration limit", where, code);
    require_rate(effort, limits.effort, name + ": the effort limit", where, code);
  };
  const bool alone = robot.parts.empty();
  if (!turns(robot, drive)) {
    require_range(kSlide, limits, name, where, code);
    rates(kSlideRate, kSlideRise, kSlideForce);
    return;
  }
  if (!is_limb(robot, drive)) {
    require_range(kYaw, limits, name, where, code);
    rates(kYawVelocity, kYawAcceleration, kYawTorque);
    return;
  }
  const double arm = robot.limbs[static_cast<std::size_t>(drive)].p_DE_0.norm();
  require_range(alone ? kManyTurns : kArmAngle, limits, name, where, code);
  if (!alone && limits.upper - limits.lower > kArmAngle.highest + 1e-3 && std::isfinite(limits.upper - limits.lower))
    refuse({0, kArmAngle.highest, "rad", kDegrees, ""}, limits.upper - limits.lower,
           name + ": the width of the position range", kArmAngle.reason, where, code);
  if (arm > 0) require_arm_rates(arm, limits, name, where, code);
  const Rule any_acceleration{0, 1e6, "rad/s^2", kDegrees, "no motor does that"};
  rates(kMotorRate, any_acceleration, alone ? kAnyTorque : kArmTorque);
}

std::string compare_limits(const RobotDescription& robot, int drive, const DriveLimits& asked,
                           const std::string& where) {
  // Times the file's rate: a file on the safe side is a matter of tens of per cent
  constexpr double kByFar = 1.5;
  constexpr double kByFarOfRange = 0.25;  // of the file's range, beyond either of its ends
  const DriveLimits& file = robot.limits[static_cast<std::size_t>(drive)];
  const std::string unit = turns(robot, drive) ? "rad" : "m", name = fmt::format("drive {}", drive + 1);
  std::string told;
  const auto exceeded = [&](const std::string& what, double value, double limit, const std::string& of, bool by_far) {
    if (by_far)
      throw Error(
          fmt::format("{}: the {} limit asked for is {:.6g} {}, but the robot file allows {:.6g} {}", name, what, value,
                      of, limit, of),
          where,
          fmt::format("ask for {:.6g} {} or less, or mend the limit in the robot file if the machine can do more",
                      limit, of),
          ExitCode::usage);
    told += fmt::format("{}{}: the {} limit asked for, {:.6g} {}, is beyond the {:.6g} {} of the robot file",
                        told.empty() ? "" : "; ", name, what, value, of, limit, of);
  };
  const auto rate = [&](const char* what, double value, double limit, const std::string& of) {
    if (std::isfinite(limit) && value > limit * (1 + 1e-9)) exceeded(what, value, limit, of, value > kByFar * limit);
  };
  rate("velocity", asked.velocity, file.velocity, unit + "/s");
  rate("acceleration", asked.acceleration, file.acceleration, unit + "/s^2");
  rate("effort", asked.effort, file.effort, turns(robot, drive) ? "N m" : "N");
  const double width = file.upper - file.lower;
  const double beyond = std::isfinite(width) ? kByFarOfRange * width : 0.0;
  if (asked.lower < file.lower - 1e-9)
    exceeded("lower position", asked.lower, file.lower, unit, asked.lower < file.lower - beyond);
  if (asked.upper > file.upper + 1e-9)
    exceeded("upper position", asked.upper, file.upper, unit, asked.upper > file.upper + beyond);
  return told;
}

void require_body(const RobotDescription& robot, Body body, const InertialVector<double>& p, const std::string& what,
                  const std::string& where, ExitCode code) {
  using namespace inertial;
  const double most = heaviest(robot, body);
  const double mass = p(kM);
  const Rule rule{0, most, "kg", kGrams, "no part weighs that"};
  if (mass < 0)
    throw Error(fmt::format("{}: the mass {:.6g} kg is negative", what, mass), where, "give a mass above 0 kg", code);
  if (!std::isfinite(mass)) require(rule, mass, what + ": the mass", where, code);
  if (mass > most)
    refuse(rule, mass, what + ": the mass",
           fmt::format("this part of a robot of this size weighs {:.3g} kg at most", most), where, code);
  for (int k = kIxx; k <= kIzz; ++k)
    if (!(p(k) >= 0))
      refuse({0, 1e6, "kg m^2", kNone, ""}, p(k), what + ": the inertia", "an inertia about an axis is not negative",
             where, code);
  if (robot.parts.empty() || !(mass > 0)) return;  // what a single drive moves may have any inertia
  const double lever = kLever * size_of(robot);
  const double first = p.segment<3>(kMcx).norm();
  if (first > mass * lever)
    refuse({0, mass * lever, "kg m", {"kg mm", 1e-3}, ""}, first, what + ": the first moment",
           fmt::format("it puts the centre of mass {:.3g} m from the joint", first / mass), where, code);
  const double inertia = p.segment<3>(kIxx).maxCoeff();
  if (inertia > mass * lever * lever)
    refuse({0, mass * lever * lever, "kg m^2", {"kg mm^2", 1e-6}, ""}, inertia, what + ": the inertia",
           fmt::format("it puts {:.3g} kg {:.3g} m from the axis", mass, std::sqrt(inertia / mass)), where, code);
}

void require_joint_parameter(ParameterKind kind, double value, const std::string& what, const std::string& where,
                             ExitCode code) {
  switch (kind) {
    case ParameterKind::inertial: return;
    case ParameterKind::viscous: return require(kViscous, value, what, where, code);
    case ParameterKind::coulomb: return require(kCoulomb, value, what, where, code);
    case ParameterKind::rotor_inertia: return require(kRotor, value, what, where, code);
    case ParameterKind::offset: return require(kTorqueOffset, value, what, where, code);
  }
}

}  // namespace deltadyn::plausibility
