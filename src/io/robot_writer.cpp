#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/error.hpp"

#include "plate_tree.hpp"
#include "robot_file_format.hpp"
#include "urdf_tree.hpp"
#include "xml_elements.hpp"

namespace deltadyn {
namespace {

using robot_file::text;
using Vec = Vector3<double>;
using xml::child;
using xml::XMLElement;

constexpr double kPi = std::numbers::pi;

/// URDF has no word for "unlimited" and its readers do not take "inf".
double finite(double limit) {
  return std::clamp(limit, -robot_file::kUnlimited, robot_file::kUnlimited);
}

class Writer {
 public:
  Writer(const RobotDescription& robot, const NamedValues& parameters) : robot_(robot), parameters_(parameters) {}

  std::string run() {
    document_.InsertEndChild(document_.NewDeclaration());
    root_ = child(&document_, "robot", {{"name", robot_.name.empty() ? robot_.type : robot_.name}});
    const std::string words = fmt::format(
        " {} written by deltadyn. Lengths in m, angles in rad. The tree is plain URDF; <loop> closes it (URDF+). ",
        robot_.type);
    root_->InsertNewComment(words.c_str());
    base();
    if (robot_.parts.empty()) {
      axis();
    } else {
      for (std::size_t i = 0; i < robot_.limbs.size(); ++i) limb(i);
      robot_.plate ? articulated_plate() : platform();
      if (robot_.telescope) telescope();
      loops();
    }
    extension();
    return xml::text_of(document_);
  }

 private:
  // --- elements -------------------------------------------------------------------------------
  static void origin(XMLElement* parent, const Vec& xyz, const Vec& rpy = Vec::Zero()) {
    child(parent, "origin", {{"xyz", text(xyz)}, {"rpy", text(rpy)}});
  }

  XMLElement* link(const std::string& name) { return child(root_, "link", {{"name", name}}); }

  XMLElement* joint(const std::string& name, const char* type, const std::string& parent, const std::string& to,
                    const Vec& xyz, const Vec& rpy = Vec::Zero()) {
    XMLElement* element = child(root_, "joint", {{"name", name}, {"type", type}});
    child(element, "parent", {{"link", parent}});
    child(element, "child", {{"link", to}});
    origin(element, xyz, rpy);
    return element;
  }

  static void axis_of(XMLElement* element, const Vec& axis) { child(element, "axis", {{"xyz", text(axis)}}); }

  static void limit_of(XMLElement* element, const DriveLimits& limits, bool with_range) {
    XMLElement* limit = child(element, "limit");
    if (with_range) xml::set(limit, {{"lower", text(finite(limits.lower))}, {"upper", text(finite(limits.upper))}});
    xml::set(limit, {{"effort", text(finite(limits.effort))}, {"velocity", text(finite(limits.velocity))}});
  }

  /// A passive joint: no effort, half a turn to both sides.
  XMLElement* passive(const std::string& name, const std::string& parent, const std::string& to, const Vec& axis,
                      const Vec& xyz) {
    XMLElement* element = joint(name, "revolute", parent, to, xyz);
    element->SetAttribute("independent", false);
    axis_of(element, axis);
    DriveLimits limits;
    limits.lower = -kPi;
    limits.upper = kPi;
    limits.effort = 0;
    limit_of(element, limits, true);
    return element;
  }

  void drive(std::size_t index, const std::string& to, DriveKind kind, const Vec& axis, const Vec& xyz,
             const Vec& rpy) {
    const DriveLimits& limits = robot_.limits[index];
    const bool unlimited = std::isinf(limits.lower) && std::isinf(limits.upper);
    const bool continuous = kind == DriveKind::revolute && unlimited;
    const char* type = kind == DriveKind::prismatic ? "prismatic" : (continuous ? "continuous" : "revolute");
    XMLElement* element = joint(robot_file::drive_name(index), type, "base", to, xyz, rpy);
    element->SetAttribute("independent", true);
    axis_of(element, axis);
    limit_of(element, limits, !continuous);
    dynamics_of(element, robot_file::drive_name(index));
  }

  [[nodiscard]] double value(const std::string& name) const { return robot_file::value_of(parameters_, name); }

  /// Friction of a joint; plain URDF's `friction` is the Coulomb part.
  void dynamics_of(XMLElement* element, const std::string& name) const {
    const double viscous = value(name + ".viscous"), coulomb = value(name + ".coulomb");
    if (viscous == 0 && coulomb == 0) return;
    child(element, "dynamics", {{"damping", text(viscous)}, {"friction", text(coulomb)}});
  }

  static void mimic(XMLElement* element, const std::string& other, double multiplier = -1) {
    child(element, "mimic", {{"joint", other}, {"multiplier", text(multiplier)}});
  }

