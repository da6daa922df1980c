#include "adopt_parts.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

#include "deltadyn/runtime/geometry_of.hpp"

namespace deltadyn::cad {
namespace {

using robot_file::Body;

constexpr double kSlim = 0.5;     // a rod's smallest moment of inertia against the next one; real rods have 0.01
constexpr double kAgree = 0.05;   // [rad] between the rod's axis of inertia and the line through its centre of mass
constexpr int kFarthestRoot = 8;  // moving joints between the root and the base; more is a chain of something else

class Finder {
 public:
  Finder(const UrdfTree& tree, const AdoptOptions& options) : tree_(tree), options_(options) {
    parts_.X_R.assign(tree.bodies.size(), Pose::Identity());
    // A body stands behind its parent in the list.
    for (const Joint& j : tree.joints) parts_.X_R[static_cast<std::size_t>(j.child)] = pose(j.parent) * j.X_PJ;
  }

  Parts run() {
    find_base();
    sort_children();
    if (parts_.limbs.size() != 3) refuse_limbs();
    const bool prismatic = parts_.limbs.front().drive->prismatic;
    for (const Limb& limb : parts_.limbs)
      if (limb.drive->prismatic != prismatic)
        refuse("the drives of the limbs are of different kinds", tree_.at(*limb.drive), "name the drives by --drives");
    if (parts_.telescope && prismatic)
      refuse("a telescope bar with prismatic drives is not a known type", tree_.at(*parts_.telescope->drive),
             "name the drives by --drives");
    find_plate();
    return parts_;
  }

 private:
  // --- access --------------------------------------------------------------------------------------
  [[nodiscard]] const Pose& pose(int index) const { return parts_.X_R[static_cast<std::size_t>(index)]; }
  [[nodiscard]] Vec place(const Joint& j) const { return (pose(j.parent) * j.X_PJ).translation(); }
  [[nodiscard]] Vec axis(const Joint& j) const { return (pose(j.parent) * j.X_PJ).linear() * j.axis; }

  /// Joints to the children that hold something.
  [[nodiscard]] std::vector<const Joint*> children(int index) const {
    std::vector<const Joint*> list;
    for (const int k : tree_.body(index).joints)
      if (!tree_.joint(k).floating) list.push_back(&tree_.joint(k));
    return list;
  }

  // --- base and drives ----------------------------------------------------------------------------
  /// The body nearest to the root that carries three joints or more.
  void find_base() {
    std::vector<int> level = {0};
    for (int depth = 0; depth < kFarthestRoot && !level.empty(); ++depth) {
      std::vector<int> next;
      for (const int index : level) {
        if (children(index).size() >= 3) {
          base_ = index;
          return;
        }
        for (const int k : tree_.body(index).joints) next.push_back(tree_.joint(k).child);
      }
      level = next;
    }
    refuse("no link carries three moving joints, so there is no base with three drives", tree_.where,
           tree_.joints.size() == 1 ? "a single drive is made by delta-model create axis"
                                    : "hang the three arms or carriages on the base by revolute or prismatic joints");
  }

  /// The chain below a joint if no body in it carries two joints, else empty.
  [[nodiscard]] std::vector<const Joint*> chain(const Joint& first) const {
    std::vector<const Joint*> joints;
    for (const Joint* j = &first;;) {
      const auto next = children(j->child);
      if (next.size() > 1) return {};
      if (next.empty()) return joints;
      joints.push_back(next.front());
      j = next.front();
    }
  }

  void sort_children() {
    std::vector<const Joint*> candidates = children(base_);
    if (!options_.drives.empty()) {
      std::vector<const Joint*> named;
      for (const std::string& name : options_.drives) {
        const auto found = std::ranges::find(candidates, name, &Joint::name);
        if (found == candidates.end())
          refuse(fmt::format("'{}' is no joint on the base, {}; these are: {}", name, tree_.body(base_).name,
                             names(candidates)),
                 "--drives", "name three or four of them", ExitCode::usage);
        named.push_back(*found);
      }
      candidates = named;
    }
    for (const Joint* j : candidates) {
      const auto below = chain(*j);
      const auto slides = std::ranges::count_if(below, &Joint::prismatic);
      if (!j->prismatic && slides == 1) {
        add_telescope(*j, below);
      } else if (children(j->child).empty()) {
        parts_.notes.push_back(fmt::format("joint {} on the base carries nothing that moves; it is left out", j->name));
      } else if (j->prismatic && !below.empty() && slides == static_cast<long>(below.size())) {
        loose_.push_back(below.back()->child);  // the plate on three slides, as some exporters hang it
      } else {
        add_limb(*j);
      }
    }
  }

  [[nodiscard]] static std::string names(const std::vector<const Joint*>& joints) {
    std::vector<std::string> list;
    for (const Joint* j : joints) list.push_back(j->name);
    return fmt::format("{}", fmt::join(list, ", "));
  }

