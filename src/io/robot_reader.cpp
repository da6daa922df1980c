#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <numbers>
#include <sstream>

#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/articulated_plate.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/geometry_of.hpp"
#include "deltadyn/runtime/plausibility.hpp"

#include "plate_tree.hpp"
#include "robot_file_format.hpp"
#include "urdf_tree.hpp"

namespace deltadyn {
namespace {

using robot_file::Joint;
using robot_file::Loop;
using robot_file::Pose;
using robot_file::refuse;
using robot_file::UrdfTree;
using Vec = Vector3<double>;

constexpr const char* kMendTree =
    "compare with a file of delta-model create, or take the file of a CAD program by delta-model adopt";
constexpr double kTolerance = 1e-6;  // [m], [rad]: files by hand or from CAD have six digits

std::string words(const Vec& v) {
  return fmt::format("({:.9g}, {:.9g}, {:.9g})", v.x(), v.y(), v.z());
}

/// One strut as found in the tree.
struct Strut {
  int body = -1;
  std::string name;
  Vec elbow = Vec::Zero();  ///< in the arm's frame
  bool closed = false;      ///< its other end is known
  int part = 0;             ///< of the plate
  Vec end = Vec::Zero();    ///< in the strut's frame
  Vec p_BE = Vec::Zero();   ///< the same point from the plate's centre
};

class Reader {
 public:
  explicit Reader(const UrdfTree& tree) : tree_(tree) {}

  RobotDescription run() {
    sort_drives();
    robot_.name = tree_.name;
    robot_.gravity = tree_.gravity;
    if (drives_.size() == 1 && tree_.body(drives_[0]->child).joints.empty()) {
      axis();
    } else {
      delta();
    }
    for (const Joint* drive : drives_) robot_.limits.push_back(drive->limits);
    extension();
    robot_.validate(tree_.where);
    if (robot_.plate) compare_plate();
    inertials();
    return robot_;
  }

 private:
  /// The only moving joint below a body.
  const Joint& only_joint(int index, const std::string& rule) const {
    const robot_file::Body& b = tree_.body(index);
    if (b.joints.size() != 1)
      refuse(fmt::format("{} moving joints hang on this link, but {}", b.joints.size(), rule), tree_.at(b.name),
             kMendTree);
    return tree_.joint(b.joints[0]);
  }

  void require_axis(const Joint& j, const Vec& axis, bool prismatic, const std::string& what) const {
    if (j.prismatic != prismatic)
      refuse(fmt::format("{} must be {}", what, prismatic ? "prismatic" : "revolute"), tree_.at(j),
             "mend the joint's type, or take the file of a CAD program by delta-model adopt");
    if ((j.axis - axis).norm() > kTolerance)
      refuse(fmt::format("wrong axis: {} has axis {}, but must have {}", what, words(j.axis), words(axis)), tree_.at(j),
             "turn the joint's origin, or swap the signs");
  }

  /// A passive joint whose frame is turned about nothing but its own axis, which does not change the mechanism.
  void require_passive(const Joint& j, const Vec& axis, const std::string& what) const {
    require_axis(j, axis, false, what);
    if ((j.X_PJ.linear() * axis - axis).norm() > kTolerance)
      refuse(fmt::format("wrong axis: the origin of {} is turned about another axis than its own", what), tree_.at(j),
             "set the origin's rpy to 0 0 0");
  }

  void require_no_offset(const Joint& j, const std::string& what) const {
    if (j.X_PJ.translation().norm() > kTolerance)
      refuse(fmt::format("{}: its axis must meet the one before, but lies {:.6g} m beside it", what,
                         j.X_PJ.translation().norm()),
             tree_.at(j), "set the origin's xyz to 0 0 0");
  }

  void require_parallel(const Eigen::Matrix3d& R, const std::string& where, const std::string& what) const {
    if ((R - Eigen::Matrix3d::Identity()).norm() > kTolerance)
      refuse(what + " must be parallel to the base frame when all joints are in their middle", where,
             "mend the rpy of the fixed joint");
  }

  // --- drives -----------------------------------------------------------------------------------
  /// The first of the drives' names that no moving joint on the base has.
  [[nodiscard]] std::string missing_drive(const robot_file::Body& base) const {
    std::size_t k = 0;
    while (std::ranges::any_of(base.joints,
                               [&](int index) { return tree_.joint(index).name == robot_file::drive_name(k); }))
      ++k;
    return robot_file::drive_name(k);
  }

