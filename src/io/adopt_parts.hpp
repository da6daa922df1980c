#pragma once

/// \file
/// The parts of a Delta in the tree of a CAD program, found by structure. All points are in the root link's frame, in
/// the pose in which all joints are zero.

#include <optional>
#include <string>
#include <vector>

#include "deltadyn/io/adopt.hpp"

#include "urdf_tree.hpp"

namespace deltadyn::cad {

using robot_file::Joint;
using robot_file::Pose;
using robot_file::refuse;
using robot_file::UrdfTree;
using Vec = Eigen::Vector3d;

constexpr double kPoint =
    // [m] joints nearer than this are one ball or universal joint; CAD files have 4 to 6 digits, parts hang ten joints
    // deep
    5e-4;

struct Strut {
  std::string name;         ///< link
  std::vector<int> bodies;  ///< from the elbow on; the last is the rod itself
  Vec elbow = Vec::Zero();
  Vec first_axis = Vec::Zero();  ///< of the joint at the elbow
  std::optional<Vec> end;        ///< where the plate hangs on it, or a frame at its end
  std::optional<Vec> direction;  ///< unit, from the elbow through the centre of mass
};

struct Limb {
  const Joint* drive = nullptr;
  Vec axis = Vec::Zero(), place = Vec::Zero();  ///< of the drive's joint
  std::vector<int> arm;                         ///< bodies that move with the drive only
  std::vector<Strut> struts;                    ///< one or two
};

struct Telescope {
  const Joint* drive = nullptr;
  Vec axis = Vec::Zero(), place = Vec::Zero();
  std::vector<int> yoke, upper, lower, tool;  ///< bodies
  Vec upper_joint = Vec::Zero(), lower_joint = Vec::Zero();
};

struct Parts {
  std::vector<Limb> limbs;
  std::optional<Telescope> telescope;
  std::vector<std::string> plate_links;  ///< that move as one with the plate
  std::optional<Vec> plate_place;        ///< origin of the plate's link where no strut carries it
  std::vector<std::string> notes;
};

/// Place of every body in the root link's frame when all joints are zero.
[[nodiscard]] std::vector<Pose> zero_pose(const UrdfTree& tree);

/// Pose of a link in the root link's frame, from the poses of the bodies.
[[nodiscard]] Pose link_pose(const UrdfTree& tree, const std::vector<Pose>& X_R, const std::string& link);

/// Throws deltadyn::Error with link or joint and the rule that failed.
[[nodiscard]] Parts find_parts(const UrdfTree& tree, const AdoptOptions& options);

/// The frame of the robot's base and the geometry in it.
struct Placed {
  RobotDescription robot;
  std::vector<AdoptedDrive> drives;
  Pose X_RW = Pose::Identity();       ///< base frame in the root link's
  Vec plate_centre = Vec::Zero();     ///< in the root link's frame
  std::vector<std::size_t> order;     ///< limb k of the robot is limb order[k] of the parts
  std::vector<Vec> strut_directions;  ///< unit, from elbow to plate as drawn, of the parts' limbs; root link's frame
  std::vector<std::string> notes;
};

[[nodiscard]] Placed place_parts(const UrdfTree& tree, const Parts& parts, const AdoptOptions& options);

/// Inertial parameters by name in the frames of the robot's bodies.
[[nodiscard]] NamedValues inertial_values(const UrdfTree& tree, const Parts& parts, const Placed& placed,
                                          std::vector<std::string>& notes);

}  // namespace deltadyn::cad
