#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "deltadyn/model/body.hpp"

#include "adopt_parts.hpp"

namespace deltadyn::cad {
namespace {

using Ten = InertialVector<double>;

constexpr double kSame = 1e-3;  // limbs whose masses differ by less, relative, are alike

/// Turns and places a frame: x, y, z of the frame F in the root link's frame, and its origin.
Pose frame(const Eigen::Matrix3d& R, const Vec& origin) {
  Pose X = Pose::Identity();
  X.linear() = R;
  X.translation() = origin;
  return X;
}

class Collector {
 public:
  Collector(const UrdfTree& tree, const Parts& parts, Placed& placed) : tree_(tree), parts_(parts), placed_(placed) {}

  void run() {
    std::vector<Ten> arms, struts;
    for (std::size_t k = 0; k < placed_.order.size(); ++k) {
      arms.push_back(arm(k));
      struts.push_back(strut(k));
    }
    shared("upper_arm", arms);
    shared("strut", struts);
    const Eigen::Matrix3d R_W = placed_.X_RW.linear();
    put("platform", of_links(parts_.plate_links, frame(R_W, placed_.ends.plate_centre)));
    if (parts_.telescope) telescope(*parts_.telescope, R_W);
  }

 private:
  Ten of_links(const std::vector<std::string>& links, const Pose& X_RF) const {
    Ten sum = Ten::Zero();
    for (const std::string& link : links) {
      const auto found = tree_.inertials.find(link);
      if (found == tree_.inertials.end()) continue;
      sum += found->second.in_frame(X_RF.inverse() * link_pose(tree_, parts_.X_R, link));
    }
    return sum;
  }
  Ten of_bodies(const std::vector<int>& bodies, const Pose& X_RF) const {
    Ten sum = Ten::Zero();
    for (const int index : bodies) sum += of_links(tree_.body(index).links, X_RF);
    return sum;
  }

  [[nodiscard]] Eigen::Matrix3d limb_frame(std::size_t k) const {
    return placed_.X_RW.linear() * Eigen::AngleAxisd(placed_.robot.limbs[k].azimuth, Vec::UnitZ()).toRotationMatrix();
  }

  /// Upper arm: x along the arm, y the axis. Carriage: the limb's frame at the elbow, which is its origin.
  Ten arm(std::size_t k) const {
    const Limb& part = parts_.limbs[placed_.order[k]];
    const LimbGeometry<double>& limb = placed_.robot.limbs[k];
    Eigen::Matrix3d R = limb_frame(k);
    Vec origin = placed_.X_RW * limb.p_WD;
    if (placed_.robot.drive_kind == DriveKind::revolute) {
      R = R * Eigen::AngleAxisd(placed_.drives[k].offset, Vec::UnitY()).toRotationMatrix();
    } else {
      origin += limb_frame(k) * (placed_.drives[k].offset * limb.axis_L);
    }
    return of_bodies(part.arm, frame(R, origin));
  }

  /// Per strut: turned about y of the limb, then about the strut's own z, so that x points along it.
  Ten strut(std::size_t k) const {
    const std::size_t i = placed_.order[k];
    const Limb& part = parts_.limbs[i];
    const Eigen::Matrix3d R_L = limb_frame(k);
    const Vec d = R_L.transpose() * placed_.ends.directions[i];
    const Eigen::Matrix3d R = R_L * (Eigen::AngleAxisd(std::atan2(-d.z(), d.x()), Vec::UnitY()) *
                                     Eigen::AngleAxisd(std::asin(std::clamp(d.y(), -1.0, 1.0)), Vec::UnitZ()))
                                        .toRotationMatrix();
    Ten sum = Ten::Zero();
    for (const Strut& s : part.struts) sum += of_bodies(s.bodies, frame(R, s.elbow));
    if (part.struts.size() == 1) sum = without_spread(sum, placed_.robot.limbs[k].strut_spacing / 2);
    return sum / 2;
  }

  /// Two rods drawn as one link: each turns about its own elbow, so their distance from the middle does not count.
  Ten without_spread(const Ten& p, double half) const {
    PseudoInertia<double> M = to_pseudo_inertia(p);
    const double across = M(1, 1) - p(inertial::kM) * half * half;
    if (!(across > 0)) return p;  // the link was drawn as one rod in the middle
    M(1, 1) = across;
    return from_pseudo_inertia<double>(M);
  }

  void telescope(const Telescope& bar, const Eigen::Matrix3d& R_W) {
    // Along the bar, upwards; turned about x, then y.
    const Vec b = (R_W.transpose() * (bar.upper_joint - bar.lower_joint)).normalized();
    const Eigen::Matrix3d R = R_W * (Eigen::AngleAxisd(std::atan2(-b.y(), b.z()), Vec::UnitX()) *
                                     Eigen::AngleAxisd(std::asin(std::clamp(b.x(), -1.0, 1.0)), Vec::UnitY()))
                                        .toRotationMatrix();
    put("telescope_upper", of_bodies(bar.upper, frame(R, bar.upper_joint)));
    put("telescope_lower", of_bodies(bar.lower, frame(R, bar.lower_joint)));
    const Vec tool = bar.lower_joint - R_W * Vec(0, 0, placed_.robot.telescope->p_BV.z());
    put("tool", of_bodies(bar.tool, frame(R_W, tool)));
    const Ten yoke = of_bodies(bar.yoke, frame(R_W, bar.upper_joint));
    if (yoke(inertial::kIzz) > 0) placed_.parameters["drive4.rotor_inertia"] = yoke(inertial::kIzz);
  }

  void put(const std::string& name, const Ten& p) {
    if (!(p(inertial::kM) > 0)) {
      placed_.notes.push_back(fmt::format("the links of {} have no mass", name));
      return;
    }
    if (!is_physically_consistent<double>(p)) {
      placed_.notes.push_back(
          fmt::format("mass and inertia of {} are not those of a body (no inertia, or one that breaks the triangle "
                      "rule); they are left out",
                      name));
      return;
    }
    for (int k = 0; k < kInertialParameters; ++k) placed_.parameters[name + "." + kInertialNames[k]] = p(k);
  }

  /// The mean of three like limbs under the shared name, else each under its own.
  void shared(const std::string& name, const std::vector<Ten>& limbs) {
    Ten mean = Ten::Zero();
    for (const Ten& p : limbs) mean += p / static_cast<double>(limbs.size());
    const double scale = mean.cwiseAbs().maxCoeff();
    double worst = 0;
    for (const Ten& p : limbs) worst = std::max(worst, (p - mean).cwiseAbs().maxCoeff());
    put(name, mean);
    if (worst <= kSame * scale || !(mean(inertial::kM) > 0)) return;
    placed_.notes.push_back(
        fmt::format("the limbs' {} are not alike; their mean stands for all", name == "strut" ? "struts" : "arms"));
  }

  const UrdfTree& tree_;
  const Parts& parts_;
  Placed& placed_;
};

}  // namespace

void add_masses(const UrdfTree& tree, const Parts& parts, Placed& placed) {
  Collector(tree, parts, placed).run();
}

}  // namespace deltadyn::cad
