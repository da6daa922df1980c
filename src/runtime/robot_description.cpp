#include "deltadyn/runtime/robot_description.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "deltadyn/runtime/articulated_plate.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/geometry_of.hpp"
#include "deltadyn/runtime/plausibility.hpp"

namespace deltadyn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUnitTolerance = 1e-9;  // a unit vector read from text may be off in the last digits

/// What the counts of a type are.
struct TypeRule {
  const char* name = nullptr;
  std::size_t limbs = 0, parts = 0;
  bool telescope = false, turns = false;
};

[[noreturn]] void refuse(const std::string& what, const std::string& where, const std::string& mend) {
  throw Error(what, where, mend);
}

TypeRule rule_of(const RobotDescription& robot, const std::string& where) {
  const auto rule = [](auto type) {
    using R = decltype(type);
    return TypeRule{R::kName, R::kLimbs, R::kPlateParts, R::kTelescope, R::kPlateTurns};
  };
  return visit_robot_type(robot.type, robot.drive_kind, rule, [&]() -> TypeRule {
    const DriveKind other = robot.drive_kind == DriveKind::revolute ? DriveKind::prismatic : DriveKind::revolute;
    const TypeRule known = visit_robot_type(robot.type, other, rule, [] { return TypeRule(); });
    if (known.name != nullptr)
      refuse(fmt::format("the drives of a {} are {}", robot.type,
                         other == DriveKind::prismatic ? "prismatic" : "revolute"),
             where, "use type linear-delta3 for prismatic drives, delta3 or delta4 for revolute ones");
    refuse(fmt::format("'{}' is not a robot type", robot.type), where, "use one of " + robot_type_names());
  });
}

void require_finite(const Vector3<double>& v, const std::string& what, const std::string& where) {
  if (!v.allFinite()) refuse(what + " holds a number that is not finite", where, "give three finite numbers");
}

void require_positive(double value, const std::string& what, const std::string& where) {
  if (!(std::isfinite(value) && value > 0))
    refuse(fmt::format("{} is {} m, but must be positive", what, value), where, "give a positive length in metres");
}

void validate_limb(const LimbGeometry<double>& limb, std::size_t number, bool plate, DriveKind kind,
                   const std::string& where) {
  const std::string name = fmt::format("limb {}", number);
  if (!std::isfinite(limb.azimuth) || !std::isfinite(limb.tilt))
    refuse(name + ": the azimuth or the tilt is not finite", where, "give angles in radians");
  require_finite(limb.p_WD, name + ": the place of the drive", where);
  require_finite(limb.p_DE_0, name + ": the place of the elbow", where);
  require_finite(limb.axis_L, name + ": the axis of the drive", where);
  require_finite(limb.p_BA, name + ": the attachment on the plate", where);
  if (kind == DriveKind::revolute) {
    if (!limb.axis_L.isApprox(Vector3<double>::UnitY(), kUnitTolerance))
      refuse(fmt::format("{}: a revolute drive turns about +y of its limb frame, not about ({}, {}, {})", name,
                         limb.axis_L.x(), limb.axis_L.y(), limb.axis_L.z()),
             where, "turn the limb by its azimuth instead");
    if (plate) require_positive(limb.p_DE_0.x(), name + ": the length of the upper arm", where);
    if (limb.p_DE_0.tail<2>().norm() > kUnitTolerance || limb.p_DE_0.x() < 0)
      refuse(name + ": the elbow of a revolute drive lies on +x of the upper arm at angle 0", where,
             "an angle of 0 is horizontal outwards; put an offset into the drive's zero");
  } else if (std::abs(limb.axis_L.norm() - 1) > kUnitTolerance) {
    refuse(fmt::format("{}: the axis of the drive has length {}, but must be a unit vector", name, limb.axis_L.norm()),
           where, "divide the axis by its length");
  }
  if (!plate) return;
  require_positive(limb.strut, name + ": the strut length", where);
  require_positive(limb.strut_spacing, name + ": the distance of the two struts", where);
  if (limb.elbow != 1 && limb.elbow != -1)
    refuse(fmt::format("{}: the elbow posture is {}, but must be +1 or -1", name, limb.elbow), where,
           "+1 is the elbow outwards or the carriage behind the plate, -1 the other posture");
}

void validate_limits(const DriveLimits& limits, std::size_t number, const std::string& where) {
  const std::string name = fmt::format("drive {}", number);
  if (!(limits.lower < limits.upper))
    refuse(
        fmt::format("{}: the lower position limit {} is not below the upper one {}", name, limits.lower, limits.upper),
        where, "swap or mend the limits");
  const auto positive = [&](double value, const char* what) {
    if (!(value > 0))
      refuse(fmt::format("{}: the {} limit is {}, but must be positive", name, what, value), where,
             "give a positive limit, or leave it out if there is none");
  };
  positive(limits.velocity, "velocity");
  positive(limits.acceleration, "acceleration");
  positive(limits.effort, "effort");
}

