#include "deltadyn/runtime/plate_hold.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "deltadyn/kinematics/forward.hpp"
#include "deltadyn/runtime/geometry_of.hpp"

namespace deltadyn {
namespace {

/// The axis that two limbs leave a half to tip about, times the sine of their normals' angle.
template <class Posture>
Vector3<double> tipping_axis(const Posture& posture, int first, int second) {
  const auto normal = [&posture](int i) {
    const auto& limb = posture.limbs[i];
    return Vector3<double>(limb.R_WL * Vector3<double>::UnitY().cross(limb.u));
  };
  return normal(first).cross(normal(second));
}

}  // namespace

double tipping_margin(const RobotDescription& robot, const Eigen::VectorXd& q) {
  return with_robot_type(robot, [&](auto type) {
    using R = decltype(type);
    if constexpr (R::kPlateTurns) {
      if (!halves_turn_apart<R>()) return 1.0;
      Posture<double, R> posture;
      if (posture_from_drives<double, R>(geometry_of<double, R>(robot), q, posture) != Status::ok)
        throw Error("the pose is out of reach or singular", robot.name, "check the lengths in the robot file");
      int limbs[2][2], found[2] = {0, 0};
      for (int i = 0; i < R::kLimbs; ++i) {
        const int half = robot.limbs[static_cast<std::size_t>(i)].part;
        limbs[half][found[half]++] = i;
      }
      const Eigen::Vector2d one = tipping_axis(posture, limbs[0][0], limbs[0][1]).template head<2>();
      const Eigen::Vector2d other = tipping_axis(posture, limbs[1][0], limbs[1][1]).template head<2>();
      const double sizes = one.norm() * other.norm();
      return sizes > 0 ? std::abs(one.x() * other.y() - one.y() * other.x()) / sizes : 0.0;
    } else {
      return 1.0;
    }
  });
}

}  // namespace deltadyn
