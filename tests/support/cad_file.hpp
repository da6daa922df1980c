#pragma once

/// \file
/// URDF as CAD programs write it, for a robot that is known: parts drawn in one pose of the robot, each link in a frame
/// of its own.

#include <Eigen/Geometry>
#include <array>
#include <fmt/format.h>
#include <random>
#include <string>
#include <vector>

#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/model/body.hpp"
#include "deltadyn/model/inertial_parameters.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn::testing_support {

enum class PlateHangs { on_strut, floating, tree_of_its_own, fixed_to_base };

struct CadOptions {
  unsigned seed = 1;
  Eigen::Vector3d plate = Eigen::Vector3d(0.05, -0.08, -0.9);  ///< drawn pose, in W
  bool one_link_a_limb = false;                                ///< both struts of a limb are one link
  PlateHangs plate_hangs = PlateHangs::on_strut;
  bool inertials = true;
  bool turned_frames = true;  ///< of every link, the root's too
  bool flipped_axes = false;  ///< every second drive turns the other way
  int hinges = 2;             ///< at the elbow: 1, 2 (universal) or 3 (ball)
  bool crosspiece = false;    ///< a bar at the elbow carries the two rods
  bool end_frames = false;    ///< a link without mass at the far end of each strut
  double unit = 1;            ///< written lengths in metres times this
  int digits = 12;            ///< behind the point of lengths in metres and angles in radians
  /// Links and joints above the base, e.g. a world; ends with the joint to link "base_part"
  std::string above_base;
};

/// Writes links and joints; poses are given in W, where the parts stand.
class CadFile {
 public:
  CadFile(const RobotDescription& robot, const NamedValues& parameters, const CadOptions& options)
      : robot_(robot), parameters_(parameters), options_(options), random_(options.seed) {}

  std::string text() {
    const auto made = make_robot(robot_);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(robot_.drives());
    q_.resize(robot_.drives());
    z.head<3>() = options_.plate;
    if (made->inverse_kinematics(z, q_) != Status::ok) throw std::runtime_error("the pose is out of reach");
    const Frame base = link(frame(Eigen::Vector3d::Zero(), true), "base_part", {});
    for (std::size_t i = 0; i < robot_.limbs.size(); ++i) limb(i, base);
    if (options_.plate_hangs != PlateHangs::on_strut) plate_alone(base);
    if (robot_.telescope) telescope(base);
    return "<?xml version=\"1.0\"?>\n<robot name=\"assembly\">\n" + options_.above_base + body_ + "</robot>\n";
  }
  /// Drive angles or positions of the drawn pose.
  [[nodiscard]] const Eigen::VectorXd& q() const { return q_; }

 private:
  using Pose = Eigen::Isometry3d;
  using Vec = Eigen::Vector3d;
  struct Frame {
    std::string name;
    Pose X_WL = Pose::Identity();
  };
  using Ten = InertialVector<double>;

  double uniform(double low, double high) { return UniformDistribution(low, high)(random_); }

  Pose frame(const Vec& origin, bool offset = false) {
    Pose X = Pose::Identity();
    X.translation() = origin;
    if (options_.turned_frames) {
      X.linear() =
          (Eigen::AngleAxisd(uniform(-3, 3), Vec::UnitZ()) * Eigen::AngleAxisd(uniform(-1.4, 1.4), Vec::UnitY()) *
           Eigen::AngleAxisd(uniform(-3, 3), Vec::UnitX()))
              .toRotationMatrix();
      if (offset) X.translation() += Vec(uniform(-0.3, 0.3), uniform(-0.3, 0.3), uniform(-0.3, 0.3));
    }
    return X;
  }

  [[nodiscard]] std::string origin(const Pose& X, double unit) const {
    const Vec zyx = X.linear().eulerAngles(2, 1, 0);
    const Vec p = X.translation() * unit;
    const auto three = [this](double a, double b, double c) {
      return fmt::format("{:.{}f} {:.{}f} {:.{}f}", a, options_.digits, b, options_.digits, c, options_.digits);
    };
    return "<origin xyz=\"" + three(p.x(), p.y(), p.z()) + "\" rpy=\"" + three(zyx(2), zyx(1), zyx(0)) + "\"/>";
  }

  std::string fresh(const std::string& what) { return fmt::format("{}_{:x}", what, random_()); }

