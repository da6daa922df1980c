#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <numeric>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "adopt_parts.hpp"
#include "robot_file_format.hpp"

namespace deltadyn::cad {
namespace {

constexpr double kParallel = 5e-3;  // [rad] directions of a CAD file: struts 0.1 m apart, points with four digits
constexpr double kAlike = 5e-4;     // lengths of the three limbs that differ by less, relative, are one length

/// Nanometres: what is beyond is rounding of the CAD's matrices.
double tidy(double value) {
  return std::round(value * 1e9) / 1e9 + 0.0;
}
Vec tidy(const Vec& v) {
  return {tidy(v.x()), tidy(v.y()), tidy(v.z())};
}

class Placer {
 public:
  Placer(const UrdfTree& tree, const Parts& parts, const AdoptOptions& options)
      : tree_(tree), parts_(parts), options_(options) {
    prismatic_ = parts.limbs.front().drive->prismatic;
    out_.notes = parts.notes;
  }

  Placed run() {
    for (const Limb& limb : parts_.limbs) limbs_.push_back(elbow_of(limb));
    find_up();
    find_outwards();
    out_.ends = find_attachments(tree_, parts_, options_, limbs_, up_);
    if (!out_.ends.assembled && up_.dot(upright()) < 0) {
      up_ = -up_;
      find_outwards();
      out_.ends = find_attachments(tree_, parts_, options_, limbs_, up_);
    }
    if (!out_.ends.note.empty()) out_.notes.push_back(out_.ends.note);
    order_limbs();
    align_rails();
    place_frames();
    describe();
    find_postures();
    return out_;
  }

 private:
  /// z of the link that carries the drives, or of the root where that one lies.
  [[nodiscard]] Vec upright() const {
    const Vec z = link_pose(tree_, parts_.X_R, parts_.limbs.front().drive->parent_link).linear().col(2);
    return std::abs(z.dot(up_)) > 0.5 ? z : Vec(Vec::UnitZ());
  }

  // --- limbs in space -----------------------------------------------------------------------------
  LimbPlace elbow_of(const Limb& limb) const {
    LimbPlace out;
    Vec sum = Vec::Zero();
    for (const Strut& strut : limb.struts) sum += strut.elbow;
    out.elbow = sum / static_cast<double>(limb.struts.size());
    Vec between = Vec::Zero();
    if (limb.struts.size() == 2) {
      between = limb.struts[0].elbow - limb.struts[1].elbow;
      out.spacing = between.norm();
      if (out.spacing < kPoint)
        refuse("the two struts of a limb lie apart, but their elbow joints are at the same point",
               tree_.at(*limb.drive), "mend the origins of the joints between arm and struts");
      if (options_.strut_spacing && std::abs(*options_.strut_spacing - out.spacing) > 10 * kPoint)
        refuse(fmt::format("--strut-spacing is {:.6g} m, but the elbow joints of limb {} lie {:.6g} m apart",
                           *options_.strut_spacing, limb.drive->name, out.spacing),
               "", "leave the flag out", ExitCode::usage);
    } else if (options_.strut_spacing) {
      out.spacing = *options_.strut_spacing;
    } else {
      refuse(fmt::format("the two struts of limb {} are one link ({}), so their distance cannot be found",
                         limb.drive->name, limb.struts.front().name),
             "", "give --strut-spacing (between the two struts of a limb, in metres)", ExitCode::usage);
    }
    if (prismatic_) {
      out.across = between.norm() > 0 ? between.normalized() : limb.struts.front().first_axis;
      out.drive = out.elbow;
      return out;
    }
    out.across = limb.axis;
    out.drive = limb.place + limb.axis * limb.axis.dot(out.elbow - limb.place);
    if ((out.elbow - out.drive).norm() < kPoint)
      refuse("the elbow lies on the axis of the drive", tree_.at(*limb.drive),
             "mend the origins of the joints between arm and struts");
    if (between.norm() > 0 && between.normalized().cross(limb.axis).norm() > kParallel)
      refuse(
          fmt::format(
              "the two struts of a limb lie apart along the axis of its drive, but here by ({:.6g}, {:.6g}, {:.6g}) m",
              between.x(), between.y(), between.z()),
          tree_.at(*limb.drive), "mend the origins of the joints between arm and struts");
    return out;
  }

