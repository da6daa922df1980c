#include "deltadyn/runtime/reach.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "pose_check.hpp"

namespace deltadyn {
namespace {

/// No pose of the plate is farther from the origin than this in any coordinate.
Eigen::Vector3d bound(const RobotDescription& robot, const Eigen::Vector3d& home) {
  double reach = 0;
  for (std::size_t i = 0; i < robot.limbs.size(); ++i) {
    const auto& limb = robot.limbs[i];
    double length = limb.p_WD.norm() + limb.p_DE_0.norm() + limb.strut + limb.p_BA.norm();
    if (robot.drive_kind == DriveKind::prismatic) {
      // Rails without ends would reach anywhere: look at the neighbourhood of the home pose then.
      const DriveLimits& limits = robot.limits[i];
      const double stroke = std::max(std::abs(limits.lower), std::abs(limits.upper));
      length += std::isfinite(stroke) ? stroke : home.norm();
    }
    reach = std::max(reach, length);
  }
  return Eigen::Vector3d::Constant(reach);
}

}  // namespace

Reach find_reach(const Robot& robot, int cells) {
  const RobotDescription& description = robot.description();
  if (description.parts.empty())
    throw Error("an axis has no plate and so no workspace", description.name, "give a Delta");
  Reach reach;
  reach.home = WorkspaceSampler(robot).ball().centre;
  const Eigen::Vector3d size = bound(description, reach.home);
  reach.cell = 2 * size(0) / cells;
  const Eigen::Vector3d corner = Eigen::Vector3d::Constant(-size(0));
  const auto index = [cells](const Eigen::Vector3i& c) {
    return static_cast<std::size_t>((c.x() * cells + c.y()) * cells + c.z());
  };
  const auto centre = [&](const Eigen::Vector3i& c) -> Eigen::Vector3d {
    return corner + reach.cell * (c.cast<double>().array() + 0.5).matrix();
  };

  // Grow from the home pose through regular cells, so that the mirrored workspace beyond a singular pose is left out.
  PoseCheck check(robot);
  std::vector<char> seen(static_cast<std::size_t>(cells * cells * cells), 0);
  std::vector<Eigen::Vector3i> open, found;
  std::vector<double> conditions;
  const auto visit = [&](const Eigen::Vector3i& c) {
    if ((c.array() < 0).any() || (c.array() >= cells).any() || seen[index(c)] != 0) return;
    seen[index(c)] = 1;
    const double condition = check.condition(centre(c));
    if (!(condition <= kLargestCondition)) return;
    open.push_back(c);
    found.push_back(c);
    conditions.push_back(condition);
  };
  const Eigen::Vector3i home = ((reach.home - corner) / reach.cell).array().floor().cast<int>();
  for (int k = 0; k < 27; ++k) visit(home + Eigen::Vector3i(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1));
  while (!open.empty()) {
    const Eigen::Vector3i c = open.back();
    open.pop_back();
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) visit(c + step * Eigen::Vector3i::Unit(axis));
  }
  if (found.empty())
    throw Error("no pose of the plate is regular and inside the limits of the drives", description.name,
                "check the lengths and the position limits in the robot file");

  const auto count = static_cast<Eigen::Index>(found.size());
  reach.points.resize(count, 3);
  reach.condition = Eigen::Map<Eigen::VectorXd>(conditions.data(), count);
  for (Eigen::Index k = 0; k < count; ++k) reach.points.row(k) = centre(found[static_cast<std::size_t>(k)]).transpose();
  reach.lower = reach.points.colwise().minCoeff().transpose();
  reach.upper = reach.points.colwise().maxCoeff().transpose();
  reach.radius = reach.points.leftCols<2>().rowwise().norm().maxCoeff();
  reach.volume = static_cast<double>(count) * std::pow(reach.cell, 3);
  if (const double range = description.plate_yaw_range(); range > 0) {
    for (const double yaw : {-range, range}) {
      Eigen::Index left = 0;
      for (Eigen::Index k = 0; k < count; ++k)
        left += check.condition(reach.points.row(k).transpose(), yaw) <= kLargestCondition ? 1 : 0;
      reach.share_at_full_turn =
          std::min(reach.share_at_full_turn, static_cast<double>(left) / static_cast<double>(count));
    }
  }
  reach.condition_best = reach.condition.minCoeff();
  reach.condition_median = quantile(conditions, 0.5);
  reach.condition_worst_of_95 = quantile(conditions, 0.95);
  return reach;
}

}  // namespace deltadyn
