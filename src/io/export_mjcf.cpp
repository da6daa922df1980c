#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "export_parts.hpp"
#include "plate_tree.hpp"
#include "xml_elements.hpp"

namespace deltadyn {
namespace {

using model_export::Parts;
using model_export::text;
using Vec = Vector3<double>;
using Rotation = Eigen::Matrix3d;
using xml::child;
using xml::set;
using xml::XMLElement;

// The stiffest that MuJoCo takes: impedance at its upper bound, time constant two steps.
constexpr const char* kTimestep = "0.0005";
constexpr const char* kStiff = "0.001 1";
// Dry friction sticks below |acceleration| / 4000 per s; twice the rate times the time step is where Runge and Kutta
// turn unstable.
constexpr const char* kStickingRate = "-1 -4000";
constexpr const char* kImpedance = "0.9999 0.9999 0.001 0.5 2";
// A body that turns about an axis needs some inertia about it; this radius of gyration is far below what torque could
// show.
constexpr double kSmallestGyration = 1e-5;  // [m]

/// The pose that the file is assembled in.
struct Home {
  Eigen::VectorXd q;
  LinkPoses at;
};

Home find_home(const Robot& robot) {
  const RobotDescription& description = robot.description();
  Home home;
  home.q = Eigen::VectorXd::Zero(robot.drives());
  if (description.parts.empty()) return home;
  const WorkspaceSampler sampler(robot);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(robot.drives());
  z.head<3>() = sampler.ball().centre;
  if (robot.inverse_kinematics(z, home.q) != Status::ok || robot.link_poses(home.q, home.at) != Status::ok)
    throw Error("no home pose was found", description.name, "check the lengths in the robot file");
  return home;
}

Rotation about(const Vec& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

class Mjcf {
 public:
  Mjcf(const Robot& robot, Parts parts)
      : robot_(robot.description()), parts_(std::move(parts)), home_(find_home(robot)) {}

  ExportedModel run() {
    root_ = child(&document_, "mujoco", {{"model", robot_.name.empty() ? robot_.type : robot_.name}});
    const std::string words = fmt::format(
        "\n  {} written by deltadyn: identified parameters, loops closed by equality constraints.\n  SI units, angles "
        "in rad. Drive positions as in the robot file; at rest the file is assembled in the home pose.\n{}",
        robot_.type, model_export::left_out_comment(parts_.left_out, "  "));
    root_->InsertNewComment(words.c_str());
    settings();
    world_ = child(root_, "worldbody");
    light_and_base();
    equality_ = document_.NewElement("equality");
    actuator_ = document_.NewElement("actuator");
    for (std::size_t i = 0; i < robot_.limbs.size(); ++i) limb(i);
    if (robot_.telescope) {
      telescope();
    } else if (robot_.plate) {
      articulated_plate();
    } else if (!robot_.parts.empty()) {
      XMLElement* plate = body(world_, "platform", home_.at.plate, Rotation::Identity());
      child(plate, "freejoint", {{"name", "platform"}});
      fill_platform(plate);
    }
    if (equality_->FirstChild() != nullptr) root_->InsertEndChild(equality_);
    root_->InsertEndChild(actuator_);
    return {xml::text_of(document_), parts_.left_out, 0};
  }

 private:
  void settings() {
    child(root_, "compiler", {{"angle", "radian"}, {"autolimits", "true"}});
    // First-order integrators err by about 1 % of the torque when the fourth drive turns fast.
    child(root_, "option",
          {{"integrator", "RK4"},
           {"timestep", kTimestep},
           {"gravity", text(robot_.gravity)},
           {"tolerance", "1e-12"},
           {"iterations", "100"}});
    XMLElement* defaults = child(root_, "default");
    child(defaults, "equality", {{"solref", kStiff}, {"solimp", kImpedance}});
    child(defaults, "joint", {{"solreffriction", kStickingRate}, {"solimpfriction", kImpedance}});
    // Shapes are to be looked at only.
    child(defaults, "geom", {{"contype", "0"}, {"conaffinity", "0"}, {"mass", "0"}, {"rgba", "0.6 0.65 0.7 1"}});
  }

  void light_and_base() {
    child(world_, "light", {{"pos", "0 -1 1.5"}, {"dir", "0 0.6 -1"}});
    double radius = 0;
    for (const auto& limb : robot_.limbs) radius = std::max(radius, limb.p_WD.head<2>().norm());
    if (radius > 0)
      child(world_, "geom", {{"type", "cylinder"}, {"fromto", "0 0 0.02 0 0 0.04"}, {"size", text(radius)}});
  }

  static XMLElement* body(XMLElement* parent, const std::string& name, const Vec& place, const Rotation& R) {
    XMLElement* element = child(parent, "body", {{"name", name}, {"pos", text(place)}});
    const Eigen::Quaterniond turn(R);
    if (!R.isIdentity(0)) set(element, {{"quat", text(turn.w()) + " " + text(Vec(turn.vec()))}});
    return element;
  }

  static XMLElement* joint(XMLElement* parent, const std::string& name, const char* type, const Vec& axis,
                           double reference, const Vec& place = Vec::Zero()) {
    XMLElement* element = child(parent, "joint", {{"name", name}, {"type", type}, {"axis", text(axis)}});
    if (place.norm() > 0) set(element, {{"pos", text(place)}});
    set_if_any(element, "ref", reference);
    return element;
  }

  void friction(XMLElement* element, const std::string& name) const {
    set_if_any(element, "damping", parts_.value(name + ".viscous"));
    set_if_any(element, "frictionloss", parts_.value(name + ".coulomb"));
  }

  static void set_if_any(XMLElement* element, const char* name, double value) {
    if (value != 0) set(element, {{name, text(value)}});
  }

  void drive(XMLElement* element, std::size_t index) {
    const std::string name = robot_file::drive_name(index);
    friction(element, name);
    set_if_any(element, "armature", parts_.value(name + ".rotor_inertia"));
    const DriveLimits& limits = robot_.limits[index];
    if (std::isfinite(limits.lower) && std::isfinite(limits.upper))
      set(element, {{"range", text(limits.lower) + " " + text(limits.upper)}});
    const double offset = parts_.value(name + ".offset");
    XMLElement* motor = child(actuator_, offset != 0 ? "general" : "motor", {{"name", name}, {"joint", name}});
    if (offset != 0)  // the measured torque holds the offset, the shaft does not feel it
      set(motor, {{"biastype", "affine"}, {"biasprm", text(-offset) + " 0 0"}});
    if (std::isfinite(limits.effort)) set(motor, {{"ctrlrange", text(-limits.effort) + " " + text(limits.effort)}});
  }

  /// \param gyration  radius of gyration for a body whose parameters say nothing of its inertia [m]
  void inertial(XMLElement* element, InertialVector<double> p, const std::string& name,
                double gyration = kSmallestGyration) {
    if (!(p(0) > 0))
      throw Error(fmt::format("body {} has no mass", name), "", "MuJoCo needs one for every body that moves");
    const bool point = p.tail<6>().cwiseAbs().maxCoeff() <= 0;
    const Vec c = p.segment<3>(1) / p(0);
    const auto about_origin = to_pseudo_inertia(p);
    // Second moments about the centre of mass; MuJoCo refuses a body that is infinitely thin.
    Eigen::Matrix3d second = about_origin.topLeftCorner<3, 3>() - p(0) * c * c.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(second);
    const double least = p(0) * std::pow(point ? gyration : kSmallestGyration, 2);
    if (solver.eigenvalues()(0) < -1e-6 * (second.trace() + p(0) * c.squaredNorm()))
      throw Error(fmt::format("the parameters of body {} are not physically consistent", name), "",
                  "take those of delta-identify; no simulator can run others");
    second =
        solver.eigenvectors() * solver.eigenvalues().cwiseMax(least).asDiagonal() * solver.eigenvectors().transpose();
    const Eigen::Matrix3d I = second.trace() * Eigen::Matrix3d::Identity() - second;
    const std::string about_axes = text(Vec(I.diagonal())), about_planes = text(Vec(I(0, 1), I(0, 2), I(1, 2)));
    child(element, "inertial",
          {{"pos", text(c)}, {"mass", text(p(0))}, {"fullinertia", about_axes + " " + about_planes}});
  }

  static void capsule(XMLElement* element, const Vec& from, const Vec& to, double radius) {
    if ((to - from).norm() <= radius) return;
    child(element, "geom", {{"type", "capsule"}, {"fromto", text(from) + " " + text(to)}, {"size", text(radius)}});
  }

  static void site(XMLElement* element, const std::string& name, const Vec& place) {
    child(element, "site", {{"name", name}, {"pos", text(place)}, {"size", "0.005"}});
  }

  void limb(std::size_t i) {
    const LimbGeometry<double>& limb = robot_.limbs[i];
    const std::string arm = fmt::format("upper_arm{}", i + 1);
    const bool revolute = robot_.drive_kind == DriveKind::revolute;
    const double q = home_.q(static_cast<Eigen::Index>(i));
    const Rotation R_WL = limb_frame(limb);
    XMLElement* upper = revolute ? body(world_, arm, limb.p_WD, R_WL * about(Vec::UnitY(), q))
                                 : body(world_, arm, limb.p_WD + R_WL * (q * limb.axis_L), R_WL);
    drive(joint(upper, robot_file::drive_name(i), revolute ? "hinge" : "slide", limb.axis_L, q), i);
    inertial(upper, parts_.body("upper_arm", arm), arm);
    capsule(upper, Vec::Zero(), limb.p_DE_0, 0.025);
    if (robot_.parts.empty()) return;
    const double y_angle = home_.at.limbs[i].beta - (revolute ? q : 0), z_angle = home_.at.limbs[i].gamma;
    for (const bool first : {true, false}) {
      const std::string name = robot_file::strut_name(i, first);
      const Rotation turn = about(Vec::UnitZ(), z_angle);
      XMLElement* strut = body(upper, name, robot_file::strut_elbow(limb, first), about(Vec::UnitY(), y_angle) * turn);
      joint(strut, name + "_y", "hinge", turn.transpose() * Vec::UnitY(), y_angle);
      joint(strut, name + "_z", "hinge", Vec::UnitZ(), z_angle);
      inertial(strut, parts_.body("strut", fmt::format("strut{}", i + 1)), name);
      const Vec end(limb.strut, 0, 0);
      capsule(strut, Vec::Zero(), end, 0.008);
      site(strut, name + "_end", end);
      child(equality_, "connect", {{"name", name}, {"site1", name + "_end"}, {"site2", plate_site(i, first)}});
    }
  }

  /// The position of a joint is `gain` times that of another.
  void couple(const std::string& joint1, const std::string& joint2, double gain) {
    child(equality_, "joint",
          {{"name", joint1}, {"joint1", joint1}, {"joint2", joint2}, {"polycoef", "0 " + text(gain) + " 0 0 0"}});
  }

  void fill_platform(XMLElement* plate) {
    double radius = 0;
    for (const auto& limb : robot_.limbs) radius = std::max(radius, limb.p_BA.norm());
    // The plate never turns, so its inertia moves nothing; the simulation needs one all the same: a disc of its size.
    inertial(plate, platform_parameters(), "platform", std::max(0.02, radius) / 2);
    child(plate, "geom", {{"type", "cylinder"}, {"size", text(std::max(0.02, radius)) + " 0.01"}});
    for (std::size_t i = 0; i < robot_.limbs.size(); ++i)
      for (const bool first : {true, false})
        site(plate, plate_site(i, first), robot_file::strut_end(robot_.limbs[i], first));
  }

  [[nodiscard]] std::string plate_site(std::size_t limb, bool first) const {
    return (robot_.plate ? "plate_" : "platform_") + robot_file::strut_name(limb, first);
  }

  /// The halves only translate, which the parallelograms see to; the simulation takes it as given, because MuJoCo's
  /// loops give way a little and a light half would turn. So one strut a limb would do; two halve the error. Half 1
  /// carries the rest by joints that move with theta; a half that bars join to it moves by itself, tied to the first
  /// bar.
  void articulated_plate() {
    std::vector<robot_file::PlateBody> bodies = robot_file::plate_bodies(robot_);
    const auto bar = std::ranges::find(bodies, std::string(name(Body::crossbar)), &robot_file::PlateBody::shared);
    const bool tied = bar != bodies.end();
    const robot_file::PlateBody bar_of_tie = tied ? *bar : robot_file::PlateBody();
    const robot_file::PlateJoint leader = tied ? bar_of_tie.swing : bodies[1].swing;
    XMLElement* root = nullptr;
    for (const robot_file::PlateBody& one : bodies) {
      const bool floating = floats(one, tied);
      XMLElement* element =
          floating ? floating_half(one) : body(root, one.name, one.origin, about(Vec::UnitZ(), one.turn));
      if (root == nullptr) root = element;
      if (!floating) {
        const Rotation R_B1 = about(Vec::UnitZ(), -one.turn);
        plate_joint(element, one.swing, leader, R_B1 * one.swing.along,
                    one.swing.slides ? Vec(Vec::Zero()) : Vec(R_B1 * (one.first - one.origin)));
        plate_joint(element, one.level, leader, Vec::UnitZ(), Vec::Zero());
      } else if (one.part == 1) {
        site(element, "tie_half", about(Vec::UnitZ(), -one.turn) * bar_of_tie.first);
        child(equality_, "connect", {{"name", "tie"}, {"site1", "tie_half"}, {"site2", "tie_bar"}});
      }
      if (tied && one.name == bar_of_tie.name)
        site(element, "tie_bar", about(Vec::UnitZ(), -one.turn) * (bodies[1].origin + one.first - one.origin));
      fill_part(element, one);
    }
  }

  static bool floats(const robot_file::PlateBody& one, bool tied) { return one.part == 0 || (one.part == 1 && tied); }

  /// Three slides, whose positions are the half's place.
  XMLElement* floating_half(const robot_file::PlateBody& one) {
    const PlatePart<double>& part = robot_.parts[static_cast<std::size_t>(one.part)];
    const Rotation R = about(Vec::UnitZ(), part.turn);
    const Vec place = home_.at.plate + part.c + part.a;
    XMLElement* element = body(world_, one.name, place, R);
    for (int axis = 0; axis < 3; ++axis)
      joint(element, one.name + "_" + "xyz"[axis], "slide", R.transpose() * Vec(Vec::Unit(axis)), place(axis));
    return element;
  }

  /// \param leader  the joint between the halves, which carries load and friction; the others follow it
  void plate_joint(XMLElement* element, const robot_file::PlateJoint& one, const robot_file::PlateJoint& leader,
                   const Vec& axis, const Vec& place) {
    if (!one.moves()) return;
    XMLElement* made = joint(element, one.name, one.slides ? "slide" : "hinge", axis, 0, place);
    if (one.name == leader.name) {
      const double range = robot_.plate->range * std::abs(one.gain);
      set(made, {{"range", text(-range) + " " + text(range)}});
      set_if_any(made, "damping", parts_.value("plate.viscous") / (one.gain * one.gain));
      set_if_any(made, "frictionloss", parts_.value("plate.coulomb") / std::abs(one.gain));
    } else {
      couple(one.name, leader.name, one.gain / leader.gain);
    }
  }

  void fill_part(XMLElement* element, const robot_file::PlateBody& one) {
    inertial(element, parts_.body(one.shared, one.name == one.shared ? std::string() : one.name), one.name, 0.02);
    draw_part(element, one);
    for (std::size_t i = 0; i < robot_.limbs.size(); ++i) {
      const LimbGeometry<double>& limb = robot_.limbs[i];
      if (limb.part != one.part) continue;
      for (const bool first : {true, false})
        site(element, plate_site(i, first),
             robot_file::on_plate_link(robot_, limb, robot_file::strut_end(limb, first)));
    }
  }

  void draw_part(XMLElement* element, const robot_file::PlateBody& one) const {
    const double half = 0.5 * robot_.plate->spacing;
    if (one.shared == name(Body::crossbar)) {
      capsule(element, Vec(-half, 0, 0), Vec(half, 0, 0), 0.008);
    } else if (one.shared == name(Body::tool)) {
      capsule(element, Vec(0, 0, -0.06), Vec::Zero(), 0.015);
    }
    for (const auto& limb : robot_.limbs)
      if (limb.part == one.part && one.shared == name(Body::half_plate))
        capsule(element, Vec::Zero(), robot_file::on_plate_link(robot_, limb, limb.p_BA), 0.01);
  }

  /// A robot without a tool still has a body that turns at the bar's end: a tenth of the plate's mass, which moves
  /// alike.
  [[nodiscard]] bool tool_is_borrowed() const { return robot_.telescope && !(parts_.value("tool.m") > 0); }
  [[nodiscard]] InertialVector<double> platform_parameters() const {
    return (tool_is_borrowed() ? 0.9 : 1.0) * parts_.body("platform");
  }
  [[nodiscard]] InertialVector<double> tool_parameters() const {
    if (!tool_is_borrowed()) return parts_.body("tool");
    InertialVector<double> p = InertialVector<double>::Zero();
    p(0) = 0.1 * parts_.value("platform.m");
    return p;
  }

  void telescope() {
    const TelescopeGeometry<double>& bar = *robot_.telescope;
    const Rotation R_b = about(Vec::UnitY(), home_.at.telescope.b);
    const Rotation R = about(Vec::UnitX(), home_.at.telescope.a) * R_b;
    XMLElement* upper = body(world_, "telescope_upper", bar.p_WU, R);
    drive(joint(upper, robot_file::drive_name(robot_.limbs.size()), "hinge", R.transpose() * Vec::UnitZ(), 0),
          robot_.limbs.size());
    joint(upper, "telescope_x", "hinge", R_b.transpose() * Vec::UnitX(), home_.at.telescope.a);
    joint(upper, "telescope_y", "hinge", Vec::UnitY(), home_.at.telescope.b);
    inertial(upper, parts_.body("telescope_upper"), "telescope_upper");
    capsule(upper, Vec(0, 0, -0.6 * home_.at.telescope.length), Vec::Zero(), 0.008);
    XMLElement* lower = body(upper, "telescope_lower", Vec(0, 0, -home_.at.telescope.length), Rotation::Identity());
    friction(joint(lower, "telescope", "slide", -Vec::UnitZ(), home_.at.telescope.length), "telescope");
    inertial(lower, parts_.body("telescope_lower"), "telescope_lower");
    capsule(lower, Vec::Zero(), Vec(0, 0, 0.6 * home_.at.telescope.length), 0.012);
    // The lower joint undoes the upper one's angles, so that the tool stands upright; the plate hangs on the tool's
    // bearing.
    const Vec joint_place(0, 0, bar.p_BV.z());
    XMLElement* tool = body(lower, "tool", -(R.transpose() * joint_place), R.transpose());
    joint(tool, "tool_y", "hinge", R * Vec::UnitY(), -home_.at.telescope.b, joint_place);
    joint(tool, "tool_x", "hinge", Vec::UnitX(), -home_.at.telescope.a, joint_place);
    inertial(tool, tool_parameters(), "tool");
    capsule(tool, Vec(0, 0, -0.06), Vec::Zero(), 0.015);
    const Vec axis_place(bar.p_BV.x(), bar.p_BV.y(), 0);
    XMLElement* plate = body(tool, "platform", -axis_place, Rotation::Identity());
    joint(plate, "platform", "hinge", Vec::UnitZ(), 0, axis_place);
    fill_platform(plate);
  }

  const RobotDescription& robot_;
  Parts parts_;
  Home home_;
  tinyxml2::XMLDocument document_;
  XMLElement *root_ = nullptr, *world_ = nullptr, *equality_ = nullptr, *actuator_ = nullptr;
};

}  // namespace

ExportedModel export_mjcf(const Robot& robot, const Eigen::VectorXd& p, const std::vector<Effect>& effects) {
  Parts parts = model_export::collect(robot, p, effects);
  model_export::leave_effects_out(robot.description(), parts);
  return Mjcf(robot, std::move(parts)).run();
}

}  // namespace deltadyn
