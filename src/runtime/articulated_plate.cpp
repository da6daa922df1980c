#include "deltadyn/runtime/articulated_plate.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "deltadyn/kinematics/posture.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/geometry_of.hpp"
#include "deltadyn/runtime/plausibility.hpp"

namespace deltadyn {

double largest_angle_between_limbs(const std::vector<LimbGeometry<double>>& limbs, int part) {
  double largest = 0;
  for (const auto& one : limbs)
    for (const auto& other : limbs)
      if (one.part == part && other.part == part)
        largest = std::max(largest, limb_frame(one).col(1).cross(limb_frame(other).col(1)).norm());
  return largest;
}

double widest_gap(const std::vector<LimbGeometry<double>>& limbs) {
  std::vector<double> azimuths;
  for (const auto& limb : limbs) azimuths.push_back(std::remainder(limb.azimuth, 2 * std::numbers::pi));
  std::ranges::sort(azimuths);
  double widest = azimuths.front() + 2 * std::numbers::pi - azimuths.back();
  for (std::size_t i = 1; i < azimuths.size(); ++i) widest = std::max(widest, azimuths[i] - azimuths[i - 1]);
  return widest;
}

namespace articulated_plate {
namespace {

constexpr double kOneSide = 1.2 * std::numbers::pi;  // gap between neighbours; a real H4 has one of 180 deg

constexpr double kHingeRange = 1.4;  // [rad] beyond it the bars and halves of a hinged plate lie on one another

[[noreturn]] void refuse(const std::string& what, const std::string& where, const std::string& mend) {
  throw Error(what, where, mend);
}

void require_length(double length, const char* what, const std::string& where) {
  if (!(length > 0))
    refuse(fmt::format("plate: the {} is {} m, but must be positive", what, length), where, "give it in metres");
  plausibility::require(plausibility::kLength, length, fmt::format("plate: the {}", what), where);
}

/// The lengths of the plate itself.
/// \param usual  of its type: which lengths it needs
/// \param geared     the tool may have a gear
/// \param on_a_half  its axis may stand on a half
void require_shape(const PlateShape& shape, const PlateShape& usual, bool geared, bool on_a_half,
                   const std::string& where) {
  if (!std::isfinite(shape.azimuth)) refuse("plate: the azimuth is not finite", where, "give an angle in radians");
  plausibility::require(plausibility::kAzimuth, shape.azimuth, "plate: the azimuth", where);
  const auto need = [&](double PlateShape::*length, const char* what) {
    if (std::isnan(usual.*length)) {
      require_length(shape.*length, what, where);
    } else if (shape.*length != 0) {
      refuse(fmt::format("plate: the {} is {} m, but this type has none", what, shape.*length), where, "leave it out");
    }
  };
  need(&PlateShape::spacing, "distance between the hinges of the two halves");
  need(&PlateShape::bar_spacing, "distance between the two bars");
  need(&PlateShape::pinion_radius, "radius of the pinion");
  if (!on_a_half && shape.tool == ToolPlace::half_plate)
    refuse("plate: the tool of this type stands in the plate's centre, not on a half", where,
           "leave out tool=\"half_plate\" (--tool-on)");
  if (!geared && shape.ratio != 1)
    refuse(fmt::format("plate: the tool sits on the pinion, but the ratio of its gear is {}", shape.ratio), where,
           "leave the ratio out, and choose the radius of the pinion");
  if (!(std::isfinite(shape.ratio) && shape.ratio != 0))
    refuse(
        fmt::format("plate: the ratio of the tool's gear is {}", shape.ratio), where,
        "give the turns of the tool for a turn of the plate, e.g. 1 without gear, 4 for a usual Par4; negative if the "
        "gear reverses");
  plausibility::require(plausibility::kGearRatio, std::abs(shape.ratio), "plate: the ratio of the tool's gear", where);
  if (!(shape.range > 0))
    refuse(fmt::format("plate: the range of theta is {} rad", shape.range), where, "give a positive angle in radians");
  plausibility::require(plausibility::kPlateTurn, shape.range, "plate: the range of theta", where);
  if (std::isnan(usual.spacing) && shape.range > kHingeRange)
    refuse(fmt::format("plate: at theta = {:.4g} rad the parts of the plate collide: its hinges reach {} rad to either "
                       "side at most",
                       shape.range, kHingeRange),
           where, "give a smaller range; a gear turns the tool farther");
}

/// Which limb is on which half: two on each, and each pair locks its half.
void validate_limbs(const RobotDescription& robot, const std::string& where) {
  if (widest_gap(robot.limbs) > kOneSide)
    refuse("all limbs stand on one side of the plate, which then nothing holds", where,
           "spread them around it, so that neighbours are no more than 180 deg apart");
  for (std::size_t i = 0; i < robot.limbs.size(); ++i)
    if (robot.limbs[i].part != 0 && robot.limbs[i].part != 1)
      refuse(fmt::format("limb {} does not end on a half plate; two parallelograms hold a part level, but a part that "
                         "turns needs none",
                         i + 1),
             where, "let every limb end on half plate 1 or 2");
  for (const int half : {0, 1}) {
    const auto on_half = std::ranges::count(robot.limbs, half, &LimbGeometry<double>::part);
    if (on_half != 2)
      refuse(fmt::format("{} limb{} on half plate {}, but two limbs hold each half", on_half, on_half == 1 ? "" : "s",
                         half + 1),
             where, "let limbs 1 and 2 end on half plate 1, limbs 3 and 4 on half plate 2");
    if (largest_angle_between_limbs(robot.limbs, half) < kParallel)
      refuse(fmt::format("the two parallelograms on half plate {} lie in the same direction, so the half could turn",
                         half + 1),
             where, "give the two limbs different azimuths");
  }
}

/// The plate beside the struts that hold it, and each half on the side of its limbs, with its attachments.
void require_one_size(const RobotDescription& robot, const std::string& where) {
  const PlateShape& shape = *robot.plate;
  const double strut = std::ranges::max(robot.limbs, {}, &LimbGeometry<double>::strut).strut;
  const double largest = std::max({shape.spacing, shape.bar_spacing, 2 * shape.pinion_radius * shape.range});
  if (largest > strut)
    refuse(fmt::format("plate: a length or travel of {:.4g} m does not go with struts of {:.4g} m", largest, strut),
           where,
           "give all lengths in metres; the halves of an i4 travel by the pinion's radius times the range of theta");
  for (const int half : {0, 1}) {
    const Vector3<double> origin = part_pose(robot.parts[static_cast<std::size_t>(half)], 0.0, 1.0).p.value;
    Vector3<double> side = Vector3<double>::Zero(), ends = side;
    for (const auto& limb : robot.limbs) {
      if (limb.part != half) continue;
      side += limb_frame(limb).col(0);
      ends += origin + limb.p_BA;
    }
    if (ends.dot(shape.outwards()) * (half == 0 ? 1 : -1) < -1e-9)
      refuse(
          fmt::format("the attachments on half plate {} lie on the side of the other half, so the halves would cross",
                      half + 1),
          where, "give the attachments in the order of the limbs: those of 1 and 2 on the side of half plate 1");
    if (side.dot(shape.outwards()) * (half == 0 ? 1 : -1) < 0)
      refuse(
          fmt::format("half plate {} lies on the other side of the plate than its limbs, so the halves would cross",
                      half + 1),
          where,
          "turn the plate's azimuth by 180 deg, or number the limbs so that 1 and 2 stand on the side of half plate 1");
  }
}

/// Rows (u, u . dA/dtheta) with struts that reach straight from each drive to its attachment, at any height: if they
/// are dependent at all of them, the limbs do not hold theta anywhere.
void require_theta_held(const RobotDescription& robot, const std::string& where) {
  constexpr double kHeld = 1e-3;
  double most = 0;
  for (const double height : {0.3, 0.5, 0.8}) {
    Eigen::Matrix4d rows;
    for (int i = 0; i < 4; ++i) {
      const LimbGeometry<double>& limb = robot.limbs[static_cast<std::size_t>(i)];
      const PartPose<double> part = part_pose(robot.parts[static_cast<std::size_t>(limb.part)], 0.0, 1.0);
      const Vector3<double> radial = limb_frame(limb).col(0);
      const Vector3<double> u = Vector3<double>(-radial.x(), -radial.y(), -height).normalized();
      rows.row(i) << u.transpose(), u.dot(part.p.first) / part.p.first.norm();
    }
    most = std::max(most, std::abs(rows.determinant()));
  }
  if (most < kHeld)
    refuse("the limbs do not hold the plate's turn: the two limbs of each half push it along the same line", where,
           "set the half plates so that half plate 1 points towards limbs 1 and 2 (the plate's azimuth is the mean of "
           "theirs)");
}

}  // namespace

void validate_shape(const RobotDescription& robot, const std::string& where) {
  with_robot_type(robot, [&](auto type) {
    using R = decltype(type);
    if constexpr (R::kPlateTurns) require_shape(*robot.plate, R::usual(), R::kGeared, R::kToolOnAHalf, where);
  });
}

void validate(const RobotDescription& robot, const std::string& where) {
  validate_shape(robot, where);
  validate_limbs(robot, where);
  require_one_size(robot, where);
  require_theta_held(robot, where);
}

}  // namespace articulated_plate
}  // namespace deltadyn