  void sort_drives() {
    const robot_file::Body& base = tree_.body(0);
    drives_.assign(base.joints.size(), nullptr);
    if (drives_.empty())
      refuse("no moving joint hangs on the base link", tree_.at(base.name),
             "the drives are the joints drive1, drive2, ...");
    for (const int index : base.joints) {
      const Joint& j = tree_.joint(index);
      std::size_t k = 0;
      while (k < drives_.size() && j.name != robot_file::drive_name(k)) ++k;
      if (k == drives_.size())
        refuse(fmt::format("a joint on the base is a drive, and the {0} drives here are called drive1 to drive{0}; "
                           "{1} is none of those that move on the base",
                           drives_.size(), missing_drive(base)),
               tree_.at(j),
               "rename the joint, mend that drive if its type is fixed or it hangs on another link, or take the file "
               "of a CAD program by delta-model adopt");
      drives_[k] = &j;
      if (!j.mimics.empty()) refuse("a drive cannot mimic another joint", tree_.at(j), "remove the <mimic> element");
    }
  }

  /// Azimuth in [0, 2 pi).
  static double azimuth(const Eigen::Matrix3d& R) {
    const double angle = std::atan2(R(1, 0), R(0, 0));
    return angle < -1e-9 ? angle + 2 * std::numbers::pi : angle;
  }

  LimbGeometry<double> limb_of(const Joint& drive) const {
    LimbGeometry<double> limb;
    const Eigen::Matrix3d& R = drive.X_PJ.linear();
    if (std::abs(R(2, 0)) > kTolerance || R(2, 2) < kTolerance)
      refuse("the limb frame must be turned about z of the base, and then tilted about its own x, by less than 90 deg",
             tree_.at(drive), "write the azimuth as the third number of rpy, the tilt as the first");
    if (std::abs(R(2, 1)) > kTolerance) limb.tilt = std::atan2(R(2, 1), R(2, 2));
    limb.azimuth = azimuth(R);
    limb.p_WD = drive.X_PJ.translation();
    if (!drive.prismatic) require_axis(drive, Vec::UnitY(), false, "a limb's revolute drive");
    limb.axis_L = drive.prismatic ? drive.axis : Vec(Vec::UnitY());
    return limb;
  }

  void axis() {
    robot_.type = "axis";
    robot_.drive_kind = drives_[0]->prismatic ? DriveKind::prismatic : DriveKind::revolute;
    LimbGeometry<double> limb = limb_of(*drives_[0]);
    const robot_file::Body& arm = tree_.body(drives_[0]->child);
    for (const std::string& link : arm.links)
      if (link == arm.name + "_tip") limb.p_DE_0 = tree_.links.at(link).X_BL.translation();
    robot_.limbs.push_back(limb);
    if (!tree_.loops.empty())
      refuse("an axis has no loops", tree_.at(tree_.loops[0]), "remove the loop, or give the whole robot");
  }

  // --- Delta --------------------------------------------------------------------------------------
  /// The telescope's drive turns about z and carries one chain; a limb's carries two struts.
  [[nodiscard]] bool is_telescope(const Joint& drive) const {
    return !drive.prismatic && tree_.body(drive.child).joints.size() == 1 && std::abs(drive.axis.z()) > 0.5;
  }

