#pragma once

/// \file
/// A URDF + URDF+ file as bodies, moving joints and loops: links that fixed joints hold together are one body.

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn::robot_file {

using Pose = Eigen::Isometry3d;

struct Joint {
  std::string name;
  int line = 0;
  bool prismatic = false;        ///< else revolute or continuous
  int parent = -1;               ///< body
  int child = -1;                ///< body
  Pose X_PJ = Pose::Identity();  ///< joint frame in the parent body's frame, at joint position 0 also the child body's frame
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit, in the joint frame
  bool mimic = false;
  DriveLimits limits;
};

struct Body {
  std::string name;         ///< of its first link, whose frame is the body's frame
  std::vector<int> joints;  ///< moving joints to its children
  std::vector<std::string> links;
};

struct LinkPlace {
  int body = -1;
  Pose X_BL = Pose::Identity();  ///< link frame in the body's frame
};

struct LoopEnd {
  std::string link;
  Pose X_LO = Pose::Identity();  ///< origin of the loop joint in the link's frame
};

struct Loop {
  std::string name, type;
  int line = 0;
  LoopEnd predecessor, successor;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
};

/// One `<drive>` of the `<deltadyn>` element; attributes as written.
struct DriveNote {
  int line = 0;
  std::map<std::string, std::string> attributes;
};

struct UrdfTree {
  std::string name;
  std::string where;         ///< of the file, for messages
  std::vector<Body> bodies;  ///< body 0 is the base
  std::vector<Joint> joints;
  std::map<std::string, LinkPlace> links;
  std::vector<Loop> loops;
  std::string declared_type;  ///< of the `<deltadyn>` element, empty if there is none
  int extension_line = 0;
  Eigen::Vector3d gravity = Eigen::Vector3d(0, 0, -9.81);
  std::vector<DriveNote> drives;
};

/// Throws deltadyn::Error with the line if the file is not well-formed URDF or URDF+.
[[nodiscard]] UrdfTree parse_urdf_tree(const std::string& text, const std::string& where);

/// A finite number, or throws deltadyn::Error that names the attribute.
[[nodiscard]] double parse_number(const std::string& text, const std::string& where, const std::string& attribute);

}  // namespace deltadyn::robot_file
