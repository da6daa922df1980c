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

/// The loop equations of a plate that turns, at fixed drives.
template <class T, class Robot>
class PlateLoops {
 public:
  static constexpr int P = kPlateCoordinates<Robot>;
  static_assert(P == 4, "for a plate that turns");
  using Plate = Vector<T, P>;  ///< (r, psi)

  PlateLoops(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& q) : geometry_(geometry) {
    for (int i = 0; i < P; ++i) {
      LimbPosture<T, Robot::kDrives> limb;
      elbow<T, Robot>(geometry.limbs[i], q(i), limb);
      elbow_[i] = geometry.limbs[i].p_WD + limb_frame(geometry.limbs[i]) * limb.p_DE.value;
    }
  }

  /// Rows u_i^T dA_i/dy, and (|A_i - E_i|^2 / L_i - L_i) / 2.
  void at(const Plate& y, Matrix<T, P, P>& loops, Plate& error) const {
    for (int i = 0; i < P; ++i) {
      const T& length = geometry_.limbs[i].strut;
      const PointCurve<T> p = attachment(geometry_, i, y(3));
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
  /// \param steps  how many it took
  /// \return unreachable if it does not come to rest, singular if it runs into a singular pose; then `y` is of no use
  Status solve(Plate& y, int& steps) const {
    using std::sqrt;
    // Convergence is quadratic: a step of this size leaves nothing to do.
    const T enough = sqrt(Eigen::NumTraits<T>::epsilon()) / T(8);
    Matrix<T, P, P> loops, inverse;
    Plate error;
    for (steps = 1; steps <= kForwardSteps; ++steps) {
      at(y, loops, error);
      bool invertible = false;
      loops.computeInverseWithCheck(inverse, invertible, T(kSingularLoop) / T(100));
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

/// Sign of the loops' determinant in the middle of the workspace: below the drives' middle, the plate not turned. Poses
/// of the other sign lie beyond a singular pose.
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
    const T determinant = PlateLoops<T, Robot>(geometry, q).determinant(z);
    return determinant > T(0) ? T(1) : T(-1);
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

/// From several turns of the plate, with the centre where three limbs put it. The solution that counts is of the
/// robot's assembly mode.
template <class T, class Robot>
Status forward_from_anywhere(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& q,
                             Vector<T, Robot::kDrives>& z) {
  constexpr double kStarts[] = {0, 0.5, -0.5, 1, -1};  // of the range of theta
  const PlateLoops<T, Robot> loops(geometry, q);
  const T mode = geometry.mode != T(0) ? geometry.mode : plate_mode(geometry);
  Status status = Status::unreachable;
  for (const double share : kStarts) {
    for (int left_out = 3; left_out >= 0; --left_out) {
      Vector3<T> r;
      const T psi = geometry.yaw_ratio * geometry.theta_range * T(share);
      if (centre_on_three_limbs(geometry, q, psi, r, left_out) != Status::ok) continue;
      Vector<T, Robot::kDrives> solution;
      solution << r, psi;
      int steps = 0;
      const Status found = loops.solve(solution, steps);
      if (found == Status::ok && loops.determinant(solution) * mode > T(0) && loops.hangs(solution)) {
        z = solution;
        unwind(geometry, z(3));
        return found;
      }
      if (found == Status::singular) status = found;
    }
  }
  return status;
}

}  // namespace detail

/// Task coordinates of a plate that turns, from a pose near by, e.g. that of the last set point: half the work, and the
/// right one of two poses that belong to the same drives in the same assembly mode.
template <class T, class Robot>
Status forward_kinematics_from(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& q,
                               const Vector<T, Robot::kDrives>& start, Vector<T, Robot::kDrives>& z) {
  if (!q.allFinite() || !start.allFinite()) return Status::out_of_range;
  const PlateLoops<T, Robot> loops(geometry, q);
  Vector<T, Robot::kDrives> y = start;
  int steps = 0;
  if (loops.solve(y, steps) != Status::ok || !(loops.determinant(y) * loops.determinant(start) > T(0)))
    return detail::forward_from_anywhere(geometry, q, z);
  z = y;
  return Status::ok;
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
    Vector3<T> r;
    if (const Status status = centre_on_three_limbs(geometry, q, T(0), r, 3); status != Status::ok) return status;
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
