#include "plate_tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/format.h>
#include <iterator>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/geometry_of.hpp"

namespace deltadyn::robot_file {
namespace {

using Vec = Vector3<double>;

/// What each part is, in order.
std::vector<deltadyn::Body> parts_of(const RobotDescription& robot) {
  return with_robot_type(robot, [](auto type) -> std::vector<deltadyn::Body> {
    using R = decltype(type);
    return {std::begin(R::kParts), std::end(R::kParts)};
  });
}

/// A number follows where there are several of a kind.
std::string body_name(const std::vector<deltadyn::Body>& parts, std::size_t part) {
  const auto before = std::count(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(part), parts[part]);
  const bool several = std::ranges::count(parts, parts[part]) > 1;
  return deltadyn::name(parts[part]) + (several ? std::to_string(before + 1) : "");
}

}  // namespace

std::vector<PlateBody> plate_bodies(const RobotDescription& robot) {
  const std::vector<deltadyn::Body> parts = parts_of(robot);
  const PlatePart<double>& root = robot.parts.front();
  const Eigen::Matrix3d R_1W = Eigen::AngleAxisd(-root.turn, Vec::UnitZ()).toRotationMatrix();
  std::vector<PlateBody> bodies;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const PlatePart<double>& part = robot.parts[k];
    PlateBody body;
    body.part = static_cast<int>(k);
    body.name = body_name(parts, k);
    body.shared = deltadyn::name(parts[k]);
    body.turn = part.turn - root.turn;
    const Vec turning = part.a - root.a, sliding = part.b - root.b;
    body.first = R_1W * (part.c - root.c);
    body.origin = body.first + R_1W * turning;
    const bool swings = turning.norm() > 0;
    if (swings) body.swing = {.name = body.name + "_swing", .gain = 1};
    if (sliding.norm() > 0) {
      body.swing = {
          .name = body.name + "_slide", .slides = true, .gain = sliding.norm(), .along = R_1W * sliding.normalized()};
    }
    body.level = {.name = body.name + "_turn", .gain = part.kappa - root.kappa - (swings ? 1 : 0)};
    bodies.push_back(std::move(body));
  }
  return bodies;
}

std::string theta_joint(const std::vector<PlateBody>& bodies) {
  for (const PlateBody& body : bodies)
    for (const PlateJoint* joint : {&body.swing, &body.level})
      if (!joint->slides && joint->gain == 1) return joint->name;
  throw Error("no joint of the plate turns by theta", "plate", "give one part a turn of 1");
}

std::string plate_link(const RobotDescription& robot, const LimbGeometry<double>& limb) {
  return robot.plate ? body_name(parts_of(robot), static_cast<std::size_t>(limb.part))
                     : deltadyn::name(deltadyn::Body::platform);
}

Vec on_plate_link(const RobotDescription& robot, const LimbGeometry<double>& limb, const Vec& p_BA) {
  const double turn = robot.parts[static_cast<std::size_t>(limb.part)].turn;
  return turn == 0 ? p_BA : Vec(Eigen::AngleAxisd(-turn, Vec::UnitZ()) * p_BA);
}

}  // namespace deltadyn::robot_file
