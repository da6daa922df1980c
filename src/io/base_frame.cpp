#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "urdf_tree.hpp"

namespace deltadyn::robot_file {
namespace {

using Vec = Eigen::Vector3d;

constexpr double kTolerance = 1e-6;  // [rad], as the reader's

/// The fourth drive of a delta4 turns about z of its own frame.
bool turns_the_telescope(const Joint& drive, std::size_t drives) {
  return drives > 1 && !drive.prismatic && std::abs(drive.axis.z()) > 0.5;
}

/// True if every limb's frame is turned about z of `X_RW` only (and then about its own x, if `may_tilt`), and the
/// telescope's not at all: the rules of a base frame.
bool is_base_frame(const Pose& X_RW, const std::vector<const Joint*>& drives, bool may_tilt = false) {
  return std::ranges::all_of(drives, [&](const Joint* drive) {
    const Eigen::Matrix3d R = X_RW.linear().transpose() * drive->X_PJ.linear();
    if (turns_the_telescope(*drive, drives.size())) return (R - Eigen::Matrix3d::Identity()).norm() < kTolerance;
    if (may_tilt) return std::abs(R(2, 0)) < kTolerance && R(2, 2) > 0;
    return (R.col(2) - Vec::UnitZ()).norm() < kTolerance;
  });
}

/// The link and all that it is fixed to, up to the root.
std::vector<std::string> way_up(const UrdfTree& tree, const std::string& link) {
  std::vector<std::string> way;
  for (std::string at = link; !at.empty(); at = tree.links.at(at).parent) way.push_back(at);
  return way;
}

/// Links of the base that carry all drives, the one nearest to them first.
std::vector<std::string> carriers(const UrdfTree& tree, const std::vector<const Joint*>& drives) {
  std::vector<std::string> common = way_up(tree, drives.front()->parent_link);
  for (const Joint* drive : drives) {
    const std::vector<std::string> way = way_up(tree, drive->parent_link);
    std::erase_if(common, [&](const std::string& link) { return std::ranges::find(way, link) == way.end(); });
  }
  return common;
}

/// In the middle of the limbs' drives, turned as the telescope's drive or else as the first one.
Pose frame_of_drives(const std::vector<const Joint*>& drives) {
  Pose X_RW = drives.front()->X_PJ;
  Vec sum = Vec::Zero();
  int limbs = 0;
  for (const Joint* drive : drives) {
    if (turns_the_telescope(*drive, drives.size())) {
      X_RW.linear() = drive->X_PJ.linear();
    } else {
      sum += drive->X_PJ.translation();
      ++limbs;
    }
  }
  if (limbs > 0) X_RW.translation() = sum / limbs;
  return X_RW;
}

}  // namespace

void place_base(UrdfTree& tree) {
  std::vector<const Joint*> drives;
  for (const int index : tree.bodies[0].joints) drives.push_back(&tree.joint(index));
  if (drives.empty()) return;  // the reader refuses it in its own words
  Pose X_RW = Pose::Identity();
  bool found = false;
  for (const std::string& link : carriers(tree, drives)) {
    if (!is_base_frame(tree.links.at(link).X_BL, drives)) continue;
    X_RW = tree.links.at(link).X_BL;
    found = true;
    break;
  }
  if (!found) {
    const Pose made = frame_of_drives(drives);
    if (is_base_frame(made, drives)) {
      X_RW = made;
    } else if (drives.size() > 1) {  // else the reader names the joint that is turned wrongly
      for (const std::string& link : carriers(tree, drives)) {
        if (!is_base_frame(tree.links.at(link).X_BL, drives, true)) continue;
        X_RW = tree.links.at(link).X_BL;
        break;
      }
    }
  }
  if (X_RW.matrix() == Pose::Identity().matrix()) return;
  const Pose X_WR = X_RW.inverse();
  for (Joint& joint : tree.joints)
    if (joint.parent == 0) joint.X_PJ = X_WR * joint.X_PJ;
  for (const std::string& link : tree.bodies[0].links) tree.links.at(link).X_BL = X_WR * tree.links.at(link).X_BL;
  const double size = tree.gravity.norm();
  tree.gravity = X_WR.linear() * tree.gravity;
  // Half a turn written with sixteen digits leaves 1e-16 of gravity across; what nobody meant is not shown.
  for (double& entry : tree.gravity)
    if (std::abs(entry) < 1e-12 * size) entry = 0;
}

}  // namespace deltadyn::robot_file