  // --- bodies ---------------------------------------------------------------------------------
  /// A cylinder from `from` to `to` in the link's frame, so that viewers show something.
  void visual(XMLElement* body, const Vec& from, const Vec& to, double radius) {
    const double length = (to - from).norm();
    if (length <= 0) return;
    XMLElement* element = child(body, "visual");
    const Vec z = (to - from) / length;
    // Rz(yaw) Ry(pitch) turns the cylinder's z into the direction wanted.
    origin(element, (from + to) / 2, Vec(0, std::atan2(std::hypot(z.x(), z.y()), z.z()), std::atan2(z.y(), z.x())));
    child(child(element, "geometry"), "cylinder", {{"radius", text(radius)}, {"length", text(length)}});
  }

  /// \param shared the body's name in a parameter set with equal limbs, \param own the name of this limb's copy (or
  ///               empty)
  void inertial(XMLElement* body, const std::string& shared, const std::string& own = {}) {
    InertialVector<double> p = InertialVector<double>::Zero();
    bool given = false;
    for (int k = 0; k < kInertialParameters; ++k) {
      auto found = own.empty() ? parameters_.end() : parameters_.find(own + "." + kInertialNames[k]);
      if (found == parameters_.end()) found = parameters_.find(shared + "." + kInertialNames[k]);
      if (found == parameters_.end()) continue;
      given = true;
      p(k) = found->second;
      if (!std::isfinite(p(k)))
        throw Error(fmt::format("parameter {}.{} is not finite", shared, kInertialNames[k]), "",
                    "mend the parameter file");
    }
    if (!given) return;
    if (!(p(0) > 0))
      throw Error(
          fmt::format("body {} has mass {} kg, which a URDF <inertial> cannot hold", own.empty() ? shared : own, p(0)),
          "", "give the body a positive mass, or leave its parameters out");
    set_inertial(body, p);
  }

  /// URDF wants the inertia about the centre of mass, the paper's parameters are about the frame's origin.
  static void set_inertial(XMLElement* body, const InertialVector<double>& p) {
    const robot_file::LinkInertial central = robot_file::central_inertial(p);
    const Eigen::Matrix3d& I = central.I_C;
    XMLElement* element = child(body, "inertial");
    origin(element, central.X_LC.translation());
    child(element, "mass", {{"value", text(p(0))}});
    child(element, "inertia",
          {{"ixx", text(I(0, 0))},
           {"ixy", text(I(0, 1))},
           {"ixz", text(I(0, 2))},
           {"iyy", text(I(1, 1))},
           {"iyz", text(I(1, 2))},
           {"izz", text(I(2, 2))}});
  }

  // --- the mechanism --------------------------------------------------------------------------
  void base() {
    XMLElement* body = link("base");
    double radius = 0;
    for (const auto& limb : robot_.limbs) radius = std::max(radius, limb.p_WD.head<2>().norm());
    if (radius > 0) visual(body, Vec(0, 0, 0.02), Vec(0, 0, 0.04), radius);
  }

  /// Drive joint and upper arm or carriage of one limb.
  XMLElement* upper_arm(std::size_t index) {
    const LimbGeometry<double>& limb = robot_.limbs[index];
    const std::string name = fmt::format("upper_arm{}", index + 1);
    drive(index, name, robot_.drive_kind, limb.axis_L, limb.p_WD, robot_file::limb_rpy(limb));
    XMLElement* body = link(name);
    if (robot_.drive_kind == DriveKind::prismatic) visual(body, -0.03 * limb.axis_L, 0.03 * limb.axis_L, 0.03);
    visual(body, Vec::Zero(), limb.p_DE_0, 0.025);
    inertial(body, "upper_arm", name);
    return body;
  }

  void axis() {
    upper_arm(0);
    const Vec& tip = robot_.limbs[0].p_DE_0;
    if (tip.norm() <= 0) return;
    joint("upper_arm1_tip_mount", "fixed", "upper_arm1", "upper_arm1_tip", tip);
    link("upper_arm1_tip");
  }

  void limb(std::size_t index) {
    const LimbGeometry<double>& limb = robot_.limbs[index];
    upper_arm(index);
    for (const bool first : {true, false}) {
      const std::string name = robot_file::strut_name(index, first);
      const std::string arm = fmt::format("upper_arm{}", index + 1);
      passive(name + "_y", arm, name + "_knuckle", Vec::UnitY(), robot_file::strut_elbow(limb, first));
      link(name + "_knuckle");
      passive(name + "_z", name + "_knuckle", name, Vec::UnitZ(), Vec::Zero());
      XMLElement* body = link(name);
      visual(body, Vec::Zero(), Vec(limb.strut, 0, 0), 0.01);
      inertial(body, "strut", fmt::format("strut{}", index + 1));
    }
  }