  void delta() {
    std::size_t limbs = 0;
    while (limbs < drives_.size() && !is_telescope(*drives_[limbs])) ++limbs;
    if (drives_.size() - limbs > 1)
      refuse("the telescope's drive must be the last one", tree_.at(*drives_[limbs]),
             "call the limbs' drives drive1 to drive3");
    const bool telescope = limbs < drives_.size();
    if (declares_turning_plate() && limbs != 4)
      refuse(fmt::format("the type {} has four limbs, but {} found{}", tree_.declared_type, limbs,
                         telescope ? " and a telescope bar" : ""),
             tree_.where,
             fmt::format("{} (a limb is a drive on the base with two struts), or mend the type of <deltadyn>",
                         limbs < 4 ? "hang the missing limb on the base" : "take away what is too much on the base"));
    if (limbs != 3 && !(limbs == 4 && !telescope))
      refuse(fmt::format("three limbs expected, or four with an articulated plate, but {} found{}", limbs,
                         telescope ? " and a telescope bar" : ""),
             tree_.where,
             "a limb is a drive on the base with two struts; a CAD program's file is taken by delta-model adopt");
    robot_.drive_kind = drives_[0]->prismatic ? DriveKind::prismatic : DriveKind::revolute;
    robot_.type = limbs == 4  ? type_of_four_limbs()
                  : telescope ? "delta4"
                              : (drives_[0]->prismatic ? "linear-delta3" : "delta3");
    for (std::size_t i = 0; i < limbs; ++i) {
      if (drives_[i]->prismatic != drives_[0]->prismatic)
        refuse("the drives of the limbs are of different kinds", tree_.at(*drives_[i]),
               "make all of them revolute or all prismatic");
      robot_.limbs.push_back(limb_of(*drives_[i]));
      find_struts(*drives_[i]);
    }
    if (telescope && drives_[0]->prismatic)
      refuse("a telescope bar with prismatic drives is not a known type", tree_.at(*drives_[limbs]),
             "use revolute drives (delta4)");
    if (limbs == 4) {
      robot_.set_plate(plate_shape());
      articulated_plate::validate_shape(robot_, plate_element());
    } else {
      robot_.parts.emplace_back();
    }
    find_plate();
    for (const Loop& loop : tree_.loops) close(loop);
    for (std::size_t i = 0; i < limbs; ++i) parallelogram(i);
    if (telescope) {
      find_telescope(*drives_[limbs]);
    } else if (!tool_loops_.empty()) {
      refuse(fmt::format("link {} is not a strut", tool_loops_[0].other->link), tree_.at(*tool_loops_[0].loop),
             "the loops of a Delta without telescope bar join struts and plate");
    }
  }

  // --- articulated plate --------------------------------------------------------------------------
  /// By the type that the file gives itself.
  [[nodiscard]] bool declares_turning_plate() const {
    return visit_robot_type(
        tree_.declared_type, drives_[0]->prismatic ? DriveKind::prismatic : DriveKind::revolute,
        [](auto type) { return decltype(type)::kPlateTurns; }, [] { return false; });
  }

  /// What joins the parts of the plate is not told by the limbs.
  [[nodiscard]] std::string type_of_four_limbs() const {
    if (!declares_turning_plate())
      refuse(tree_.declared_type.empty()
                 ? std::string("a robot with four limbs, but no word on how its plate is made")
                 : fmt::format("a robot with four limbs, but its type {} says nothing on how its plate is made",
                               tree_.declared_type),
             tree_.where,
             fmt::format("write its type (one of {}) into <deltadyn type=\"...\"> with a <plate> as delta-model create "
                         "does",
                         articulated_type_names()));
    return tree_.declared_type;
  }

  [[nodiscard]] std::string plate_element() const {
    return fmt::format("{}, line {}, <plate> of <deltadyn>", tree_.where,
                       std::max(tree_.plate.line, tree_.extension_line));
  }

  [[nodiscard]] PlateShape plate_shape() const {
    const std::string where = plate_element();
    if (tree_.plate.line == 0)
      refuse("the lengths of the plate are missing", where, "write <plate> as delta-model create does");
    PlateShape shape;
    for (const auto& [key, value] : tree_.plate.attributes) {
      const auto* const number = std::ranges::find(robot_file::kPlateNumbers, key, &robot_file::PlateNumber::key);
      if (number != std::end(robot_file::kPlateNumbers)) {
        shape.*number->member = robot_file::parse_number(value, where, key);
      } else if (key == "tool" && (value == "centre" || value == "half_plate")) {
        shape.tool = value == "centre" ? ToolPlace::centre : ToolPlace::half_plate;
      } else {
        std::string known;
        for (const auto& one : robot_file::kPlateNumbers) known += fmt::format("{}, ", one.key);
        refuse(fmt::format("attribute '{}' of value '{}' is not known", key, value), where,
               fmt::format("known are {}and tool, which is centre or half_plate", known));
      }
    }
    return shape;
  }

