#pragma once

/// \file
/// The steps from the tree of a CAD program to a Delta: its parts, found by structure, how the limbs end on the plate,
/// the base's frame with the geometry in it, masses. All points are in the root link's frame, in
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
  std::vector<Pose> X_R;  ///< of every body in the root link's frame when all joints are zero
  std::vector<Limb> limbs;
  std::optional<Telescope> telescope;
  std::vector<std::string> plate_links;  ///< that move as one with the plate
  std::optional<Vec> plate_place;        ///< origin of the plate's link where no strut carries it
  std::vector<std::string> notes;
};

/// Pose of a link in the root link's frame, from the poses of the bodies.
[[nodiscard]] Pose link_pose(const UrdfTree& tree, const std::vector<Pose>& X_R, const std::string& link);

/// Throws deltadyn::Error with link or joint and the rule that failed.
[[nodiscard]] Parts find_parts(const UrdfTree& tree, const AdoptOptions& options);

/// What is known of the limbs before: all in the root link's frame.
struct LimbPlace {
  Vec elbow = Vec::Zero();     ///< centre between the elbow joints
  Vec outwards = Vec::Zero();  ///< unit, from the robot's middle axis along the limb
  Vec across = Vec::Zero();    ///< unit, along the drive's axis
  double radius = 0;           ///< of the elbow about the middle axis [m]
  Vec drive = Vec::Zero();     ///< point of a revolute axis nearest to the elbow; the elbow of a carriage
  double spacing = 0;          ///< of the two struts [m]
};

struct Attachments {
  std::vector<Vec> offsets;     ///< centre between the ends of a limb's struts from the plate's centre
  std::vector<double> lengths;  ///< of the struts [m]
  std::vector<Vec> directions;  ///< unit, from elbow to plate as the CAD draws them
  Vec plate_centre = Vec::Zero();
  bool assembled = true;  ///< false: the parts do not stand in a pose of the robot, and only lengths could be used
  std::string note;       ///< how they were found, empty if the tree shows them
};

/// The point nearest to the lines that leave `points` at right angles to `across` and `up`, at their mean height: where
/// the limbs of a base or of a plate meet.
/// \param across, up  unit
[[nodiscard]] Vec middle_of(const std::vector<Vec>& points, const std::vector<Vec>& across, const Vec& up);

/// \param up  unit, normal of the base
[[nodiscard]] Attachments find_attachments(const UrdfTree& tree, const Parts& parts, const AdoptOptions& options,
                                           const std::vector<LimbPlace>& limbs, const Vec& up);

/// The robot, and where its parts stand.
struct Placed : AdoptedRobot {
  Pose X_RW = Pose::Identity();    ///< base frame in the root link's
  Attachments ends;                ///< of the parts' limbs, in the root link's frame
  std::vector<std::size_t> order;  ///< limb k of the robot is limb order[k] of the parts
};

/// The frame of the robot's base and the geometry in it.
[[nodiscard]] Placed place_parts(const UrdfTree& tree, const Parts& parts, const AdoptOptions& options);

/// Fills in the inertial parameters, in the frames of the robot's bodies.
void add_masses(const UrdfTree& tree, const Parts& parts, Placed& placed);

}  // namespace deltadyn::cad
