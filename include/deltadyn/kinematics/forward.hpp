#pragma once

/// \file
/// Forward kinematics z = f_FK(q): in closed form for three limbs, by Newton's iteration for a plate that turns.

#include <Eigen/LU>
#include <cmath>

#include "deltadyn/kinematics/inverse.hpp"
#include "deltadyn/kinematics/three_spheres.hpp"

namespace deltadyn {

/// Steps of Newton's iteration from one start; the paths of machines need three or four.
inline constexpr int kForwardSteps = 8;

/// How Newton's iteration went.
template <class T>
struct NewtonRun {
  int steps = 0;
  /// The loops' determinant at the start, and before the last step, which is that of the solution to some digits
  T determinant_first = T(0), determinant = T(0);
};

/// The loop equations of a plate that turns, at fixed drives.
template <class T, class Robot>
class PlateLoops {
 public:
  static constexpr int P = kPlateCoordinates<Robot>;
  static_assert(P == 4, "for a plate that turns");
  using Plate = Vector<T, P>;  ///< (r, psi)

  PlateLoops(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& q) : geometry_(geometry) {
    for (int i = 0; i < P; ++i) elbow_[i] = elbow_place<T, Robot>(geometry.limbs[i], q(i));
  }

  [[nodiscard]] const Vector3<T> (&elbows() const)[P] { return elbow_; }

  /// Rows u_i^T dA_i/dy, and (|A_i - E_i|^2 / L_i - L_i) / 2.
  void at(const Plate& y, Matrix<T, P, P>& loops, Plate& error) const {
    const Attachments<T, Robot> attachments(geometry_, y(3));
    for (int i = 0; i < P; ++i) {
      const T& length = geometry_.limbs[i].strut;
      const PointCurve<T> p = attachments(i);
      const Vector3<T> u = (y.template head<3>() + p.value - elbow_[i]) / length;
      loops.row(i) << u.transpose(), u.dot(p.first);
      error(i) = T(0.5) * length * (u.squaredNorm() - T(1));
    }
  }

  /// Whether the plate hangs below the elbows.
  [[nodiscard]] bool hangs(const Plate& y) const {
    T above = T(0);
    for (const Vector3<T>& elbow : elbow_) above += elbow.z() - y(2);
    return above > T(0);
  }

  /// Its sign tells the assembly modes apart.
  [[nodiscard]] T determinant(const Plate& y) const {
    Matrix<T, P, P> loops;
    Plate error;
    at(y, loops, error);
    return loops.determinant();
  }

  /// Newton's iteration on |A_i - E_i|^2 = L_i^2 from `y`; kForwardSteps at most.
  /// \return unreachable if it does not come to rest, singular if it runs into a singular pose; then `y` is of no use
  Status solve(Plate& y, NewtonRun<T>& run) const {
    using std::sqrt;
    // Convergence is quadratic: a step of this size leaves nothing to do.
    const T enough = sqrt(Eigen::NumTraits<T>::epsilon()) / T(8);
    Matrix<T, P, P> loops, inverse;
    Plate error;
    for (run.steps = 1; run.steps <= kForwardSteps; ++run.steps) {
      at(y, loops, error);
      bool invertible = false;
      loops.computeInverseAndDetWithCheck(inverse, run.determinant, invertible, T(kSingularLoop) / T(100));
      if (run.steps == 1) run.determinant_first = run.determinant;
      if (!invertible) return Status::singular;
      const Plate by = inverse * error;
      y -= by;
      if (!y.allFinite()) return Status::unreachable;
      if (by.cwiseAbs().maxCoeff() < enough) return Status::ok;
    }
    return Status::unreachable;
  }