  /// The plate's joints must be those that its lengths make: the file holds both, and one of them alone may be edited.
  void compare_plate() const {
    const UrdfTree made = robot_file::parse_urdf_tree(robot_to_urdf(robot_), tree_.where);
    const auto find = [](const UrdfTree& tree, const std::string& name) {
      return std::ranges::find(tree.joints, name, &Joint::name);
    };
    for (const robot_file::PlateBody& body : robot_file::plate_bodies(robot_)) {
      for (const robot_file::PlateJoint* one : {&body.swing, &body.level}) {
        const auto wanted = find(made, one->name), found = find(tree_, one->name);
        if (!one->moves()) {
          if (found != tree_.joints.end())
            refuse("this joint of the plate moves, but by the lengths and the ratio in <plate> it does not",
                   tree_.at(*found),
                   "mend the numbers of <plate> (a missing ratio is 1), or make the joint a fixed one");
          continue;
        }
        if (found == tree_.joints.end())
          refuse(fmt::format("joint {} of the plate is missing", one->name), tree_.where,
                 "write the plate's joints as delta-model create does");
        require_axis(*found, wanted->axis, wanted->prismatic, "this joint of the plate");
        require_turned_as(found->X_PJ, wanted->X_PJ, "this joint of the plate", tree_.at(*found));
        if ((found->X_PJ.translation() - wanted->X_PJ.translation()).norm() > kTolerance)
          refuse(fmt::format("this joint of the plate stands at {}, but the lengths in <plate> put it at {}",
                             words(found->X_PJ.translation()), words(wanted->X_PJ.translation())),
                 tree_.at(*found), "mend the joint's origin, or the numbers of <plate>");
        if (found->mimics != wanted->mimics || std::abs(found->mimic_offset) > kTolerance)
          refuse(wanted->mimics.empty()
                     ? std::string("the plate's angle is this joint's own, but it has a <mimic>")
                     : fmt::format("this joint of the plate must mimic {} without an offset", wanted->mimics),
                 tree_.at(*found),
                 wanted->mimics.empty() ? std::string("remove the <mimic> element")
                                        : fmt::format("write <mimic joint=\"{}\" multiplier=\"{:.9g}\"/>",
                                                      wanted->mimics, wanted->mimic_gain));
        if (std::abs(found->mimic_gain - wanted->mimic_gain) > kTolerance)
          refuse(
              fmt::format("this joint of the plate mimics another {:.6g}-fold, but by <plate> it moves {:.6g} times as "
                          "much",
                          found->mimic_gain, wanted->mimic_gain),
              tree_.at(*found), "mend the multiplier of <mimic>, or the numbers of <plate>");
        const DriveLimits &has = found->limits, &needs = wanted->limits;
        const auto differ = [](double one_limit, double other) {
          return std::isfinite(one_limit) && std::isfinite(other) && std::abs(one_limit - other) > kTolerance;
        };
        if (differ(has.lower, needs.lower) || differ(has.upper, needs.upper))
          refuse(fmt::format("this joint of the plate goes from {:.6g} to {:.6g}, but by <plate> from {:.6g} to {:.6g}",
                             has.lower, has.upper, needs.lower, needs.upper),
                 tree_.at(*found), "mend range_rad of <plate>, which counts, and the limits of the plate's joints");
      }
      if (body.part > 0) compare_place(body.name, made);
    }
  }

  /// Where no joint of its own moves a part of the plate, a fixed one must hold it in the place that the lengths say.
  void compare_place(const std::string& link, const UrdfTree& made) const {
    const auto found = tree_.links.find(link);
    if (found == tree_.links.end())
      refuse(fmt::format("link {} of the plate is missing", link), tree_.where,
             "name the links of the plate as delta-model create does");
    const robot_file::LinkPlace &has = found->second, &needs = made.links.at(link);
    const std::string &on = tree_.body(has.body).name, &meant = made.body(needs.body).name;
    if (on != meant)
      refuse(fmt::format("this part of the plate moves with link {}, but must move with {}", on, meant), tree_.at(link),
             "mend the parent of its joint");
    require_turned_as(has.X_BL, needs.X_BL, "this part of the plate", tree_.at(link));
    const Pose between = needs.X_BL.inverse() * has.X_BL;
    if (between.translation().norm() > kTolerance)
      refuse(fmt::format("this part of the plate stands {:.6g} m beside the place that the lengths in <plate> say",
                         between.translation().norm()),
             tree_.at(link), "mend the origin of its fixed joint, or the numbers of <plate>");
  }

  static void require_turned_as(const Pose& has, const Pose& needs, const std::string& what, const std::string& where) {
    if ((has.linear() - needs.linear()).norm() <= kTolerance) return;
    refuse(what + " is turned otherwise than <plate> says", where,
           "set the rpy of its joint's origin as delta-model create does, or mend azimuth_rad of <plate>");
  }

