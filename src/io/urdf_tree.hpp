#pragma once

/// \file
/// A URDF + URDF+ file as bodies, moving joints and loops: links that fixed joints hold together are one body.

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "deltadyn/model/inertial_parameters.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn::robot_file {

using Pose = Eigen::Isometry3d;

struct Joint {
  std::string name;
  int line = 0;
  std::string parent_link;  ///< as written; one of the links of `parent`
  bool prismatic = false;   ///< else revolute or continuous
  int parent = -1;          ///< body
  int child = -1;           ///< body
  /// Joint frame in the parent body's frame, at joint position 0 also the child body's frame
  Pose X_PJ = Pose::Identity();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit, in the joint frame
  std::string mimics;                               ///< the joint of its <mimic>; empty: none
  double mimic_gain = 0, mimic_offset = 0;
  bool floating = false;  ///< six (or, planar, three) degrees of freedom: holds nothing; CAD trees only
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
  std::string parent;            ///< link that it is fixed to, empty if it is the first of its body
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

/// `<inertial>` of a link, as written.
struct LinkInertial {
  double mass = 0;
  Pose X_LC = Pose::Identity();                   ///< centre of mass and axes of the inertia, in the link's frame
  Eigen::Matrix3d I_C = Eigen::Matrix3d::Zero();  ///< about the centre of mass, in those axes
  /// The ten parameters about the origin of a frame F in which the link stands at X_FL.
  [[nodiscard]] InertialVector<double> in_frame(const Pose& X_FL) const;
};

/// From the ten parameters of a body with mass, in the axes of its frame.
[[nodiscard]] LinkInertial central_inertial(const InertialVector<double>& p);

/// One `<drive>` of the `<deltadyn>` element; attributes as written.
struct DriveNote {
  int line = 0;
  std::string joint;
  std::map<std::string, std::string> attributes;  ///< the others
};

struct UrdfTree {
  std::string name;
  std::string where;         ///< of the file, for messages
  std::vector<Body> bodies;  ///< body 0 is the base
  std::vector<Joint> joints;
  std::map<std::string, LinkPlace> links;
  std::vector<Loop> loops;
  std::map<std::string, LinkInertial> inertials;  ///< of the links that have one
  std::string declared_type;                      ///< of the `<deltadyn>` element, empty if there is none
  int extension_line = 0;
  Eigen::Vector3d gravity = Eigen::Vector3d(0, 0, -9.81);  ///< in the frame of the root link
  std::vector<DriveNote> drives;
  DriveNote plate;  ///< the `<plate>` of the `<deltadyn>` element; line 0 if there is none

  [[nodiscard]] const Body& body(int index) const { return bodies[static_cast<std::size_t>(index)]; }
  [[nodiscard]] const Joint& joint(int index) const { return joints[static_cast<std::size_t>(index)]; }
  /// "cad.urdf, line 12, joint J1", "cad.urdf, link arm".
  [[nodiscard]] std::string at(const Joint& joint) const;
  [[nodiscard]] std::string at(const Loop& loop) const;
  [[nodiscard]] std::string at(const std::string& link) const;
};

/// Throws deltadyn::Error.
[[noreturn]] void refuse(const std::string& what, const std::string& where, const std::string& mend,
                         ExitCode code = ExitCode::bad_input);

/// robot_file: what the tools take. cad: any tree of a CAD program; joints may float or lack limits, and there may be
/// several trees, whose roots are then joined to the largest one by floating joints, in the place that the file's
/// origin gives them.
enum class UrdfDialect { robot_file, cad };

/// Throws deltadyn::Error with the line if the file is not well-formed URDF or URDF+.
[[nodiscard]] UrdfTree parse_urdf_tree(const std::string& text, const std::string& where,
                                       UrdfDialect dialect = UrdfDialect::robot_file);

/// Throws deltadyn::Error with the joint or loop that lies farther from its link than any robot is large: before the
/// rules of mechanisms are looked at, which a file that is partly in millimetres breaks in ways that do not name the
/// reason.
void require_metres(const UrdfTree& tree);

/// Turns the tree from the frame of its root link to that of the robot's base W: gravity and the places of the drives.
/// A base that hangs, leans or is turned is a link that fixed joints hold against the root ("world"). W is the frame of
/// the last link that carries all drives and against which the limbs are turned about z only; if there is none (drives
/// on brackets of their own below a turned base), W is made from the frames of the drives.
void place_base(UrdfTree& tree);

/// A finite number, or throws deltadyn::Error that names the attribute.
[[nodiscard]] double parse_number(const std::string& text, const std::string& where, const std::string& attribute);

}  // namespace deltadyn::robot_file