  [[noreturn]] void refuse_limbs() const {
    std::vector<const Joint*> drives;
    for (const Limb& limb : parts_.limbs) drives.push_back(limb.drive);
    const std::string found = names(drives), all = names(children(base_));
    if (parts_.limbs.size() == 4)
      refuse(
          fmt::format("four limbs found ({}); how their plate is made is not told by the file", found),
          tree_.at(tree_.body(base_).name),
          fmt::format("make the robot file by delta-model create, type {}; if one of them is no limb, name the drives: "
                      "--drives A,B,C out of {}",
                      articulated_type_names(), all));
    refuse(fmt::format("three limbs expected (a joint on the base whose link carries struts), but {} found{}{}",
                       drives.size(), drives.empty() ? "" : ": ", found),
           tree_.at(tree_.body(base_).name),
           fmt::format("hang the struts on the arms, or name the drives: --drives A,B,C out of {}", all));
  }

  // --- limbs --------------------------------------------------------------------------------------
  void add_limb(const Joint& drive) {
    Limb limb{&drive, axis(drive), place(drive), {drive.child}, {}};
    for (const Joint* j : children(drive.child)) collect_strut(*j, limb);
    if (limb.struts.empty() || limb.struts.size() > 2)
      refuse(fmt::format("an arm or carriage carries one strut or two, but this one carries {}", limb.struts.size()),
             tree_.at(tree_.body(drive.child).name),
             "leave springs and covers between the struts out of the tree, or fix them to a strut");
    parts_.limbs.push_back(limb);
  }

  /// Follows the joints that meet in the elbow's ball to the rod.
  void collect_strut(const Joint& first, Limb& limb) {
    Strut strut;
    strut.elbow = place(first);
    strut.first_axis = first.prismatic ? Vec(Vec::Zero()) : axis(first);
    int b = first.child;
    strut.bodies.push_back(b);
    std::vector<const Joint*> next = children(b);
    while (next.size() == 1 && (place(*next.front()) - strut.elbow).norm() < kPoint) {
      b = next.front()->child;
      strut.bodies.push_back(b);
      next = children(b);
    }
    if (next.size() == 2) {
      // A crosspiece on the elbow's axis with a rod at each end.
      const Vec one = place(*next[0]), two = place(*next[1]);
      if (((one + two) / 2 - strut.elbow).norm() < kPoint && (one - two).norm() > kPoint) {
        limb.arm.insert(limb.arm.end(), strut.bodies.begin(), strut.bodies.end());
        parts_.notes.push_back(fmt::format("link {} joins the two struts at the elbow; its mass is counted to the arm",
                                           tree_.body(b).name));
        for (const Joint* j : next) collect_strut(*j, limb);
        return;
      }
    }
    strut.name = tree_.body(b).name;
    if (next.size() > 1)
      refuse(fmt::format("{} moving joints hang on this strut ({}), but it carries nothing but the plate", next.size(),
                         names(next)),
             tree_.at(strut.name), "fix what belongs to the strut to it by fixed joints");
    if (next.size() == 1) {
      strut.end = place(*next.front());
      hung_plates_.push_back(next.front());
    }
    find_end(strut);
    limb.struts.push_back(strut);
  }

  /// A frame at the rod's end, else the direction of the rod.
  void find_end(Strut& strut) const {
    const int rod = strut.bodies.back();
    Vec frame = Vec::Zero();
    InertialVector<double> sum = InertialVector<double>::Zero();
    double farthest = 10 * kPoint;
    for (const std::string& link : tree_.body(rod).links) {
      const Pose X_RL = link_pose(tree_, parts_.X_R, link);
      const auto inertial = tree_.inertials.find(link);
      if (inertial != tree_.inertials.end() && inertial->second.mass > 0) {
        sum += inertial->second.in_frame(X_RL);
        continue;
      }
      const double distance = (X_RL.translation() - strut.elbow).norm();
      if (link == tree_.body(rod).name || distance < farthest || strut.end) continue;
      farthest = distance;
      frame = X_RL.translation();
    }
    if (!strut.end && farthest > 10 * kPoint) strut.end = frame;
    for (const robot_file::Loop& loop : tree_.loops)
      for (const robot_file::LoopEnd* end : {&loop.predecessor, &loop.successor})
        if (!strut.end && tree_.links.at(end->link).body == rod)
          strut.end = (link_pose(tree_, parts_.X_R, end->link) * end->X_LO).translation();
    if (sum(0) > 0) strut.direction = direction_of(strut, sum);
  }

  [[nodiscard]] static std::optional<Vec> direction_of(const Strut& strut, const InertialVector<double>& p) {
    const robot_file::LinkInertial central = robot_file::central_inertial(p);
    const Vec arm = central.X_LC.translation() - strut.elbow;
    if (arm.norm() < 10 * kPoint) return std::nullopt;
    const Eigen::Matrix3d& I = central.I_C;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(I);
    // Where the tensor tells the rod's axis, it must be the line through the centre of mass: else that centre lies
    // beside the rod.
    if (principal.eigenvalues()(0) < kSlim * principal.eigenvalues()(1)) {
      const double across = principal.eigenvectors().col(0).cross(arm.normalized()).norm();
      if (across > kAgree) return std::nullopt;
    }
    return arm.normalized();
  }