  /// The part of the plate that a limb may end on, by body.
  struct PlateEnd {
    int body = -1, part = 0;
    Pose X_BP = Pose::Identity();  ///< frame parallel to W in the plate's middle, at the part's origin
  };

  void add_plate_end(const std::string& link, int part) {
    const auto place = tree_.links.find(link);
    if (place == tree_.links.end())
      refuse(fmt::format("the plate has no link {}", link), tree_.where,
             "name the links of the plate as delta-model create does");
    PlateEnd end{.body = place->second.body, .part = part, .X_BP = place->second.X_BL};
    end.X_BP.rotate(Eigen::AngleAxisd(-robot_.parts[static_cast<std::size_t>(part)].turn, Vec::UnitZ()));
    plate_ends_.push_back(end);
  }

  void find_struts(const Joint& drive) {
    const robot_file::Body& arm = tree_.body(drive.child);
    if (arm.joints.size() != 2)
      refuse(fmt::format("{} moving joints hang on this link, but an upper arm or carriage carries two struts",
                         arm.joints.size()),
             tree_.at(arm.name), kMendTree);
    std::vector<Strut> pair;
    for (const int index : arm.joints) {
      const Joint& about_y = tree_.joint(index);
      require_passive(about_y, Vec::UnitY(), "a strut's first joint");
      const Joint& about_z = only_joint(about_y.child, "a strut's first joint carries its second");
      require_passive(about_z, Vec::UnitZ(), "a strut's second joint");
      require_no_offset(about_z, "a strut's second joint");
      pair.push_back(
          {.body = about_z.child, .name = tree_.body(about_z.child).name, .elbow = about_y.X_PJ.translation()});
    }
    if (pair[0].elbow.y() < pair[1].elbow.y()) std::swap(pair[0], pair[1]);
    const Vec across = pair[0].elbow - pair[1].elbow;
    if (across.y() < kTolerance || std::hypot(across.x(), across.z()) > kTolerance)
      refuse(fmt::format("the elbow joints of its two struts must lie apart along y of the limb, but they are {} apart",
                         words(across)),
             tree_.at(arm.name), "mend the origins of the struts' first joints");
    struts_.insert(struts_.end(), pair.begin(), pair.end());
  }

  /// The plate hangs on one strut by joints about z and y; the other struts reach it by loops.
  void find_plate() {
    std::size_t carrier = struts_.size();
    for (std::size_t k = 0; k < struts_.size(); ++k) {
      if (tree_.body(struts_[k].body).joints.empty()) continue;
      if (carrier < struts_.size())
        refuse(fmt::format("the plate hangs on this strut and on {}", struts_[carrier].name), tree_.at(struts_[k].name),
               "a tree has one path to the plate; close the other by a <loop>");
      carrier = k;
    }
    if (carrier == struts_.size())
      refuse("no strut carries the plate", tree_.where, "hang it on strut1a by joints about z, then y");
    Strut& strut = struts_[carrier];
    const Joint& about_z = only_joint(strut.body, "the strut carries the plate only");
    require_passive(about_z, Vec::UnitZ(), "the joint between strut and plate");
    const Joint& about_y = only_joint(about_z.child, "the plate's first joint carries its second");
    require_passive(about_y, Vec::UnitY(), "the plate's second joint");
    require_no_offset(about_y, "the plate's second joint");
    plate_ = about_y.child;
    strut.closed = true;
    strut.end = about_z.X_PJ.translation();
    if (robot_.plate) {
      const std::vector<robot_file::PlateBody> bodies = robot_file::plate_bodies(robot_);
      for (int half : {0, 1}) add_plate_end(bodies[static_cast<std::size_t>(half)].name, half);
    } else {
      find_centre();
    }
    const auto end = std::ranges::find(plate_ends_, plate_, &PlateEnd::body);
    if (end == plate_ends_.end() || end->part != 0 || carrier != 0)
      refuse("the plate must hang on the first strut of limb 1 by its first half", tree_.at(about_z),
             "write the file as delta-model create does");
    require_parallel(limb_frame(robot_.limbs[carrier / 2]) * end->X_BP.linear(), tree_.at(tree_.body(plate_).name),
                     "the plate's frame");
    strut.part = end->part;
    strut.p_BE = end->X_BP.inverse().translation();
  }