 private:
  const Geometry<T, Robot>& geometry_;
  Vector3<T> elbow_[P];  // in W
};

/// The loops' determinant in the middle of the workspace: below the drives' middle, the plate not turned. Poses of the
/// other sign lie beyond a singular pose.
/// \return 0 if none of the heights looked at is in reach
template <class T, class Robot>
T plate_mode(const Geometry<T, Robot>& geometry) {
  Vector<T, Robot::kDrives> z = Vector<T, Robot::kDrives>::Zero(), q;
  T length = T(0);
  for (const LimbGeometry<T>& limb : geometry.limbs) {
    z.template head<3>() += limb.p_WD / T(Robot::kLimbs);
    length += (limb.strut + limb.p_DE_0.norm()) / T(Robot::kLimbs);
  }
  const T top = z(2);
  constexpr double kHeights[] = {0.6, 0.5, 0.7, 0.4, 0.8, 0.3, 0.9, 0.2};
  for (const double height : kHeights) {
    z(2) = top - T(height) * length;
    if (inverse_kinematics(geometry, z, q) != Status::ok) continue;
    return PlateLoops<T, Robot>(geometry, q).determinant(z);
  }
  return T(0);
}

namespace detail {

/// The turn in (-pi, pi] where full turns lead back to the same pose, as they do unless a part slides.
template <class T, class Robot>
void unwind(const Geometry<T, Robot>& geometry, T& psi) {
  for (const PlatePart<T>& part : geometry.parts)
    if (!(part.b.squaredNorm() <= T(0))) return;
  using std::floor;
  constexpr double kPi = 3.14159265358979323846;
  const T turns = floor((psi / geometry.yaw_ratio + T(kPi)) / T(2 * kPi));
  psi -= turns * T(2 * kPi) * geometry.yaw_ratio;
}

template <class T, class Robot>
T middle_determinant(const Geometry<T, Robot>& geometry) {
  return geometry.mode != T(0) ? geometry.mode : plate_mode(geometry);
}

/// The pose of one mode that belongs to given drives, of those that were found so far.
template <class T, class Robot>
class PoseFound {
 public:
  using Pose = Vector<T, Robot::kDrives>;
  explicit PoseFound(const T& range) : range_(range) {}

  /// A pose inside the range of the plate comes before one beyond it.
  void add(const Pose& pose) {
    constexpr double kApart = 1e-3;  // metres, and of the range; one pose found twice differs by rounding
    const bool inside = pose(3) <= T(1.001) * range_ && pose(3) >= T(-1.001) * range_;
    if (any_ && inside == inside_) {
      const T turned = (pose(3) - pose_(3)) / range_;
      const T moved = (pose - pose_).template head<3>().squaredNorm() + turned * turned;
      two_ = two_ || moved > T(kApart * kApart);
    } else if (!any_ || inside) {
      pose_ = pose;
      two_ = false;
      inside_ = inside;
    }
    any_ = true;
  }
  [[nodiscard]] bool any() const { return any_; }
  [[nodiscard]] bool inside() const { return inside_; }
  [[nodiscard]] bool two() const { return two_; }
  [[nodiscard]] const Pose& pose() const { return pose_; }