  /// Hangs the part of the plate that limb 1 holds on its first strut.
  void plate_on_strut() {
    const LimbGeometry<double>& limb = robot_.limbs[0];
    // z then y undo the strut's y then z, so the plate stays parallel to the base.
    mimic(passive("platform_z", "strut1a", "platform_knuckle", Vec::UnitZ(), Vec(limb.strut, 0, 0)), "strut1a_z");
    link("platform_knuckle");
    passive("platform_y", "platform_knuckle", "platform_mount", Vec::UnitY(), Vec::Zero());
    link("platform_mount");
    joint("platform_fixed", "fixed", "platform_mount", "platform",
          -(limb_frame(limb).transpose() * robot_file::strut_end(limb, true)), robot_file::inverse_limb_rpy(limb));
  }

  void platform() {
    plate_on_strut();
    XMLElement* body = link("platform");
    double radius = 0.02;
    for (const auto& other : robot_.limbs) radius = std::max(radius, other.p_BA.head<2>().norm());
    visual(body, Vec(0, 0, -0.01), Vec(0, 0, 0.01), radius);
    inertial(body, "platform");
  }

  /// Half plate 1 on the first strut, the other parts on it.
  void articulated_plate() {
    plate_on_strut();
    link("platform");
    const std::vector<robot_file::PlateBody> bodies = robot_file::plate_bodies(robot_);
    const std::string theta = robot_file::theta_joint(bodies), root = bodies.front().name;
    joint(root + "_fixed", "fixed", "platform", root, Vec::Zero(), Vec(0, 0, robot_.parts.front().turn));
    for (const robot_file::PlateBody& body : bodies) {
      std::string parent = root;
      Vec place = body.first;
      if (body.swing.moves()) {
        plate_joint(body.swing, theta, parent, body.name + "_mount", place, 0);
        link(body.name + "_mount");
        parent = body.name + "_mount";
        place = body.origin - body.first;
      }
      if (body.level.moves()) {
        plate_joint(body.level, theta, parent, body.name, place, body.turn);
      } else if (body.name != root) {
        joint(body.name + "_fixed", "fixed", parent, body.name, place, Vec(0, 0, body.turn));
      }
      fill_part(body);
    }
  }

  /// A joint whose position is that of `theta` times its gain.
  void plate_joint(const robot_file::PlateJoint& one, const std::string& theta, const std::string& parent,
                   const std::string& to, const Vec& place, double turn) {
    XMLElement* element = joint(one.name, one.slides ? "prismatic" : "revolute", parent, to, place, Vec(0, 0, turn));
    element->SetAttribute("independent", false);
    axis_of(element, one.slides ? one.along : Vec(Vec::UnitZ()));
    DriveLimits range;
    range.upper = robot_.plate->range * std::abs(one.gain);
    range.lower = -range.upper;
    range.effort = 0;
    limit_of(element, range, true);
    if (one.name == theta) {
      dynamics_of(element, "plate");
    } else {
      mimic(element, theta, one.gain);
    }
  }

  void fill_part(const robot_file::PlateBody& body) {
    XMLElement* element = link(body.name);
    const double half = 0.5 * robot_.plate->spacing;
    if (body.shared == name(Body::crossbar)) {
      visual(element, Vec(-half, 0, 0), Vec(half, 0, 0), 0.008);
    } else if (body.shared == name(Body::tool)) {
      visual(element, Vec(0, 0, -0.05), Vec::Zero(), 0.015);
    } else {
      for (const auto& limb : robot_.limbs)
        if (limb.part == body.part)
          visual(element, Vec::Zero(), robot_file::on_plate_link(robot_, limb, limb.p_BA), 0.01);
    }
    inertial(element, body.shared, body.name == body.shared ? std::string() : body.name);
  }