  /// The one part of a Delta's plate.
  void find_centre() {
    if (!tree_.body(plate_).joints.empty())
      refuse("a Delta's plate carries no moving joint", tree_.at(tree_.joint(tree_.body(plate_).joints[0])),
             "the tool hangs on the telescope bar");

    // The loops say which link of the plate has its frame at the plate's centre.
    std::string frame;
    for (const Loop& loop : tree_.loops)
      for (const robot_file::LoopEnd* end : {&loop.predecessor, &loop.successor}) {
        if (tree_.links.at(end->link).body != plate_) continue;
        if (!frame.empty() && frame != end->link)
          refuse(fmt::format("it ends on {}, but another loop on {}", end->link, frame), tree_.at(loop),
                 "let all loops name the same link of the plate");
        frame = end->link;
      }
    if (frame.empty())
      refuse(fmt::format("missing loop: no loop ends on the plate ({})", tree_.body(plate_).name), tree_.where,
             "add a spherical <loop> for each other strut");
    add_plate_end(frame, 0);
  }

  void close(const Loop& loop) {
    const robot_file::LoopEnd* on_plate = &loop.predecessor;
    const robot_file::LoopEnd* other = &loop.successor;
    const auto part_of = [this](const robot_file::LoopEnd* end) {
      return std::ranges::find(plate_ends_, tree_.links.at(end->link).body, &PlateEnd::body);
    };
    if (part_of(on_plate) == plate_ends_.end()) std::swap(on_plate, other);
    const auto part = part_of(on_plate);
    if (part == plate_ends_.end())
      refuse(fmt::format("neither {} nor {} is the plate{}", on_plate->link, other->link,
                         robot_.plate ? ", or not a part of it that may hold a limb" : ""),
             tree_.at(loop),
             robot_.plate ? "a limb ends on half_plate1 or half_plate2, which only translate"
                          : "a Delta's loops end on the plate");
    const robot_file::LinkPlace& place = tree_.links.at(other->link);
    const auto strut = std::ranges::find_if(struts_, [&](const Strut& s) { return s.body == place.body; });
    if (strut == struts_.end()) {
      tool_loops_.push_back({&loop, on_plate, other});
      return;
    }
    if (loop.type != "spherical")
      refuse(fmt::format("a strut ends in a ball joint, but the loop's type is {}", loop.type), tree_.at(loop),
             "write type=\"spherical\"");
    if (strut->closed)
      refuse(fmt::format("the end of {} is closed already", strut->name), tree_.at(loop), "remove one of the two");
    strut->closed = true;
    strut->end = (place.X_BL * other->X_LO).translation();
    strut->part = part->part;
    strut->p_BE = part->X_BP.inverse() * (tree_.links.at(on_plate->link).X_BL * on_plate->X_LO.translation());
  }

  void parallelogram(std::size_t index) {
    LimbGeometry<double>& limb = robot_.limbs[index];
    const Strut& a = struts_[2 * index];
    const Strut& b = struts_[2 * index + 1];
    for (const Strut* strut : {&a, &b}) {
      if (!strut->closed)
        refuse("missing loop: the end of this strut is not joined to the plate", tree_.at(strut->name),
               fmt::format("add a spherical <loop> between {} and the plate", strut->name));
      if (strut->end.x() < kTolerance || strut->end.tail<2>().norm() > kTolerance)
        refuse(fmt::format("the strut's end is at {}, but must lie on +x of the strut", words(strut->end)),
               tree_.at(strut->name), "the strut's frame is at the elbow with x along the strut");
    }
    if (std::abs(a.end.x() - b.end.x()) > kTolerance)
      refuse(fmt::format("unequal struts of limb {}: {} is {:.9g} m long, {} is {:.9g} m", index + 1, a.name, a.end.x(),
                         b.name, b.end.x()),
             tree_.at(b.name), "mend the origin in its <loop>, or of the joint that carries the plate");
    const Vec at_elbow = a.elbow - b.elbow;
    const Vec y_L = limb_frame(limb).col(1);
    if (a.part != b.part)
      refuse(fmt::format("the two struts of limb {} end on different parts of the plate", index + 1), tree_.at(b.name),
             "let both end on the same half plate");
    limb.part = a.part;
    const Vec at_plate = a.p_BE - b.p_BE;
    if ((at_plate - at_elbow.y() * y_L).norm() > kTolerance)
      refuse(fmt::format("limb {} is no parallelogram: its struts are {} apart at the elbow, but {} at the plate (both "
                         "in the base frame)",
                         index + 1, words(at_elbow.y() * y_L), words(at_plate)),
             tree_.at(b.name), "mend the origins in its loops");
    limb.p_DE_0 = (a.elbow + b.elbow) / 2;
    if (robot_.drive_kind == DriveKind::revolute) {
      if (limb.p_DE_0.x() < kTolerance || limb.p_DE_0.tail<2>().norm() > kTolerance)
        refuse(fmt::format("the elbow is at {}, but must lie on +x of the upper arm", words(limb.p_DE_0)),
               tree_.at(tree_.body(drives_[index]->child).name),
               "turn the zero of the drive, so that 0 is horizontal outwards");
      limb.p_DE_0.tail<2>().setZero();
    }
    limb.strut = (a.end.x() + b.end.x()) / 2;
    limb.strut_spacing = at_elbow.y();
    limb.p_BA = (a.p_BE + b.p_BE) / 2;
  }

