#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "deltadyn/runtime/dense.hpp"

#include "adopt_parts.hpp"

namespace deltadyn::cad {
namespace {

constexpr double kClosure = 3e-4;    // of the strut's length: a pose of the CAD that closes to this is assembled
constexpr double kDirection = 0.02;  // [rad] between the strut that closes and the line through its centre of mass
constexpr double kDegenerate = 1e-3;
// A strut this flat on the plane of the elbows is a tree whose passive joints are at zero
constexpr double kFlat = 0.02;
constexpr double kLevel = 2e-3;  // [m] attachments of one plate, by centres of mass with four digits

[[noreturn]] void ask(const std::string& what, const std::string& mend) {
  throw Error(what, "", mend, ExitCode::usage);
}

/// Unit vector from the elbow to the plate where both struts that tell it agree.
std::optional<Vec> direction_of(const Limb& limb) {
  Vec sum = Vec::Zero();
  for (const Strut& strut : limb.struts)
    if (strut.direction) sum += *strut.direction;
  if (sum.norm() < 0.5) return std::nullopt;
  return sum.normalized();
}

class Solver {
 public:
  Solver(const UrdfTree& tree, const Parts& parts, const AdoptOptions& options, const std::vector<LimbPlace>& limbs,
         const Vec& up)
      : tree_(tree), parts_(parts), options_(options), limbs_(limbs), up_(up), ends_(limbs.size()) {}

  Attachments run() {
    known_ends();
    if (known() == limbs_.size() && alike()) return finish("");
    if (known() > 0) {
      if (auto found = by_closure()) return *found;
      if (auto found = by_direction(length_of_known())) return *found;
      return by_lengths();
    }
    if (!options_.strut && parts_.plate_place && options_.platform_radius) return by_radius();
    const double length = options_.strut ? *options_.strut : length_of_three();
    if (auto found = by_direction(length)) return *found;
    ask(fmt::format("the ends of the struts cannot be found: no strut carries the plate, and with struts of {:.6g} m "
                    "along their centres of mass the three limbs do not end alike",
                    length),
        "give --platform-radius if the origin of the plate's link is its centre, or hang the plate on a strut");
  }

 private:
  [[nodiscard]] std::size_t known() const {
    return static_cast<std::size_t>(std::ranges::count_if(ends_, [](const auto& a) { return a.has_value(); }));
  }
  [[nodiscard]] std::size_t first_known() const {
    return static_cast<std::size_t>(std::ranges::find_if(ends_, [](const auto& a) { return a.has_value(); }) -
                                    ends_.begin());
  }
  [[nodiscard]] double length_of_known() const { return (*ends_[first_known()] - limbs_[first_known()].elbow).norm(); }

  /// Ends that the tree shows; the struts of a limb are parallel, so one tells both.
  void known_ends() {
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      Vec sum = Vec::Zero();
      int count = 0;
      for (const Strut& strut : parts_.limbs[i].struts) {
        if (!strut.end) continue;
        sum += limbs_[i].elbow + (*strut.end - strut.elbow);
        ++count;
      }
      if (count > 0) ends_[i] = sum / count;
    }
  }

  /// The plate's limbs point as the base's do.
  [[nodiscard]] Vec middle_of_ends() const {
    if (!options_.plate_frame.empty()) return origin_of(options_.plate_frame);
    std::vector<Vec> ends, across;
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      ends.push_back(*ends_[i]);
      across.push_back(limbs_[i].across);
    }
    return middle_of(ends, across, up_);
  }