  /// Up: across all three limbs, away from the plate.
  void find_up() {
    Vec widest = Vec::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec normal = limbs_[i].across.cross(limbs_[(i + 1) % 3].across);
      if (normal.norm() > widest.norm()) widest = normal;
    }
    if (widest.norm() < 0.1)
      refuse("all parallelograms lie in the same direction, so the plate could turn", tree_.where,
             "mend the rpy of the drives' joints");
    up_ = widest.normalized();
    for (std::size_t i = 0; i < 3; ++i)
      if (std::abs(limbs_[i].across.dot(up_)) > kParallel)
        refuse(fmt::format("the axes of the three {} lie in parallel planes, but this one leaves the plane of the "
                           "others by {:.4g} rad",
                           prismatic_ ? "elbows" : "drives", std::abs(std::asin(limbs_[i].across.dot(up_)))),
               tree_.at(*parts_.limbs[i].drive), "mend the joint's rpy or axis");
    double down = 0;
    for (std::size_t i = 0; i < 3; ++i)
      for (const Strut& strut : parts_.limbs[i].struts) {
        if (strut.end) down += (*strut.end - strut.elbow).dot(up_);
        if (strut.direction) down += strut.direction->dot(up_);
      }
    if (parts_.plate_place)
      down += (*parts_.plate_place - (limbs_[0].elbow + limbs_[1].elbow + limbs_[2].elbow) / 3).dot(up_);
    if (down > 0) up_ = -up_;
  }

  void find_outwards() {
    std::vector<Vec> drives, across;
    for (LimbPlace& limb : limbs_) {
      limb.across = (limb.across - up_ * up_.dot(limb.across)).normalized();
      drives.push_back(limb.drive);
      across.push_back(limb.across);
    }
    middle_ = middle_of(drives, across, up_);
    for (LimbPlace& limb : limbs_) {
      limb.outwards = limb.across.cross(up_);
      const auto radial = [&](const Vec& point) { return (point - middle_).dot(limb.outwards); };
      const double side = std::abs(radial(limb.drive)) > 10 * kPoint ? radial(limb.drive) : radial(limb.elbow);
      if (side < 0) limb.outwards = -limb.outwards;
      limb.across = up_.cross(limb.outwards);
      limb.radius = radial(limb.elbow);
    }
  }

  /// Limb 1 is the first in the file, the others follow counter-clockwise, unless the user names the order.
  void order_limbs() {
    out_.order.resize(3);
    std::iota(out_.order.begin(), out_.order.end(), std::size_t{0});
    if (!options_.drives.empty()) return;
    std::ranges::sort(out_.order, {}, [&](std::size_t i) { return parts_.limbs[i].drive->line; });
    const std::size_t first = out_.order.front();
    const auto azimuth = [&](std::size_t i) {
      const double angle =
          std::atan2(limbs_[i].outwards.dot(limbs_[first].across), limbs_[i].outwards.dot(limbs_[first].outwards));
      return i == first ? 0.0 : (angle < 0 ? angle + 2 * std::numbers::pi : angle);
    };
    std::ranges::sort(out_.order, {}, azimuth);
  }

  /// Positive is towards the plate, as an arm's angle is.
  [[nodiscard]] double rail_sign(std::size_t i) const { return parts_.limbs[i].axis.dot(up_) > kParallel ? -1.0 : 1.0; }

