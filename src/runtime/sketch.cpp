#include "deltadyn/runtime/sketch.hpp"

#include <cmath>

#include "deltadyn/kinematics/forward.hpp"
#include "deltadyn/runtime/geometry_of.hpp"

namespace deltadyn {
namespace {

using Vec = Eigen::Vector3d;

/// Where the limbs are, whatever the type.
struct LimbPlaces {
  std::vector<Vec> elbow, plate, across;  ///< `across`: half the distance of the two struts
  Vec centre = Vec::Zero();
  std::vector<PartPose<double>> parts;
};

LimbPlaces places_of(const RobotDescription& robot, const Eigen::VectorXd& q) {
  return with_robot_type(robot, [&](auto type) {
    using R = decltype(type);
    const auto geometry = geometry_of<double, R>(robot);
    Posture<double, R> posture;
    if (posture_from_drives<double, R>(geometry, q, posture) != Status::ok)
      throw Error("the pose to be drawn is out of reach or singular", robot.name,
                  "check the lengths in the robot file");
    LimbPlaces places;
    for (int i = 0; i < R::kLimbs; ++i) {
      const auto& limb = posture.limbs[i];
      places.elbow.push_back(geometry.limbs[i].p_WD + limb.R_WL * limb.p_DE.value);
      if constexpr (kHasPlate<R>) {
        places.centre = posture.z.template head<3>();
        places.plate.push_back(places.centre + limb.R_WL * limb.p_BA.value);
        places.across.push_back(0.5 * geometry.limbs[i].strut_spacing * limb.R_WL.col(1));
      }
    }
    if constexpr (R::kPlateTurns)
      for (const auto& part : geometry.parts) places.parts.push_back(part_pose(part, posture.z(3), geometry.yaw_ratio));
    return places;
  });
}

/// The halves from their hinges to the limbs, and from hinge to hinge what joins them.
void add_articulated_plate(const RobotDescription& robot, const LimbPlaces& at, SketchLines& halves,
                           SketchLines& bars) {
  for (std::size_t i = 0; i < robot.limbs.size(); ++i)
    halves.lines.emplace_back(at.centre + at.parts[static_cast<std::size_t>(robot.limbs[i].part)].p.value, at.plate[i]);
  const double radius = robot.plate->pinion_radius;
  if (radius > 0) {
    constexpr int kCorners = 24;
    const auto corner = [&](int k) -> Vec {
      const double angle = 6.283185307179586 * k / kCorners;
      return at.centre + radius * Vec(std::cos(angle), std::sin(angle), 0);
    };
    for (int k = 0; k < kCorners; ++k) bars.lines.emplace_back(corner(k), corner(k + 1));
    // The racks, where they touch the pinion
    const Vec out = radius * robot.plate->outwards(), along = robot.plate->range * cross_z<double>(out);
    for (const double side : {1.0, -1.0})
      halves.lines.emplace_back(at.centre + side * out - along, at.centre + side * out + along);
    return;
  }
  const Vec first = at.parts[0].p.value, second = at.parts[1].p.value;
  const Vec side = cross_z<double>(robot.plate->outwards()) * robot.plate->bar_spacing / 2;
  for (const double sign : {1.0, -1.0})
    bars.lines.emplace_back(at.centre + first + sign * side, at.centre + second + sign * side);
}

}  // namespace

std::vector<SketchLines> sketch_of(const RobotDescription& robot, const Eigen::VectorXd& q) {
  const LimbPlaces at = places_of(robot, q);
  const bool rails = robot.drive_kind == DriveKind::prismatic;
  SketchLines base{"base"}, arms{rails ? "rails" : "upper arms"}, struts{"struts"}, plate{"plate"},
      bars{robot.plate && robot.plate->pinion_radius > 0 ? "pinion" : "plate's bars"}, bar{"telescope bar"};
  const std::size_t limbs = robot.limbs.size();
  for (std::size_t i = 0; i < limbs; ++i) {
    const LimbGeometry<double>& limb = robot.limbs[i];
    if (limbs > 1) base.lines.emplace_back(limb.p_WD, robot.limbs[(i + 1) % limbs].p_WD);
    arms.lines.emplace_back(limb.p_WD, at.elbow[i]);
    if (at.plate.empty()) continue;
    for (const double side : {1.0, -1.0})
      struts.lines.emplace_back(at.elbow[i] + side * at.across[i], at.plate[i] + side * at.across[i]);
    // The ends of a parallelogram, which make it one to the eye
    arms.lines.emplace_back(at.elbow[i] - at.across[i], at.elbow[i] + at.across[i]);
    plate.lines.emplace_back(at.plate[i] - at.across[i], at.plate[i] + at.across[i]);
    if (!robot.plate) plate.lines.emplace_back(at.centre, at.plate[i]);
  }
  if (robot.plate) add_articulated_plate(robot, at, plate, bars);
  if (robot.telescope) bar.lines.emplace_back(robot.telescope->p_WU, at.centre + robot.telescope->p_BV);
  std::vector<SketchLines> all;
  for (SketchLines* one : {&base, &arms, &struts, &plate, &bars, &bar})
    if (!one->lines.empty()) all.push_back(std::move(*one));
  return all;
}

}  // namespace deltadyn