  /// Two passive joints at one point. Returns the second.
  [[nodiscard]] const Joint& universal(const Joint& first, const Vec& first_axis, const Vec& second_axis,
                                       const std::string& name, const std::string& rule) const {
    require_passive(first, first_axis, name + "'s first axis");
    require_no_offset(first, name);
    const Joint& second = only_joint(first.child, rule);
    require_passive(second, second_axis, name + "'s second axis");
    require_no_offset(second, name);
    return second;
  }

  void find_telescope(const Joint& drive) {
    require_axis(drive, Vec::UnitZ(), false, "the telescope's drive");
    require_parallel(drive.X_PJ.linear(), tree_.at(drive), "the telescope drive's frame");
    const Joint& y = universal(only_joint(drive.child, "the drive carries the joint about x"), Vec::UnitX(),
                               Vec::UnitY(), "the upper universal joint", "the joint about x carries the one about y");
    const Joint& slide = only_joint(y.child, "the upper part of the bar carries the lower part");
    require_axis(slide, slide.axis.z() > 0 ? Vec(Vec::UnitZ()) : Vec(-Vec::UnitZ()), true, "the telescope joint");
    require_parallel(slide.X_PJ.linear(), tree_.at(slide), "the lower part of the bar");
    if (slide.X_PJ.translation().head<2>().norm() > kTolerance)
      refuse("the lower part of the bar must lie on z of the upper part", tree_.at(slide),
             "set x and y of the origin to 0");
    const Joint& x2 =
        universal(only_joint(slide.child, "the lower part of the bar carries the lower universal joint"), Vec::UnitY(),
                  Vec::UnitX(), "the lower universal joint", "the joint about y carries the one about x");
    const robot_file::Body& tool = tree_.body(x2.child);
    if (!tool.joints.empty())
      refuse("the tool carries no moving joint", tree_.at(tree_.joint(tool.joints[0])),
             "fix to the tool what moves with it");

    const ToolLoop* closure = nullptr;
    for (const ToolLoop& candidate : tool_loops_) {
      if (tree_.links.at(candidate.other->link).body != x2.child)
        refuse(fmt::format("link {} is neither a strut nor the tool", candidate.other->link), tree_.at(*candidate.loop),
               "let the loop join the plate with a strut or the tool");
      if (closure != nullptr)
        refuse("the tool is joined to the plate twice", tree_.at(*candidate.loop), "remove one of the two");
      closure = &candidate;
    }
    if (closure == nullptr)
      refuse("missing loop: the tool is not joined to the plate", tree_.at(tool.name),
             "add a revolute <loop> about z between plate and tool");
    const Loop& loop = *closure->loop;
    if (loop.type != "revolute" && loop.type != "continuous")
      refuse(fmt::format("the tool turns on the plate, but the loop's type is {}", loop.type), tree_.at(loop),
             "write type=\"revolute\"");
    if (std::abs(std::abs(loop.axis.z()) - 1) > kTolerance)
      refuse(fmt::format("wrong axis: the tool turns about {} of the plate, but must turn about z", words(loop.axis)),
             tree_.at(loop), "write <axis xyz=\"0 0 1\"/>");
    const Pose& X_MT = tree_.links.at(closure->other->link).X_BL;
    require_parallel(X_MT.linear(), tree_.at(closure->other->link), "the tool's frame");
    const Vec p_TV = X_MT.inverse().translation();
    const Vec p_TO = closure->other->X_LO.translation();
    if (p_TV.head<2>().norm() > kTolerance || p_TO.head<2>().norm() > kTolerance)
      refuse("the tool's axis must pass through the lower universal joint of the bar", tree_.at(loop),
             "set x and y of the tool's origins to 0");
    TelescopeGeometry<double>& bar = robot_.telescope.emplace();
    bar.p_WU = drive.X_PJ.translation();
    bar.p_BV = closure->on_plate->X_LO.translation() + Vec(0, 0, p_TV.z() - p_TO.z());
  }