  /// The zero of a rail is the end of its range that is farther from the plate, if those ends are at one height for
  /// all, as rails of a robot are; else it stays where the CAD has it.
  void align_rails() {
    zero_.assign(3, 0.0);
    if (!prismatic_) return;
    const auto level = [&](const std::vector<double>& zero) {
      std::vector<double> height;
      for (std::size_t i = 0; i < 3; ++i) height.push_back((limbs_[i].elbow + zero[i] * parts_.limbs[i].axis).dot(up_));
      const auto [lowest, highest] = std::ranges::minmax(height);
      return highest - lowest < kPoint;
    };
    std::vector<double> ends;
    for (std::size_t i = 0; i < 3; ++i) {
      const DriveLimits& limits = parts_.limbs[i].drive->limits;
      ends.push_back(rail_sign(i) > 0 ? limits.lower : limits.upper);
    }
    if (std::ranges::all_of(ends, [](double end) { return std::isfinite(end); }) && level(ends)) {
      zero_ = ends;
    } else if (!level(zero_)) {
      out_.notes.push_back("the carriages stand at unequal heights in the CAD's pose; each drive's zero stays there");
    }
  }

  // --- the robot ----------------------------------------------------------------------------------
  void place_frames() {
    const LimbPlace& first = limbs_[out_.order.front()];
    out_.X_RW.linear().col(0) = first.outwards;
    out_.X_RW.linear().col(1) = first.across;
    out_.X_RW.linear().col(2) = up_;
    double height = 0;
    for (std::size_t i = 0; i < 3; ++i) height += (limbs_[i].drive + zero_[i] * parts_.limbs[i].axis).dot(up_) / 3;
    out_.X_RW.translation() = middle_ + up_ * (height - middle_.dot(up_));
  }

  [[nodiscard]] Vec in_base(const Vec& point) const { return out_.X_RW.inverse() * point; }
  [[nodiscard]] Vec turned(const Vec& v) const { return out_.X_RW.linear().transpose() * v; }

  void describe() {
    RobotDescription& robot = out_.robot;
    robot.name = tree_.name;
    robot.type = prismatic_ ? "linear-delta3" : (parts_.telescope ? "delta4" : "delta3");
    robot.drive_kind = prismatic_ ? DriveKind::prismatic : DriveKind::revolute;
    robot.parts.emplace_back();
    for (const std::size_t i : out_.order) add_limb(i);
    // The same length three times, but for rounding, is one length.
    const auto join = [&](auto&& length) {
      double mean = 0, worst = 0;
      for (auto& limb : robot.limbs) mean += length(limb) / 3;
      for (auto& limb : robot.limbs) worst = std::max(worst, std::abs(length(limb) - mean));
      if (worst < kAlike * mean)
        for (auto& limb : robot.limbs) length(limb) = tidy(mean);
    };
    join([](auto& limb) -> double& { return limb.strut; });
    join([](auto& limb) -> double& { return limb.strut_spacing; });
    if (!prismatic_) join([](auto& limb) -> double& { return limb.p_DE_0.x(); });
    if (parts_.telescope) add_telescope(*parts_.telescope);
    robot.gravity = gravity();
    robot.validate(tree_.where);
  }

