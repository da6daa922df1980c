#pragma once

/// \file
/// Robot files from the URDF that a CAD program writes: any names, any zero pose, any frames, no closed loops.
///
/// Limbs, struts and plate are found by structure, in the pose in which the file's joints are zero, where the parts
/// stand as the CAD has assembled them:
///  - the base carries three drives (and, for a delta4, a fourth whose chain holds one prismatic joint: the telescope
///    bar);
///  - an arm carries one strut or two; joints whose origins coincide are one ball or universal joint;
///  - one strut may carry the plate, or the plate hangs on nothing (a floating joint, a tree of its own, fixed to the
///    base);
///  - ends of struts that the tree does not show are found by, in this order: a frame on the strut's link or a loop of
///    URDF+; the rule that plate and struts of the three limbs are alike; the line from the elbow through the strut's
///    centre of mass.
/// What cannot be found is asked for by the name of the flag; each rule that fails is told with link or joint.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

struct AdoptOptions {
  double length_unit = 1;  ///< metres in one unit of the file's lengths
  double mass_unit = 1;    ///< kilograms in one unit of the file's masses
  /// Joints of the drives, limbs first; empty: found, limbs counter-clockwise from above
  std::vector<std::string> drives;
  std::string plate;                      ///< a link of the plate; empty: found
  std::string plate_frame;                ///< link whose origin is the plate's centre; empty: middle of the attachments
  std::optional<double> strut;            ///< length [m]
  std::optional<double> strut_spacing;    ///< of limbs whose two struts are one link [m]
  std::optional<double> platform_radius;  ///< attachments from the plate's centre [m]
  std::optional<double> gravity_size;     ///< [m/s^2], default 9.81
  std::optional<Vector3<double>> gravity_direction;  ///< in the adopted base; default: see AdoptedRobot
};

/// The drive's coordinate of the adopted robot from that of the CAD's joint: q = sign * q_joint + offset.
struct AdoptedDrive {
  std::string joint;
  double sign = 1, offset = 0;
};

struct AdoptedRobot {
  RobotDescription robot;  ///< gravity along -z of the base, or of the root link if that is an empty frame ("world")
  std::vector<AdoptedDrive> drives;
  NamedValues parameters;          ///< inertial parameters of the links that have a mass, by name
  std::vector<std::string> notes;  ///< what was taken for what, and what was left out
};

/// Throws deltadyn::Error: usage if a flag is needed or wrong, bad_input if a rule fails.
/// \param where names the file in messages
[[nodiscard]] AdoptedRobot adopt_robot(const std::string& text, const std::string& where,
                                       const AdoptOptions& options = {});

}  // namespace deltadyn