  // --- telescope bar ------------------------------------------------------------------------------
  void add_telescope(const Joint& drive, const std::vector<const Joint*>& below) {
    if (parts_.telescope)
      refuse(fmt::format("joint {} carries a telescope bar, too", parts_.telescope->drive->name), tree_.at(drive),
             "name the four drives by --drives");
    const auto slide = std::ranges::find_if(below, &Joint::prismatic);
    if (slide == below.begin())
      refuse("the telescope bar hangs on a universal joint, but here the sliding joint follows the drive",
             tree_.at(**slide), "put two revolute joints (about x, then y) between drive and bar");
    if (slide + 1 == below.end())
      refuse("the telescope bar ends in a universal joint that carries the tool, but nothing follows the sliding joint",
             tree_.at(**slide), "hang the tool on the bar's lower part by two revolute joints");
    Telescope& bar = parts_.telescope.emplace();
    bar.drive = &drive;
    bar.axis = axis(drive);
    bar.place = place(drive);
    bar.upper_joint = place(**below.begin());
    bar.lower_joint = place(**(slide + 1));
    const auto meet = [&](auto from, auto to, const Vec& point, const char* what) {
      for (auto j = from; j != to; ++j)
        if ((place(**j) - point).norm() > kPoint)
          refuse(fmt::format("{}: its axes must meet, but this one lies {:.6g} beside it", what,
                             (place(**j) - point).norm()),
                 tree_.at(**j), "mend the joint's origin");
    };
    meet(below.begin(), slide, bar.upper_joint, "the upper universal joint");
    meet(slide + 1, below.end(), bar.lower_joint, "the lower universal joint");
    bar.yoke = {drive.child};
    for (auto j = below.begin(); j != slide; ++j) bar.upper.push_back((*j)->child);
    bar.lower = {(*slide)->child};
    for (auto j = slide + 1; j != below.end(); ++j) bar.tool.push_back((*j)->child);
  }

  // --- plate --------------------------------------------------------------------------------------
  void add_with_children(int index, const Vec& ball) {
    for (const std::string& link : tree_.body(index).links) parts_.plate_links.push_back(link);
    for (const Joint* j : children(index)) {
      if ((place(*j) - ball).norm() > kPoint)
        parts_.notes.push_back(
            fmt::format("joint {} on the plate is taken as fixed; what hangs on it moves with the plate", j->name));
      add_with_children(j->child, ball);
    }
  }

  void find_plate() {
    if (hung_plates_.size() > 1)
      refuse(fmt::format("the plate hangs on one strut, but joints {} hang on struts", names(hung_plates_)),
             tree_.where, "a tree has one path to the plate; leave the other joint out");
    if (!hung_plates_.empty()) {
      const Joint& first = *hung_plates_.front();
      add_with_children(first.child, place(first));
      return;
    }
    for (const Joint& j : tree_.joints)
      if (j.floating && children(j.child).empty()) loose_.push_back(j.child);
    if (!options_.plate.empty()) {
      plate_by_name();
    } else if (loose_.size() == 1) {
      const int index = loose_.front();
      parts_.plate_links = tree_.body(index).links;
      parts_.plate_place = pose(index).translation();
    } else {
      std::vector<std::string> found;
      for (const int index : loose_) found.push_back(tree_.body(index).name);
      refuse(loose_.empty()
                 ? std::string("no strut carries a plate, and no link hangs loose that could be it")
                 : fmt::format("no strut carries a plate, and several links hang loose: {}", fmt::join(found, ", ")),
             tree_.where, "name a link of the plate: --plate LINK", ExitCode::usage);
    }
    parts_.notes.push_back(fmt::format("plate: {}, which no strut carries", parts_.plate_links.front()));
  }

  /// The named link and all that fixed joints hold on it; it may be fixed to the base.
  void plate_by_name() {
    const auto found = tree_.links.find(options_.plate);
    if (found == tree_.links.end())
      refuse(fmt::format("there is no link '{}'", options_.plate), "--plate", "name a link of the file",
             ExitCode::usage);
    std::set<std::string> taken = {options_.plate};
    for (bool more = true; more;) {
      more = false;
      for (const auto& [link, place] : tree_.links)
        if (taken.count(place.parent) > 0 && taken.insert(link).second) more = true;
    }
    parts_.plate_links.assign(taken.begin(), taken.end());
    parts_.plate_place = link_pose(tree_, parts_.X_R, options_.plate).translation();
  }

  const UrdfTree& tree_;
  const AdoptOptions& options_;
  Parts parts_;
  int base_ = 0;
  std::vector<const Joint*> hung_plates_;  ///< joints at the far ends of struts
  std::vector<int> loose_;                 ///< bodies that may be the plate
};

}  // namespace

Pose link_pose(const UrdfTree& tree, const std::vector<Pose>& X_R, const std::string& link) {
  const robot_file::LinkPlace& place = tree.links.at(link);
  return X_R[static_cast<std::size_t>(place.body)] * place.X_BL;
}

Parts find_parts(const UrdfTree& tree, const AdoptOptions& options) {
  return Finder(tree, options).run();
}

}  // namespace deltadyn::cad
