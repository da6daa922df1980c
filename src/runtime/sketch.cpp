#include "deltadyn/runtime/sketch.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "deltadyn/model/geometry.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

using Vec = Eigen::Vector3d;

/// The halves from their hinges to the limbs, and from hinge to hinge what joins them.
void add_articulated_plate(const RobotDescription& robot, const LinkPoses& at, SketchLines& halves, SketchLines& bars) {
  for (std::size_t i = 0; i < robot.limbs.size(); ++i)
    halves.lines.emplace_back(at.parts[static_cast<std::size_t>(robot.limbs[i].part)].place, at.limbs[i].plate);
  const double radius = robot.plate->pinion_radius;
  if (radius > 0) {
    constexpr int kCorners = 24;
    const auto corner = [&](int k) -> Vec {
      const double angle = 6.283185307179586 * k / kCorners;
      return at.plate + radius * Vec(std::cos(angle), std::sin(angle), 0);
    };
    for (int k = 0; k < kCorners; ++k) bars.lines.emplace_back(corner(k), corner(k + 1));
    // The racks, where they touch the pinion
    const Vec out = radius * robot.plate->outwards(), along = robot.plate->range * Vec::UnitZ().cross(out);
    for (const double side : {1.0, -1.0})
      halves.lines.emplace_back(at.plate + side * out - along, at.plate + side * out + along);
    return;
  }
  const Vec side = Vec::UnitZ().cross(robot.plate->outwards()) * robot.plate->bar_spacing / 2;
  for (const double sign : {1.0, -1.0})
    bars.lines.emplace_back(at.parts[0].place + sign * side, at.parts[1].place + sign * side);
}

/// The drives' places in the order in which they stand around the base.
std::vector<Vec> around(const std::vector<LimbGeometry<double>>& limbs) {
  Vec middle = Vec::Zero();
  for (const auto& limb : limbs) middle += limb.p_WD / static_cast<double>(limbs.size());
  std::vector<Vec> places;
  for (const auto& limb : limbs) places.push_back(limb.p_WD);
  std::ranges::sort(places, {}, [&](const Vec& p) { return std::atan2(p.y() - middle.y(), p.x() - middle.x()); });
  return places;
}

/// From end to end of the travel; without limits from the drive's zero to the carriage.
std::pair<Vec, Vec> rail_of(const LimbGeometry<double>& limb, const DriveLimits& limits, const Vec& carriage) {
  if (!std::isfinite(limits.lower) || !std::isfinite(limits.upper)) return {limb.p_WD, carriage};
  const Vec axis = limb_frame(limb) * limb.axis_L;
  return {limb.p_WD + limits.lower * axis, limb.p_WD + limits.upper * axis};
}

/// A peg under the plate, and a pointer that shows the yaw. The tool is the last part of the plate.
std::vector<std::pair<Vec, Vec>> tool_of(const RobotDescription& robot, const LinkPoses& at) {
  constexpr double kShare = 0.1;  // of a strut
  const double length = kShare * robot.limbs.front().strut;
  const LinkPoses::PlatePart& tool = at.parts.back();
  const Vec tip = tool.place - length * Vec::UnitZ();
  return {{tool.place, tip}, {tip, tip + 0.5 * length * Vec(std::cos(tool.angle), std::sin(tool.angle), 0)}};
}

}  // namespace

std::vector<SketchLines> sketch_of(const Robot& drawn, const Eigen::VectorXd& q) {
  const RobotDescription& robot = drawn.description();
  LinkPoses at;
  if (drawn.link_poses(q, at) != Status::ok)
    throw Error("the pose to be drawn is out of reach or singular", robot.name, "check the lengths in the robot file");
  const bool rails = robot.drive_kind == DriveKind::prismatic;
  SketchLines base{"base"}, arms{rails ? "rails" : "upper arms"}, struts{"struts"}, plate{"plate"},
      bars{robot.plate && robot.plate->pinion_radius > 0 ? "pinion" : "plate's bars"}, bar{"telescope bar"},
      tool{"tool"};
  const std::vector<Vec> corners = around(robot.limbs);
  for (std::size_t i = 0; corners.size() > 1 && i < corners.size(); ++i)
    base.lines.emplace_back(corners[i], corners[(i + 1) % corners.size()]);
  for (std::size_t i = 0; i < robot.limbs.size(); ++i) {
    const LimbGeometry<double>& limb = robot.limbs[i];
    const LinkPoses::Limb& pose = at.limbs[i];
    const auto [from, to] = rails ? rail_of(limb, robot.limits[i], pose.elbow) : std::pair(limb.p_WD, pose.elbow);
    arms.lines.emplace_back(from, to);
    if (robot.parts.empty()) continue;
    const Vec across = 0.5 * limb.strut_spacing * pose.R_WL.col(1);
    for (const double side : {1.0, -1.0})
      struts.lines.emplace_back(pose.elbow + side * across, pose.plate + side * across);
    // The ends of a parallelogram, which make it one to the eye; of a carriage the one on its rail
    arms.lines.emplace_back(pose.elbow - across, pose.elbow + across);
    plate.lines.emplace_back(pose.plate - across, pose.plate + across);
    if (!robot.plate) plate.lines.emplace_back(at.plate, pose.plate);
  }
  if (robot.plate) {
    add_articulated_plate(robot, at, plate, bars);
    tool.lines = tool_of(robot, at);
  }
  if (robot.telescope) bar.lines.emplace_back(robot.telescope->p_WU, at.plate + robot.telescope->p_BV);
  std::vector<SketchLines> all;
  for (SketchLines* one : {&base, &arms, &struts, &plate, &bars, &bar, &tool})
    if (!one->lines.empty()) all.push_back(std::move(*one));
  return all;
}

}  // namespace deltadyn