 private:
  T range_;
  Pose pose_ = Pose::Zero();
  bool any_ = false, inside_ = false, two_ = false;
};

/// From several turns of the plate, with the centre where three limbs put it. The solution that counts is of the
/// robot's assembly mode; near a singular pose there may be two of them.
template <class T, class Robot>
Status forward_from_anywhere(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& q,
                             Vector<T, Robot::kDrives>& z) {
  constexpr double kStarts[] = {0, 0.5, -0.5, 1, -1};  // of the range of theta
  constexpr double kClear = 0.5;  // of the determinant in the middle; from there on no second pose was ever found
  const PlateLoops<T, Robot> loops(geometry, q);
  const T middle = middle_determinant(geometry);
  using std::abs;  // a gear may reverse
  PoseFound<T, Robot> found(T(abs(geometry.yaw_ratio)) * geometry.theta_range);
  Status status = Status::unreachable;
  for (const double share : kStarts) {
    const T psi = geometry.yaw_ratio * geometry.theta_range * T(share);
    const Attachments<T, Robot> attachments(geometry, psi);
    for (int left_out = 3; left_out >= 0; --left_out) {
      Vector3<T> r;
      if (centre_on_three_limbs(geometry, loops.elbows(), attachments, r, left_out) != Status::ok) continue;
      Vector<T, Robot::kDrives> solution;
      solution << r, psi;
      NewtonRun<T> run;
      const Status solved = loops.solve(solution, run);
      if (solved == Status::singular) status = solved;
      if (solved != Status::ok) continue;
      const T determinant = run.determinant * middle;
      if (!(determinant > T(0)) || !loops.hangs(solution)) continue;
      unwind(geometry, solution(3));
      found.add(solution);
      if (found.inside() && !found.two() && determinant > T(kClear) * middle * middle) {
        z = found.pose();
        return Status::ok;
      }
      break;
    }
  }
  if (!found.any()) return status;
  if (found.two()) return Status::ambiguous;
  z = found.pose();
  return Status::ok;
}

/// One step of a path in the assembly mode of `middle`, the determinant in the middle. Half the determinant or less
/// after it is a path that may have jumped to the other pose.
template <class T, class Robot>
Status follow_step(const PlateLoops<T, Robot>& loops, const T& middle, Vector<T, Robot::kDrives>& y) {
  NewtonRun<T> run;
  if (const Status status = loops.solve(y, run); status != Status::ok) return status;
  const bool same = run.determinant * middle > T(0) && run.determinant / run.determinant_first > T(0.5);
  return same ? Status::ok : Status::singular;
}

/// Follows the pose from `y`, that of drives `from`, to that of drives `to` in `parts` equal steps.
template <class T, class Robot>
Status follow(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& from,
              const Vector<T, Robot::kDrives>& to, int parts, Vector<T, Robot::kDrives>& y) {
  for (int part = 1; part <= parts; ++part) {
    const Vector<T, Robot::kDrives> q = from + (T(part) / T(parts)) * (to - from);
    const Status status = follow_step(PlateLoops<T, Robot>(geometry, q), middle_determinant(geometry), y);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

/// No farther than a set point goes: a twentieth of a strut, and 0.2 rad of theta.
template <class T, class Robot>
bool is_near(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& one,
             const Vector<T, Robot::kDrives>& other) {
  const Vector<T, Robot::kDrives> way = other - one;
  const T turned = way(3) / geometry.yaw_ratio, length = T(0.05) * geometry.limbs[0].strut;
  return way.template head<3>().squaredNorm() < length * length && turned * turned < T(0.04);
}

}  // namespace detail

/// Task coordinates of a plate that turns, from a pose near by, e.g. that of the last set point: less work, and the
/// right one of two poses that belong to the same drives in the same assembly mode. Where one step of the iteration
/// might lead to the other, the way from the start is followed in smaller steps. A pose further away than a set point
/// goes, a twentieth of a strut or 0.2 rad of theta, is looked for from everywhere.
/// \return ambiguous if two poses are found far from the start
template <class T, class Robot>
Status forward_kinematics_from(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& q,
                               const Vector<T, Robot::kDrives>& start, Vector<T, Robot::kDrives>& z) {
  if (!q.allFinite() || !start.allFinite()) return Status::out_of_range;
  Vector<T, Robot::kDrives> y = start, of_start;
  Status status = detail::follow_step(PlateLoops<T, Robot>(geometry, q), detail::middle_determinant(geometry), y);
  if (status != Status::ok && inverse_kinematics(geometry, start, of_start) == Status::ok) {
    constexpr int kParts[] = {4, 16};
    for (const int parts : kParts) {
      y = start;
      status = detail::follow(geometry, of_start, q, parts, y);
      if (status == Status::ok) break;
    }
  }
  if (status == Status::ok && detail::is_near(geometry, start, y)) {
    z = y;
    return Status::ok;
  }
  return detail::forward_from_anywhere(geometry, q, z);
}

/// Task coordinates of the drive coordinates; an axis has z = q.
template <class T, class Robot>
Status forward_kinematics(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& q,
                          Vector<T, Robot::kDrives>& z) {
  if (!q.allFinite()) return Status::out_of_range;
  z = q;
  if constexpr (Robot::kPlateTurns) {
    return detail::forward_from_anywhere(geometry, q, z);
  } else if constexpr (kHasPlate<Robot>) {
    static_assert(Robot::kLimbs == 3, "the closed form is for three limbs");
    Vector3<T> elbows[Robot::kLimbs], r;
    for (int i = 0; i < Robot::kLimbs; ++i) elbows[i] = elbow_place<T, Robot>(geometry.limbs[i], q(i));
    const Attachments<T, Robot> attachments(geometry, T(0));
    if (const Status status = centre_on_three_limbs(geometry, elbows, attachments, r, 3); status != Status::ok)
      return status;
    z.template head<3>() = r;
  }
  return Status::ok;
}

/// Posture at drive coordinates q.
template <class T, class Robot>
Status posture_from_drives(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& q,
                           Posture<T, Robot>& posture) {
  Vector<T, Robot::kDrives> z;
  const Status status = forward_kinematics(geometry, q, z);
  return status == Status::ok ? assemble_posture(geometry, q, z, posture) : status;
}

}  // namespace deltadyn