  // --- inertials --------------------------------------------------------------------------------
  /// They are not used here, but masses in grams say that the file is not in SI units.
  void inertials() const {
    for (const auto& [name, inertial] : tree_.inertials) {
      const robot_file::LinkPlace& place = tree_.links.at(name);
      if (place.body == 0) continue;  // the base may weigh what it likes, and so may the rotor that rests on it
      if (robot_.telescope && place.body == drives_.back()->child) continue;
      plausibility::require_body(robot_, role_of(place.body), inertial.in_frame(place.X_BL), "link " + name,
                                 tree_.where);
    }
  }

  [[nodiscard]] Body role_of(int index) const {
    for (std::size_t i = 0; i < robot_.limbs.size(); ++i)
      if (drives_[i]->child == index) return Body::upper_arm;
    if (index == plate_) return Body::platform;
    if (robot_.plate && std::ranges::none_of(struts_, [index](const Strut& s) { return s.body == index; }))
      return Body::platform;
    for (const Strut& strut : struts_)
      if (strut.body == index) return Body::strut;
    return Body::telescope_upper;
  }

  // --- extension ------------------------------------------------------------------------------------
  void extension() {
    if (!tree_.declared_type.empty() && tree_.declared_type != robot_.type)
      refuse(
          fmt::format("<deltadyn> says type {}, but the joints and loops make a {}", tree_.declared_type, robot_.type),
          fmt::format("{}, line {}", tree_.where, tree_.extension_line), "mend the type or the tree");
    for (const robot_file::DriveNote& note : tree_.drives) {
      const std::string where = fmt::format("{}, line {}, <drive> of <deltadyn>", tree_.where, note.line);
      const auto drive = std::ranges::find(drives_, note.joint, &Joint::name);
      const auto index = static_cast<std::size_t>(drive - drives_.begin());
      if (index == drives_.size())
        refuse("it names no drive of this robot", where, "write joint=\"drive1\" or another drive");
      const char* acceleration = robot_file::acceleration_attribute((*drive)->prismatic);
      for (const auto& [key, value] : note.attributes) {
        const double number = robot_file::parse_number(value, where, key);
        if (key == acceleration) {
          robot_.limits[index].acceleration = number;
        } else if (key == "elbow" && index < robot_.limbs.size()) {
          robot_.limbs[index].elbow = number;
        } else {
          refuse(fmt::format("attribute '{}' is not known for this drive", key), where,
                 fmt::format("known are elbow and {}", acceleration));
        }
      }
    }
  }

  struct ToolLoop {
    const Loop* loop;
    const robot_file::LoopEnd* on_plate;
    const robot_file::LoopEnd* other;
  };

  const UrdfTree& tree_;
  RobotDescription robot_;
  std::vector<const Joint*> drives_;
  std::vector<Strut> struts_;  ///< two a limb, the one at +y first
  int plate_ = -1;
  std::vector<PlateEnd> plate_ends_;
  std::vector<ToolLoop> tool_loops_;
};

}  // namespace

RobotDescription robot_from_urdf(const std::string& text, const std::string& where) {
  UrdfTree tree = robot_file::parse_urdf_tree(text, where);
  robot_file::require_metres(tree);
  robot_file::place_base(tree);
  return Reader(tree).run();
}

std::string read_robot_text(const std::string& path) {
  if (std::filesystem::is_directory(path)) throw Error("this is a folder", path, "give a URDF robot file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(fmt::format("cannot open the robot file ({})", std::strerror(errno)), path, "check the path");
  std::ostringstream text;
  text << file.rdbuf();
  if (file.bad()) throw Error("cannot read the robot file", path, "give a URDF file, not a folder");
  return text.str();
}

RobotDescription read_robot_file(const std::string& path) {
  return robot_from_urdf(read_robot_text(path), path);
}

}  // namespace deltadyn