  /// p: ten parameters in the frame X_WF.
  std::string inertial(const Ten& p, const Pose& X_WF, const Pose& X_WL) {
    if (!options_.inertials || !(p(0) > 0)) return {};
    using namespace deltadyn::inertial;
    const Vec c = p.segment<3>(kMcx) / p(0);
    Eigen::Matrix3d I;
    I << p(kIxx), p(kIxy), p(kIxz), p(kIxy), p(kIyy), p(kIyz), p(kIxz), p(kIyz), p(kIzz);
    I -= p(0) * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
    // The axes of the tensor are turned, too.
    Pose X_WC = frame(X_WF * c);
    const Eigen::Matrix3d R = X_WC.linear().transpose() * X_WF.linear();
    const Eigen::Matrix3d J = R * I * R.transpose() * options_.unit * options_.unit;
    return fmt::format(
        "<inertial>{}<mass value=\"{:.12g}\"/><inertia ixx=\"{:.12g}\" iyy=\"{:.12g}\" izz=\"{:.12g}\" ixy=\"{:.12g}\" "
        "iyz=\"{:.12g}\" "
        "ixz=\"{:.12g}\"/></inertial>",
        origin(X_WL.inverse() * X_WC, options_.unit), p(0), J(0, 0), J(1, 1), J(2, 2), J(0, 1), J(1, 2), J(0, 2));
  }

  Frame link(const Pose& X_WL, const std::string& name, const std::string& inertial) {
    body_ += fmt::format(
        "<link name=\"{}\">{}<visual><geometry><mesh filename=\"package://cad/{}.stl\" scale=\"0.001 0.001 "
        "0.001\"/></geometry></visual>"
        "</link>\n",
        name, inertial, name);
    return {name, X_WL};
  }

  /// A joint at a point of W about an axis of W; the child's frame is the joint's.
  Frame joint(const Frame& parent, const std::string& name, const std::string& type, const Vec& point, const Vec& axis,
              const std::string& child, const Ten& p = Ten::Zero(), const Pose& X_WF = Pose::Identity(),
              const std::string& limit = "<limit lower=\"-3\" upper=\"3\" effort=\"0\" velocity=\"0\"/>") {
    const Pose X_WL = frame(point);
    const Vec a = X_WL.linear().transpose() * axis;
    body_ += fmt::format(
        "<joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>{}<axis xyz=\"{:.12g} {:.12g} "
        "{:.12g}\"/>{}</joint>\n",
        name, type, parent.name, child, origin(parent.X_WL.inverse() * X_WL, options_.unit), a.x(), a.y(), a.z(),
        type == "fixed" || type == "floating" ? "" : limit);
    return link(X_WL, child, inertial(p, X_WF, X_WL));
  }

  [[nodiscard]] Ten ten(const std::string& body) const {
    Ten p = Ten::Zero();
    for (int k = 0; k < kInertialParameters; ++k) {
      const auto found = parameters_.find(body + "." + kInertialNames[k]);
      if (found != parameters_.end()) p(k) = found->second;
    }
    return p;
  }

  static Pose pose(const Eigen::Matrix3d& R, const Vec& p) {
    Pose X = Pose::Identity();
    X.linear() = R;
    X.translation() = p;
    return X;
  }

  void limb(std::size_t i, const Frame& base) {
    const LimbGeometry<double>& g = robot_.limbs[i];
    const bool slides = robot_.drive_kind == DriveKind::prismatic;
    const double q = q_(static_cast<Eigen::Index>(i));
    const Eigen::Matrix3d R_L = Eigen::AngleAxisd(g.azimuth, Vec::UnitZ()).toRotationMatrix();
    const Vec y = R_L.col(1), axis = R_L * g.axis_L;
    const double sign = options_.flipped_axes && i % 2 == 1 ? -1 : 1;
    const Eigen::Matrix3d R_A =
        slides ? R_L : Eigen::Matrix3d(R_L * Eigen::AngleAxisd(q, Vec::UnitY()).toRotationMatrix());
    const Vec origin_A = slides ? Vec(g.p_WD + axis * q) : g.p_WD;
    const Vec elbow = origin_A + R_A * g.p_DE_0;
    const Vec end = options_.plate + g.p_BA;
    // The drive's joint anywhere on a revolute axis.
    const Vec at = slides ? origin_A : Vec(g.p_WD + uniform(-0.1, 0.1) * y);
    const DriveLimits& limits = robot_.limits[i];
    std::string limit = "<limit lower=\"0\" upper=\"0\" effort=\"0\" velocity=\"0\"/>";
    if (std::isfinite(limits.lower)) {
      const double ends[] = {sign * (limits.lower - q), sign * (limits.upper - q)};
      const double unit = slides ? options_.unit : 1;
      limit = fmt::format("<limit lower=\"{:.12g}\" upper=\"{:.12g}\" effort=\"50\" velocity=\"3\"/>",
                          unit * std::min(ends[0], ends[1]), unit * std::max(ends[0], ends[1]));
    }
    const Frame arm = joint(base, fresh("actuator"), slides ? "prismatic" : "revolute", at, sign * axis, fresh("part"),
                            ten("upper_arm"), pose(R_A, origin_A), limit);
    const Vec d = R_L.transpose() * (end - elbow).normalized();
    const Eigen::Matrix3d R_S = R_L * (Eigen::AngleAxisd(std::atan2(-d.z(), d.x()), Vec::UnitY()) *
                                       Eigen::AngleAxisd(std::asin(d.y()), Vec::UnitZ()))
                                          .toRotationMatrix();
    const double half = g.strut_spacing / 2;
    if (options_.one_link_a_limb) {
      PseudoInertia<double> both = to_pseudo_inertia(Ten(2 * ten("strut")));
      both(1, 1) += both(3, 3) * half * half;  // a rod at either side
      strut(arm, elbow, end, y, R_S, from_pseudo_inertia<double>(both), i == 0);
    } else if (options_.crosspiece) {
      const Frame bar = joint(arm, fresh("hinge"), "continuous", elbow, y, fresh("bar"));
      for (const double side : {half, -half})
        rod(bar, elbow + side * y, end + side * y, y, R_S, ten("strut"), i == 0 && side > 0);
    } else {
      strut(arm, elbow + half * y, end + half * y, y, R_S, ten("strut"), i == 0);
      strut(arm, elbow - half * y, end - half * y, y, R_S, ten("strut"), false);
    }
  }

