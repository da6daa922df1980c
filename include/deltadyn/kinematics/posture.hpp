#pragma once

/// \file
/// Everything about one robot posture that does not depend on speed: positions, joint angles, Jacobians.
///
/// Notation: q drives; y plate coordinates (r, and the tool's yaw psi = yaw_ratio theta if the plate turns); z task
/// coordinates. For limb i: D drive origin, E elbow, A attachment, u the unit vector from E to A, L the limb frame.

#include "deltadyn/core/rotation.hpp"
#include "deltadyn/core/status.hpp"
#include "deltadyn/core/types.hpp"
#include "deltadyn/model/geometry.hpp"

namespace deltadyn {

/// A vector-valued function of one scalar coordinate with its first two derivatives.
template <class T>
struct PointCurve {
  Vector3<T> value = Vector3<T>::Zero();
  Vector3<T> first = Vector3<T>::Zero();
  Vector3<T> second = Vector3<T>::Zero();
};

/// Posture of one limb; vectors in the limb frame L.
template <class T, int N>
struct LimbPosture {
  Matrix3<T> R_WL;     ///< orientation of L
  SinCos<T> q;         ///< of the drive angle (revolute drives)
  PointCurve<T> p_DE;  ///< elbow from the drive origin and its derivatives by q_i [m, m/rad]
  /// Attachment from r and its derivatives by psi (zero derivatives for a Delta), in L
  PointCurve<T> p_BA;
  Vector3<T> u = Vector3<T>::Zero();                  ///< unit vector of the strut
  SinCos<T> beta;                                     ///< strut angle about y of L: R_LS = Ry(beta) Rz(gamma)
  SinCos<T> gamma;                                    ///< strut angle about its own z
  RowVector<T, N> J_beta = RowVector<T, N>::Zero();   ///< d beta / dq
  RowVector<T, N> J_gamma = RowVector<T, N>::Zero();  ///< d gamma / dq
};

/// Posture of the telescope bar, R_WT = Rz(psi) Rx(a) Ry(b), z of T along the bar, pointing up.
template <class T, int N>
struct TelescopePosture {
  SinCos<T> psi, a, b;
  T length = T(1);  ///< distance of the universal joints [m]
  /// Unit vector along the bar from the lower to the upper joint, in W
  Vector3<T> e = Vector3<T>::Zero();
  Vector3<T> e_P = Vector3<T>::Zero();                 ///< the same in the frame turned by psi
  Matrix<T, 3, N> J_e = Matrix<T, 3, N>::Zero();       ///< de/dq, in W
  RowVector<T, N> J_length = RowVector<T, N>::Zero();  ///< d length / dq [m/rad]
  RowVector<T, N> J_a = RowVector<T, N>::Zero(), J_b = RowVector<T, N>::Zero();  ///< da/dq, db/dq
};

template <class T, class Robot>
struct Posture {
  static constexpr int N = Robot::kDrives;
  static constexpr int P = kPlateCoordinates<Robot>;
  static constexpr int kRows = P > 0 ? P : 1;
  Vector<T, N> q = Vector<T, N>::Zero();
  Vector<T, N> z = Vector<T, N>::Zero();
  LimbPosture<T, N> limbs[Robot::kLimbs];
  Matrix<T, kRows, N> J_plate = Matrix<T, kRows, N>::Zero();  ///< dy/dq
  /// Inverse of the loop matrix with rows u_i^T dA_i/dy
  Matrix<T, kRows, kRows> J_plate_loops = Matrix<T, kRows, kRows>::Zero();
  T theta = T(0);       ///< of a plate that turns [rad]
  T theta_gain = T(1);  ///< d theta / d psi
  TelescopePosture<T, N> telescope;
};

/// |det| of the loop matrix, whose rows are unit vectors, below which a posture counts as singular.
inline constexpr double kSingularLoop = 1e-6;

/// Elbow of limb `limb` at drive coordinate q_i, with derivatives, and sin/cos of the drive angle.
template <class T, class Robot>
void elbow(const LimbGeometry<T>& geometry, const T& q, LimbPosture<T, Robot::kDrives>& limb) {
  if constexpr (Robot::kDrive == DriveKind::revolute) {
    limb.q = SinCos<T>(q);
    const Vector3<T>& d_0 = geometry.p_DE_0;
    const Vector3<T> d(limb.q.cos * d_0.x() + limb.q.sin * d_0.z(), d_0.y(),
                       limb.q.cos * d_0.z() - limb.q.sin * d_0.x());  // Ry(q) d_0
    limb.p_DE.value = d;
    limb.p_DE.first = Vector3<T>(d.z(), T(0), -d.x());  // e_y x d
    limb.p_DE.second = Vector3<T>(-d.x(), T(0), -d.z());
  } else {
    limb.p_DE.value = geometry.p_DE_0 + q * geometry.axis_L;
    limb.p_DE.first = geometry.axis_L;
    limb.p_DE.second.setZero();
  }
}

/// The elbow alone, from the origin of W.
template <class T, class Robot>
Vector3<T> elbow_place(const LimbGeometry<T>& geometry, const T& q) {
  LimbPosture<T, Robot::kDrives> limb;
  elbow<T, Robot>(geometry, q, limb);
  return geometry.p_WD + limb_frame(geometry) * limb.p_DE.value;
}

/// Origin of one part of a turning plate from r, in W, and its derivatives by the yaw psi.
/// \param gain  d theta / d psi
template <class T>
PointCurve<T> part_place(const PlatePart<T>& part, const T& theta, const SinCos<T>& turn, const T& gain) {
  const Vector3<T> turned = turned_z(turn, part.a);
  PointCurve<T> p;
  p.value = part.c + turned + theta * part.b;
  p.first = gain * (cross_z(turned) + part.b);
  p.second = gain * gain * cross_z<T>(cross_z(turned));
  return p;
}

/// Pose of one part of a turning plate and its derivatives by the yaw psi.
template <class T>
struct PartPose {
  PointCurve<T> p;  ///< origin from r, in W [m, m/rad]
  SinCos<T> angle;  ///< of the orientation, turn + kappa theta
  T rate;           ///< d angle / d psi
};

template <class T>
PartPose<T> part_pose(const PlatePart<T>& part, const T& psi, const T& yaw_ratio) {
  const T gain = T(1) / yaw_ratio;
  const T theta = gain * psi;
  return {part_place(part, theta, SinCos<T>(theta), gain), SinCos<T>(T(part.turn + part.kappa * theta)),
          gain * part.kappa};
}

/// Attachments of all limbs relative to r, in W, as functions of psi. What limbs of one part share is computed once.
template <class T, class Robot>
class Attachments {
 public:
  Attachments(const Geometry<T, Robot>& geometry, const T& psi) : geometry_(geometry) {
    if constexpr (Robot::kPlateTurns) {
      const T gain = T(1) / geometry.yaw_ratio, theta = gain * psi;
      const SinCos<T> turn(theta);
      for (int k = 0; k < kParts; ++k) {
        const PlatePart<T>& part = geometry.parts[k];
        place_[k] = part_place(part, theta, turn, gain);
        turned_[k] = SinCos<T>(T(part.kappa * theta));
        rate_[k] = gain * part.kappa;
      }
    } else {
      (void)psi;
    }
  }