  void telescope() {
    const TelescopeGeometry<double>& bar = *robot_.telescope;
    double reach = 0;
    for (const auto& limb : robot_.limbs)
      reach = std::max(reach, limb.p_WD.norm() + limb.p_DE_0.norm() + limb.strut + limb.p_BA.norm());
    reach += bar.p_WU.norm() + bar.p_BV.norm();  // the bar is never longer than that

    drive(robot_.limbs.size(), "telescope_yoke", DriveKind::revolute, Vec::UnitZ(), bar.p_WU, Vec::Zero());
    XMLElement* yoke = link("telescope_yoke");
    if (const double rotor = value(robot_file::drive_name(robot_.limbs.size()) + ".rotor_inertia"); rotor > 0) {
      // A ring of radius 0.1 m about the drive's axis. Its mass rests on the base and moves nothing.
      InertialVector<double> ring;
      ring << 100 * rotor, 0, 0, 0, rotor / 2, rotor / 2, rotor, 0, 0, 0;
      set_inertial(yoke, ring);
    }
    passive("telescope_x", "telescope_yoke", "telescope_cross", Vec::UnitX(), Vec::Zero());
    link("telescope_cross");
    passive("telescope_y", "telescope_cross", "telescope_upper", Vec::UnitY(), Vec::Zero());
    XMLElement* upper = link("telescope_upper");
    visual(upper, Vec(0, 0, -0.4 * reach), Vec::Zero(), 0.008);
    inertial(upper, "telescope_upper");
    XMLElement* slide = joint("telescope", "prismatic", "telescope_upper", "telescope_lower", Vec::Zero());
    slide->SetAttribute("independent", false);
    axis_of(slide, -Vec::UnitZ());
    DriveLimits range;
    range.lower = 0;
    range.upper = reach;
    range.effort = 0;
    limit_of(slide, range, true);
    dynamics_of(slide, "telescope");
    XMLElement* lower = link("telescope_lower");
    visual(lower, Vec::Zero(), Vec(0, 0, 0.4 * reach), 0.014);
    inertial(lower, "telescope_lower");
    mimic(passive("tool_y", "telescope_lower", "tool_cross", Vec::UnitY(), Vec::Zero()), "telescope_y");
    link("tool_cross");
    mimic(passive("tool_x", "tool_cross", "tool_mount", Vec::UnitX(), Vec::Zero()), "telescope_x");
    link("tool_mount");
    joint("tool_fixed", "fixed", "tool_mount", "tool", Vec(0, 0, -bar.p_BV.z()));
    XMLElement* tool = link("tool");
    visual(tool, Vec(0, 0, -0.05), Vec::Zero(), 0.015);
    inertial(tool, "tool");
  }

  XMLElement* loop(const std::string& name, const char* type, const std::string& predecessor, const Vec& from,
                   const std::string& successor, const Vec& to) {
    XMLElement* element = child(root_, "loop", {{"name", name}, {"type", type}});
    origin(child(element, "predecessor", {{"link", predecessor}}), from);
    origin(child(element, "successor", {{"link", successor}}), to);
    return element;
  }

  void loops() {
    for (std::size_t i = 0; i < robot_.limbs.size(); ++i)
      for (const bool first : {true, false}) {
        if (i == 0 && first) continue;  // this strut carries the plate in the tree
        const std::string name = robot_file::strut_name(i, first);
        const LimbGeometry<double>& limb = robot_.limbs[i];
        loop(name + "_end", "spherical", name, Vec(limb.strut, 0, 0), robot_file::plate_link(robot_, limb),
             robot_file::on_plate_link(robot_, limb, robot_file::strut_end(limb, first)));
      }
    if (robot_.telescope) {
      // The bar's lower joint sits on the tool's axis; where that axis meets the plate is the loop's place on the
      // plate.
      const Vec place(robot_.telescope->p_BV.x(), robot_.telescope->p_BV.y(), 0);
      axis_of(loop("tool_axis", "revolute", "platform", place, "tool", Vec::Zero()), Vec::UnitZ());
    }
  }

  void extension() {
    XMLElement* element = child(root_, "deltadyn", {{"version", "1"}, {"type", robot_.type}});
    child(element, "gravity", {{"xyz_m_s2", text(robot_.gravity)}});
    if (robot_.plate) {
      XMLElement* entry = child(element, "plate");
      for (const auto& [key, member] : robot_file::kPlateNumbers)
        entry->SetAttribute(key, text((*robot_.plate).*member).c_str());
      entry->SetAttribute("tool", robot_file::tool_place_name(robot_.plate->tool));
    }
    for (std::size_t i = 0; i < robot_.limits.size(); ++i) {
      XMLElement* entry = child(element, "drive", {{"joint", robot_file::drive_name(i)}});
      if (i < robot_.limbs.size() && !robot_.parts.empty())
        entry->SetAttribute("elbow", robot_.limbs[i].elbow > 0 ? "+1" : "-1");
      if (std::isfinite(robot_.limits[i].acceleration))
        entry->SetAttribute(
            robot_file::acceleration_attribute(robot_.kind_of_drive(static_cast<int>(i)) == DriveKind::prismatic),
            text(robot_.limits[i].acceleration).c_str());
    }
  }

  const RobotDescription& robot_;
  const NamedValues& parameters_;
  tinyxml2::XMLDocument document_;
  XMLElement* root_ = nullptr;
};

}  // namespace

std::string robot_to_urdf(const RobotDescription& robot, const NamedValues& parameters) {
  robot.validate(robot.name.empty() ? robot.type : robot.name);
  return Writer(robot, parameters).run();
}

void write_robot_file(const std::string& path, const RobotDescription& robot, const NamedValues& parameters) {
  write_file(path, robot_to_urdf(robot, parameters));
}

}  // namespace deltadyn