/// Names of the types that `counts`, each once.
template <class Counts>
std::string type_names(const Counts& counts) {
  std::string names;
  for_each_robot_type([&](auto type) {
    const std::string name = decltype(type)::kName;
    if (!counts(type) || (", " + names + ",").find(", " + name + ",") != std::string::npos) return;
    names += (names.empty() ? "" : ", ") + name;
  });
  return names;
}

}  // namespace

DriveLimits::DriveLimits()
    : lower(-kInfinity), upper(kInfinity), velocity(kInfinity), acceleration(kInfinity), effort(kInfinity) {}

std::string robot_type_names() {
  return type_names([](auto) { return true; });
}

std::string articulated_type_names() {
  return type_names([](auto type) { return decltype(type)::kPlateTurns; });
}

bool RobotDescription::limbs_are_alike() const {
  constexpr double kAlike = 1e-6;  // of a length
  return std::ranges::all_of(limbs, [&](const LimbGeometry<double>& limb) {
    const auto alike = [](double one, double other) { return std::abs(one - other) <= kAlike * std::abs(other); };
    return alike(limb.strut, limbs.front().strut) && alike(limb.p_DE_0.norm(), limbs.front().p_DE_0.norm());
  });
}

void RobotDescription::set_plate(const PlateShape& shape) {
  plate = shape;
  parts = with_robot_type(*this, [&](auto robot_type) -> std::vector<PlatePart<double>> {
    using R = decltype(robot_type);
    if constexpr (R::kPlateTurns) {
      PlatePart<double> placed[R::kPlateParts];
      R::place_parts(shape, placed);
      return {std::begin(placed), std::end(placed)};
    } else {
      refuse(fmt::format("the plate of a {} is one part", type), name, "use one of " + articulated_type_names());
    }
  });
}

void RobotDescription::validate(const std::string& where) const {
  const TypeRule rule = rule_of(*this, where);
  if (limbs.size() != rule.limbs)
    refuse(fmt::format("a robot of type {} has {} limb{}, but this one has {}", type, rule.limbs,
                       rule.limbs == 1 ? "" : "s", limbs.size()),
           where, "check the drives that hang on the base");
  if (parts.size() != rule.parts)
    refuse(fmt::format("the plate of a {} has {} part{}, but this one has {}", type, rule.parts,
                       rule.parts == 1 ? "" : "s", parts.size()),
           where, "make the plate by set_plate()");
  if (plate.has_value() != rule.turns)
    refuse(fmt::format("the plate of a {} {}", type,
                       rule.turns ? "is articulated, and its lengths are missing" : "is one part"),
           where, rule.turns ? "give the lengths of the plate" : "leave out the lengths of an articulated plate");
  if (telescope.has_value() != rule.telescope)
    refuse(fmt::format("a {} has {} telescope bar", type, rule.telescope ? "a" : "no"), where,
           "delta4 is the type with a telescope bar");
  if (telescope) {
    require_finite(telescope->p_WU, "telescope: the upper joint", where);
    require_finite(telescope->p_BV, "telescope: the lower joint", where);
  }
  if (limits.size() != limbs.size() + (telescope ? 1U : 0U))
    refuse(fmt::format("{} drives, but limits for {}", limbs.size() + (telescope ? 1U : 0U), limits.size()), where,
           "give one set of limits for each drive");
  require_finite(gravity, "gravity", where);
  for (std::size_t i = 0; i < limbs.size(); ++i) validate_limb(limbs[i], i + 1, rule.parts > 0, drive_kind, where);
  for (std::size_t i = 0; i < limits.size(); ++i) validate_limits(limits[i], i + 1, where);
  if (rule.turns) {
    articulated_plate::validate(*this, where);
  } else if (rule.parts > 0) {
    const PlatePart<double>& part = parts.front();
    // All coefficients at once: NaN fails the comparison, too.
    if (!(part.c.norm() + part.a.norm() + part.b.norm() + std::abs(part.kappa) + std::abs(part.turn) <= 0))
      refuse(fmt::format("the plate of a {} neither turns nor has an offset of its own", type), where,
             "put the offset into the attachments of the limbs");
    for (std::size_t i = 0; i < limbs.size(); ++i)
      if (limbs[i].part != 0)
        refuse(fmt::format("limb {}: there is no plate part {}", i + 1, limbs[i].part), where,
               "the plate of a Delta has one part, 0");
    if (largest_angle_between_limbs(limbs, 0) < kParallel)
      refuse("all parallelograms lie in the same direction, so the plate could turn", where,
             "give the limbs different azimuths, e.g. 0, 120 and 240 degrees");
  }
  plausibility::require_geometry(*this, where);
  for (int i = 0; i < drives(); ++i) plausibility::require_limits(*this, i, limits[static_cast<std::size_t>(i)], where);
}

}  // namespace deltadyn
