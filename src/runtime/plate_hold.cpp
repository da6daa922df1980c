#include "deltadyn/runtime/plate_hold.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "deltadyn/model/topology.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/geometry_of.hpp"

namespace deltadyn {
namespace {

/// The axis that two limbs leave a half to tip about, times the sine of their normals' angle.
Eigen::Vector3d tipping_axis(const LinkPoses& at, std::size_t first, std::size_t second) {
  const auto normal = [&at](std::size_t i) -> Eigen::Vector3d {
    return at.limbs[i].R_WL.col(1).cross(at.limbs[i].strut);
  };
  return normal(first).cross(normal(second));
}

}  // namespace

double tipping_margin(const Robot& robot, const Eigen::VectorXd& q) {
  const RobotDescription& description = robot.description();
  const bool apart = with_robot_type(description, [](auto type) { return halves_turn_apart<decltype(type)>(); });
  if (!apart) return 1.0;
  LinkPoses at;
  if (robot.link_poses(q, at) != Status::ok)
    throw Error("the pose is out of reach or singular", description.name, "check the lengths in the robot file");
  std::size_t limbs[2][2] = {}, found[2] = {0, 0};
  for (std::size_t i = 0; i < description.limbs.size(); ++i) {
    const int half = description.limbs[i].part;
    limbs[half][found[half]++] = i;
  }
  const Eigen::Vector2d one = tipping_axis(at, limbs[0][0], limbs[0][1]).head<2>();
  const Eigen::Vector2d other = tipping_axis(at, limbs[1][0], limbs[1][1]).head<2>();
  const double sizes = one.norm() * other.norm();
  return sizes > 0 ? std::abs(one.x() * other.y() - one.y() * other.x()) / sizes : 0.0;
}

}  // namespace deltadyn