  void strut(const Frame& arm, const Vec& elbow, const Vec& end, const Vec& y, const Eigen::Matrix3d& R_S, const Ten& p,
             bool carries) {
    Frame cross = arm;
    if (options_.hinges >= 2) cross = joint(cross, fresh("hinge"), "continuous", elbow, y, fresh("cross"));
    if (options_.hinges >= 3) cross = joint(cross, fresh("hinge"), "continuous", elbow, R_S.col(0), fresh("cross"));
    rod(cross, elbow, end, y, R_S, p, carries);
  }

  /// The last joint at the elbow, the rod, and the plate if it carries it.
  void rod(const Frame& parent, const Vec& elbow, const Vec& end, const Vec& y, const Eigen::Matrix3d& R_S,
           const Ten& p, bool carries) {
    const Frame rod = joint(parent, fresh("hinge"), "revolute", elbow, options_.hinges == 1 ? y : Vec(R_S.col(2)),
                            fresh("rod"), p, pose(R_S, elbow));
    if (options_.end_frames) joint(rod, fresh("mount"), "fixed", end, Vec::UnitX(), fresh("tip"));
    if (!carries || options_.plate_hangs != PlateHangs::on_strut) return;
    const Frame ball = joint(rod, fresh("hinge"), "revolute", end, R_S.col(2), fresh("cross"));
    joint(ball, fresh("hinge"), "revolute", end, y, fresh("plate"), ten("platform"),
          pose(Eigen::Matrix3d::Identity(), options_.plate));
  }

  void plate_alone(const Frame& base) {
    const Pose X_WB = pose(Eigen::Matrix3d::Identity(), options_.plate);
    if (options_.plate_hangs == PlateHangs::tree_of_its_own) {
      // Its own origin is that of the first tree.
      link(base.X_WL, "plate_part", inertial(ten("platform"), X_WB, base.X_WL));
      return;
    }
    joint(base, "plate_joint", options_.plate_hangs == PlateHangs::floating ? "floating" : "fixed", options_.plate,
          Vec::UnitX(), "plate_part", ten("platform"), X_WB);
  }

  void telescope(const Frame& base) {
    const Vec U = robot_.telescope->p_WU, V = options_.plate + robot_.telescope->p_BV;
    const Vec b = (U - V).normalized();
    const Eigen::Matrix3d R =
        (Eigen::AngleAxisd(std::atan2(-b.y(), b.z()), Vec::UnitX()) * Eigen::AngleAxisd(std::asin(b.x()), Vec::UnitY()))
            .toRotationMatrix();
    const Frame yoke = joint(base, fresh("spindle"), "continuous", U + uniform(-0.05, 0.05) * Vec::UnitZ(),
                             Vec::UnitZ(), fresh("yoke"));
    const Frame cross = joint(yoke, fresh("hinge"), "revolute", U, Vec::UnitX(), fresh("cross"));
    const Frame upper =
        joint(cross, fresh("hinge"), "revolute", U, R.col(1), fresh("bar"), ten("telescope_upper"), pose(R, U));
    const Frame lower = joint(upper, fresh("slide"), "prismatic", V + 0.3 * (U - V), -b, fresh("tube"),
                              ten("telescope_lower"), pose(R, V));
    const Frame cross2 = joint(lower, fresh("hinge"), "revolute", V, R.col(1), fresh("cross"));
    const Vec tool = V - Vec(0, 0, robot_.telescope->p_BV.z());
    joint(cross2, fresh("hinge"), "revolute", V, Vec::UnitX(), fresh("tool"), ten("tool"),
          pose(Eigen::Matrix3d::Identity(), tool));
  }

  const RobotDescription robot_;
  const NamedValues parameters_;
  CadOptions options_;
  std::mt19937 random_;
  std::string body_;
  Eigen::VectorXd q_;
};

}  // namespace deltadyn::testing_support