  void add_limb(std::size_t i) {
    const Limb& part = parts_.limbs[i];
    const LimbPlace& in = limbs_[i];
    LimbGeometry<double> limb;
    const Vec x = turned(in.outwards);
    limb.azimuth = std::atan2(x.y(), x.x());
    if (limb.azimuth < -1e-9) limb.azimuth += 2 * std::numbers::pi;
    limb.azimuth = tidy(limb.azimuth);
    limb.p_BA = tidy(turned(out_.ends.offsets[i]));
    limb.strut = tidy(out_.ends.lengths[i]);
    limb.strut_spacing = tidy(in.spacing);
    AdoptedDrive drive;
    drive.joint = part.drive->name;
    if (prismatic_) {
      drive.sign = rail_sign(i);
      drive.offset = tidy(-drive.sign * zero_[i]);
      const Vec rail = drive.sign * part.axis;
      limb.p_WD = tidy(in_base(in.drive + zero_[i] * part.axis));
      limb.axis_L = tidy(Vec(rail.dot(in.outwards), rail.dot(in.across), rail.dot(up_))).normalized();
    } else {
      drive.sign = part.axis.dot(in.across) > 0 ? 1 : -1;
      const Vec arm = in.elbow - in.drive;
      drive.offset = tidy(std::atan2(-arm.dot(up_), arm.dot(in.outwards)));
      limb.p_WD = tidy(in_base(in.drive));
      limb.p_DE_0 = Vec(tidy(arm.norm()), 0, 0);
    }
    out_.robot.limbs.push_back(limb);
    add_drive(drive, part.drive->limits);
  }

  void add_telescope(const Telescope& bar) {
    if (bar.axis.cross(up_).norm() > kParallel)
      refuse("the telescope's drive turns about the robot's vertical axis, but this one leans", tree_.at(*bar.drive),
             "mend the joint's rpy or axis");
    if ((bar.upper_joint - bar.place).cross(bar.axis).norm() > kPoint)
      refuse("the upper universal joint of the telescope bar must lie on the axis of its drive", tree_.at(*bar.drive),
             "mend the joints' origins");
    TelescopeGeometry<double> geometry;
    geometry.p_WU = tidy(in_base(bar.upper_joint));
    geometry.p_BV =
        out_.ends.assembled ? tidy(turned(bar.lower_joint - out_.ends.plate_centre)) : lower_joint_alone(bar);
    out_.robot.telescope = geometry;
    AdoptedDrive drive;
    drive.joint = bar.drive->name;
    drive.sign = bar.axis.dot(up_) > 0 ? 1 : -1;
    add_drive(drive, bar.drive->limits);
  }

  /// Of a bar that the pose does not bring to the plate: on the plate's middle axis, as high above the tool's link as
  /// drawn.
  Vec lower_joint_alone(const Telescope& bar) {
    double height = 0;
    for (const std::string& link : tree_.body(bar.tool.back()).links) {
      const Vec above = bar.lower_joint - link_pose(tree_, parts_.X_R, link).translation();
      if (above.cross(up_).norm() < kPoint) height = above.dot(up_);
    }
    out_.notes.push_back(
        fmt::format("the bar's lower joint is taken on the plate's middle axis, {:.6g} m above its centre", height));
    return tidy(Vec(0, 0, height));
  }

  void add_drive(const AdoptedDrive& drive, const DriveLimits& cad) {
    DriveLimits limits;
    const bool range = cad.lower < cad.upper;  // 0 to 0 is what exporters write where nothing was given
    if (range) {
      const auto [low, high] =
          std::minmax({drive.sign * cad.lower + drive.offset, drive.sign * cad.upper + drive.offset});
      const bool finite = std::isfinite(low + high);
      limits.lower = finite ? tidy(low) : low;
      limits.upper = finite ? tidy(high) : high;
    }
    if (cad.velocity > 0) limits.velocity = cad.velocity;
    if (cad.effort > 0) limits.effort = cad.effort;
    if (!range || !(cad.velocity > 0) || !(cad.effort > 0))
      out_.notes.push_back(
          fmt::format("joint {}: a range, velocity or effort of 0 counts as not limited", drive.joint));
    limits.acceleration = acceleration_of(drive.joint);
    out_.robot.limits.push_back(limits);
    out_.drives.push_back(drive);
  }

  /// Of the element that a file of these tools has; no limit otherwise.
  [[nodiscard]] double acceleration_of(const std::string& joint) const {
    for (const robot_file::DriveNote& note : tree_.drives) {
      const auto value = note.attributes.find(robot_file::acceleration_attribute(prismatic_));
      if (note.joint == joint && value != note.attributes.end())
        return robot_file::parse_number(value->second, tree_.where, value->first);
    }
    return DriveLimits().acceleration;
  }