  [[nodiscard]] PointCurve<T> operator()(int i) const {
    const LimbGeometry<T>& limb = geometry_.limbs[i];
    PointCurve<T> p;
    if constexpr (Robot::kPlateTurns) {
      const T& rate = rate_[limb.part];
      const Vector3<T> arm = turned_z(turned_[limb.part], limb.p_BA);
      p = place_[limb.part];
      p.value += arm;
      p.first += rate * cross_z(arm);
      p.second += rate * rate * cross_z<T>(cross_z(arm));
    } else {
      p.value = geometry_.parts[limb.part].c + geometry_.parts[limb.part].a + limb.p_BA;
    }
    return p;
  }

 private:
  static constexpr int kParts = Robot::kPlateTurns ? 2 : 1;  // limbs end on the halves, which come first
  const Geometry<T, Robot>& geometry_;
  PointCurve<T> place_[kParts];
  SinCos<T> turned_[kParts];
  T rate_[kParts] = {};
};

/// Fills `posture` from consistent q and z: joint angles and every Jacobian. The two must belong together (see
/// forward.hpp, inverse.hpp).
/// \return singular where the drives do not determine the plate, or a strut lies along its limb's axis
template <class T, class Robot>
Status assemble_posture(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& q,
                        const Vector<T, Robot::kDrives>& z, Posture<T, Robot>& posture);

}  // namespace deltadyn

#include "deltadyn/kinematics/posture.hxx"