  /// Three ends of one level plate that is narrower than the elbows and lies beside their plane: the parts stand as
  /// assembled.
  [[nodiscard]] bool alike() const {
    const Vec centre = middle_of_ends();
    double least = 1e9, most = -1e9;
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      const Vec offset = *ends_[i] - centre;
      least = std::min(least, offset.dot(limbs_[i].outwards));
      most = std::max(most, offset.dot(limbs_[i].outwards));
      const Vec strut = *ends_[i] - limbs_[i].elbow;
      if (std::abs(strut.dot(up_)) < kFlat * strut.norm() || most > limbs_[i].radius) return false;
      if (options_.plate_frame.empty() && std::abs(offset.dot(up_)) > kLevel) return false;
      if (options_.plate_frame.empty() && std::abs(offset.dot(limbs_[i].across)) > kLevel) return false;
    }
    return most - least < kLevel;
  }

  [[nodiscard]] Vec origin_of(const std::string& link) const {
    const auto found = tree_.links.find(link);
    if (found == tree_.links.end())
      throw Error(fmt::format("there is no link '{}'", link), "--plate-frame", "name a link of the plate",
                  ExitCode::usage);
    return link_pose(tree_, parts_.X_R, link).translation();
  }

  [[nodiscard]] Attachments finish(const std::string& note) const {
    Attachments result;
    result.note = note;
    result.plate_centre = middle_of_ends();
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      const Vec strut = *ends_[i] - limbs_[i].elbow;
      result.offsets.push_back(*ends_[i] - result.plate_centre);
      result.lengths.push_back(strut.norm());
      result.directions.push_back(strut.normalized());
    }
    return result;
  }

  /// Radii of the plate with which the strut of limb i, of length L, reaches from its elbow to a plate held at limb k.
  [[nodiscard]] std::vector<double> radii(std::size_t i, std::size_t k, double length) const {
    const Vec w = limbs_[i].elbow - *ends_[k], d = limbs_[k].outwards - limbs_[i].outwards;
    const double a = d.squaredNorm(), b = w.dot(d), c = w.squaredNorm() - length * length;
    const double under = b * b - a * c;
    // A double root written with a few digits may fall short of zero.
    if (under < -kClosure * length * length * a) return {};
    const double root = std::sqrt(std::max(0.0, under));
    return {(-b - root) / a, (-b + root) / a};
  }

  /// Whether struts of this length, in the directions that their centres of mass show, reach a plate of this radius
  /// held at limb k.
  [[nodiscard]] bool closes(double radius, std::size_t k, double length) const {
    const Vec centre = *ends_[k] - radius * limbs_[k].outwards;
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      const Vec strut = centre + radius * limbs_[i].outwards - limbs_[i].elbow;
      const auto line = direction_of(parts_.limbs[i]);
      if (std::abs(strut.norm() - length) > kClosure * length) return false;
      if (line && line->cross(strut.normalized()).norm() > kDirection) return false;
    }
    return true;
  }

  void hold_plate(double radius, std::size_t k) {
    const Vec centre = *ends_[k] - radius * limbs_[k].outwards;
    for (std::size_t i = 0; i < limbs_.size(); ++i) ends_[i] = centre + radius * limbs_[i].outwards;
  }

  /// One end is known, and with it the length. Limbs are alike and sit on the plate as on the base: the radius is what
  /// closes.
  std::optional<Attachments> by_closure() {
    const std::size_t k = first_known();
    const double length = length_of_known();
    // Each of the two other limbs has two radii; where two of them are one, but for digits, their mean closes best.
    std::vector<std::vector<double>> both;
    for (std::size_t i = 0; i < limbs_.size(); ++i)
      if (i != k) both.push_back(radii(i, k, length));
    std::vector<double> candidates;
    for (const double a : both.front())
      for (const double b : both.back()) candidates.push_back((a + b) / 2);
    // In a symmetric pose a plate wider than the elbows closes as well; the smaller one is meant.
    std::ranges::sort(candidates, {}, [](double radius) { return std::abs(radius); });
    const auto before = ends_;
    for (const double radius : candidates) {
      if (!closes(radius, k, length)) continue;
      hold_plate(radius, k);
      if (alike() && options_.platform_radius && std::abs(*options_.platform_radius - radius) > kLevel)
        ask(fmt::format("--platform-radius is {:.6g} m, but the pose of the CAD closes with {:.6g} m",
                        *options_.platform_radius, radius),
            "leave the flag out, or mend the pose of the CAD");
      if (alike())
        return finish(
            fmt::format("ends of struts by closure: the plate's radius is {:.6g} m if the limbs are alike", radius));
      ends_ = before;
    }
    return std::nullopt;
  }

  std::optional<Attachments> by_direction(double length) {
    const auto before = ends_;
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      if (ends_[i]) continue;
      const auto line = direction_of(parts_.limbs[i]);
      if (line) ends_[i] = limbs_[i].elbow + length * *line;
    }
    if (known() == limbs_.size() && alike())
      return finish(fmt::format("ends of struts by their centres of mass, {:.6g} m from the elbows", length));
    ends_ = before;
    return std::nullopt;
  }

  Attachments by_radius() {
    for (std::size_t i = 0; i < limbs_.size(); ++i)
      ends_[i] = *parts_.plate_place + *options_.platform_radius * limbs_[i].outwards;
    if (!alike())
      ask(fmt::format("with --platform-radius {:.6g} about the origin of the plate's link the struts do not close",
                      *options_.platform_radius),
          "hang the plate on a strut, or mend the pose of the CAD");
    return finish("ends of struts by --platform-radius about the origin of the plate's link");
  }

  /// The parts do not stand in a pose of the robot. A rigid part keeps its lengths: the strut's from elbow to plate,
  /// the plate's from its centre to the strut that carries it. The plate's axes count as parallel to the base's.
  Attachments by_lengths() const {
    const std::size_t k = first_known();
    const Vec end = *ends_[k];
    double radius = 0;
    std::string how;
    if (options_.platform_radius) {
      radius = *options_.platform_radius;
      how = "--platform-radius";
    } else {
      std::vector<std::string> links = parts_.plate_links;
      if (!options_.plate_frame.empty()) links = {options_.plate_frame};
      for (const std::string& link : links) {
        const Vec offset = end - origin_of(link);
        const double along = offset.dot(limbs_[k].outwards);
        if ((offset - along * limbs_[k].outwards).norm() > kLevel || along < kLevel || along > limbs_[k].radius)
          continue;
        radius = along;
        how = "the origin of link " + link;
      }
    }
    if (how.empty())
      ask("the plate's radius cannot be found: the joints at zero are no pose of the robot that closes with three like "
          "limbs, and no link of the plate has its origin at the plate's centre",
          "give --platform-radius (attachments of the limbs from the plate's centre, in metres), or name the link at "
          "the centre by --plate-frame, or export the robot assembled");
    Attachments result;
    result.assembled = false;
    result.plate_centre = end - radius * limbs_[k].outwards;
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      result.offsets.push_back(radius * limbs_[i].outwards);
      result.lengths.push_back(length_of_known());
      const auto line = direction_of(parts_.limbs[i]);
      result.directions.push_back(ends_[i] ? Vec((*ends_[i] - limbs_[i].elbow).normalized())
                                           : line.value_or((end - limbs_[k].elbow).normalized()));
    }
    result.note = fmt::format(
        "the joints at zero are no pose of the robot; lengths are taken from the parts, the plate's radius {:.6g} m by "
        "{}, and up is z of the base's link",
        radius, how);
    return result;
  }

  /// No end is known. E + L d = B + r x for three limbs is linear in length, radius and the plate's centre.
  [[nodiscard]] double length_of_three() const {
    const auto n = static_cast<Eigen::Index>(limbs_.size());
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3 * n, 5);
    Eigen::VectorXd b(3 * n);
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      const auto row = 3 * static_cast<Eigen::Index>(i);
      const auto line = direction_of(parts_.limbs[i]);
      if (!line)
        ask(fmt::format("the ends of the struts cannot be found: no strut carries the plate, and link {} has neither a "
                        "frame at its end nor a centre of mass on its axis",
                        parts_.limbs[i].struts.front().name),
            "give --platform-radius if the origin of the plate's link is its centre, or hang the plate on a strut");
      A.block<3, 1>(row, 0) = *line;
      A.block<3, 1>(row, 1) = -limbs_[i].outwards;
      A.block<3, 3>(row, 2) = -Eigen::Matrix3d::Identity();
      b.segment<3>(row) = -limbs_[i].elbow;
    }
    const dense::PivotedQr qr(A, kDegenerate);
    if (qr.rank() < 5)
      ask("the length of the struts cannot be found: no strut carries the plate, and in this pose every length would "
          "do",
          "give --strut (ball to ball, in metres)");
    const Eigen::VectorXd x = qr.solve(b);
    if (!(x(0) > 0) || (A * x - b).norm() > 100 * kClosure * x(0))
      ask("the length of the struts cannot be found: no strut carries the plate, and the limbs are not alike",
          "give --strut (ball to ball, in metres)");
    return x(0);
  }

  const UrdfTree& tree_;
  const Parts& parts_;
  const AdoptOptions& options_;
  const std::vector<LimbPlace>& limbs_;
  const Vec up_;
  std::vector<std::optional<Vec>> ends_;  ///< in the root link's frame
};

}  // namespace

Vec middle_of(const std::vector<Vec>& points, const std::vector<Vec>& across, const Vec& up) {
  Eigen::Matrix3d N = up * up.transpose();
  Vec sum = Vec::Zero(), total = Vec::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Matrix3d P = across[i] * across[i].transpose();
    N += P;
    sum += P * points[i];
    total += points[i];
  }
  return N.ldlt().solve(sum + up * (total.dot(up) / static_cast<double>(points.size())));
}

Attachments find_attachments(const UrdfTree& tree, const Parts& parts, const AdoptOptions& options,
                             const std::vector<LimbPlace>& limbs, const Vec& up) {
  return Solver(tree, parts, options, limbs, up).run();
}

}  // namespace deltadyn::cad