  [[nodiscard]] Vec gravity() {
    const double size = options_.gravity_size.value_or(tree_.gravity.norm());
    if (options_.gravity_direction) return size * options_.gravity_direction->normalized();
    const Vec down = turned(tree_.gravity.normalized());
    const bool frame_only =
        tree_.extension_line > 0 || (tree_.inertials.count(tree_.bodies[0].name) == 0 && is_frame_above_base());
    if (frame_only) {
      Vec g = size * down;
      for (double& entry : g)
        if (std::abs(entry) < 1e-9) entry = 0;
      if ((down + Vec::UnitZ()).norm() > kParallel)
        out_.notes.push_back(
            fmt::format("gravity along -z of {}, which is ({:.4g}, {:.4g}, {:.4g}) m/s^2 in the robot's base",
                        tree_.bodies[0].name, g.x(), g.y(), g.z()));
      return g;
    }
    if ((down + Vec::UnitZ()).norm() > kParallel)
      out_.notes.push_back(
          "gravity is taken from base to plate, though z of the root link points elsewhere; if the robot hangs or "
          "leans, give --gravity-direction");
    return {0, 0, -size};
  }

  /// The root link is a frame above the link that carries the drives, as "world" is.
  [[nodiscard]] bool is_frame_above_base() const {
    const std::string& root = tree_.bodies[0].name;
    return std::ranges::none_of(parts_.limbs, [&](const Limb& limb) { return limb.drive->parent_link == root; });
  }

  /// Elbows outwards or inwards: the posture in which inverse kinematics gives the pose of the CAD.
  void find_postures() {
    if (!out_.ends.assembled) return;  // elbows outwards, as nearly all
    RobotDescription& robot = out_.robot;
    Eigen::VectorXd z = Eigen::VectorXd::Zero(robot.drives()), q(robot.drives());
    z.head<3>() = in_base(out_.ends.plate_centre);
    for (std::size_t k = 0; k < robot.limbs.size(); ++k) {
      const double drawn = out_.drives[k].offset;  // where the joint's zero is
      double best = std::numeric_limits<double>::infinity();
      double posture = 1;
      for (const double elbow : {1.0, -1.0}) {
        RobotDescription tried = robot;
        tried.limbs[k].elbow = elbow;
        if (make_robot(tried)->inverse_kinematics(z, q) != Status::ok) continue;
        const double difference = q(static_cast<Eigen::Index>(k)) - drawn;
        const double off = std::abs(prismatic_ ? difference : std::remainder(difference, 2 * std::numbers::pi));
        if (off < best) {
          best = off;
          posture = elbow;
        }
      }
      robot.limbs[k].elbow = posture;
      // [rad], [m]: near the straight arm the pose depends on the root of the lengths' last digit
      const double tolerance = 0.01;
      if (!(best < tolerance))
        refuse(fmt::format(
                   "the pose of the CAD does not close: limb {} would have to stand {:.4g} {} from where it is drawn",
                   k + 1, best, prismatic_ ? "m" : "rad"),
               tree_.at(*parts_.limbs[out_.order[k]].drive),
               "assemble the robot in the CAD before the export, or give --plate-frame");
    }
  }

  const UrdfTree& tree_;
  const Parts& parts_;
  const AdoptOptions& options_;
  bool prismatic_ = false;
  std::vector<LimbPlace> limbs_;
  Vec up_ = Vec::UnitZ(), middle_ = Vec::Zero();
  std::vector<double> zero_;  ///< of each rail, in the CAD's coordinate
  Placed out_;
};

}  // namespace

Placed place_parts(const UrdfTree& tree, const Parts& parts, const AdoptOptions& options) {
  return Placer(tree, parts, options).run();
}

}  // namespace deltadyn::cad
