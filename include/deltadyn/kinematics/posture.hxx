#pragma once

#include <Eigen/LU>

namespace deltadyn {

namespace detail {

/// Strut angles and their Jacobians from u and du/dq, both in L: u = (cos beta cos gamma, sin gamma, -sin beta cos
/// gamma).
template <class T, int N>
Status strut_angles(const Matrix<T, 3, N>& J_u, LimbPosture<T, N>& limb) {
  using std::sqrt;
  const T cos_gamma = sqrt(limb.u.x() * limb.u.x() + limb.u.z() * limb.u.z());
  if (!(cos_gamma > T(1e-4))) return Status::singular;
  limb.gamma = SinCos<T>(limb.u.y(), cos_gamma);
  limb.beta = SinCos<T>(-limb.u.z() / cos_gamma, limb.u.x() / cos_gamma);
  limb.J_gamma = J_u.row(1) / cos_gamma;
  limb.J_beta = -(limb.beta.sin * J_u.row(0) + limb.beta.cos * J_u.row(2)) / cos_gamma;
  return Status::ok;
}

/// Universal joint angles a, b from the bar's direction: e_P = (sin b, -sin a cos b, cos a cos b).
template <class T, class Robot>
Status telescope_posture(const TelescopeGeometry<T>& geometry, Posture<T, Robot>& posture) {
  using std::sqrt;
  constexpr int kPsi = Robot::kDrives - 1;
  auto& bar = posture.telescope;
  const Vector3<T> w = geometry.p_WU - posture.z.template head<3>() - geometry.p_BV;
  bar.length = sqrt(w.squaredNorm());
  if (!(bar.length > T(1e-6))) return Status::singular;
  bar.e = w / bar.length;
  const auto J_r = posture.J_plate.template topRows<3>();
  bar.J_length = -bar.e.transpose() * J_r;
  bar.J_e = (-J_r - bar.e * bar.J_length) / bar.length;

  bar.psi = SinCos<T>(posture.q(kPsi));
  const Matrix3<T> R_PW = rot_z(bar.psi).transpose();
  bar.e_P = R_PW * bar.e;
  const T cos_b = sqrt(bar.e_P.y() * bar.e_P.y() + bar.e_P.z() * bar.e_P.z());
  if (!(cos_b > T(1e-4))) return Status::singular;
  bar.b = SinCos<T>(bar.e_P.x(), cos_b);
  bar.a = SinCos<T>(-bar.e_P.y() / cos_b, bar.e_P.z() / cos_b);
  Matrix<T, 3, Robot::kDrives> J_e_P = R_PW * bar.J_e;
  J_e_P.col(kPsi) -= cross_z(bar.e_P);
  bar.J_b = J_e_P.row(0) / cos_b;
  bar.J_a = -(bar.a.cos * J_e_P.row(1) + bar.a.sin * J_e_P.row(2)) / cos_b;
  return Status::ok;
}

}  // namespace detail

template <class T, class Robot>
Status assemble_posture(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& q,
                        const Vector<T, Robot::kDrives>& z, Posture<T, Robot>& posture) {
  constexpr int N = Robot::kDrives;
  constexpr int P = kPlateCoordinates<Robot>;
  posture.q = q;
  posture.z = z;
  for (int i = 0; i < Robot::kLimbs; ++i) {
    posture.limbs[i].R_WL = limb_frame(geometry.limbs[i]);
    elbow<T, Robot>(geometry.limbs[i], q(i), posture.limbs[i]);
  }
  if constexpr (kHasPlate<Robot>) {
    static_assert(Robot::kLimbs == P, "one limb for each coordinate of the plate");
    const T psi = Robot::kPlateTurns ? z(P - 1) : T(0);
    if constexpr (Robot::kPlateTurns) {
      posture.theta_gain = T(1) / geometry.yaw_ratio;
      posture.theta = posture.theta_gain * psi;
    }
    Matrix<T, P, P> loops;    // rows u_i^T dA_i/dy
    Vector<T, P> drive_gain;  // u_i^T dE_i/dq_i
    Matrix3<T> R_LW[Robot::kLimbs];
    const Attachments<T, Robot> attachments(geometry, psi);
    for (int i = 0; i < Robot::kLimbs; ++i) {
      auto& limb = posture.limbs[i];
      R_LW[i] = limb.R_WL.transpose();
      const PointCurve<T> p = attachments(i);
      limb.p_BA.value = R_LW[i] * p.value;
      limb.p_BA.first = R_LW[i] * p.first;
      limb.p_BA.second = R_LW[i] * p.second;
      const Vector3<T> p_DA = R_LW[i] * (z.template head<3>() - geometry.limbs[i].p_WD) + limb.p_BA.value;
      limb.u = (p_DA - limb.p_DE.value) / geometry.limbs[i].strut;
      loops.row(i).template head<3>() = limb.u.transpose() * R_LW[i];
      if constexpr (Robot::kPlateTurns) loops(i, 3) = limb.u.dot(limb.p_BA.first);
      drive_gain(i) = limb.u.dot(limb.p_DE.first);
    }
    T determinant;
    bool invertible;
    loops.computeInverseAndDetWithCheck(posture.J_plate_loops, determinant, invertible, T(kSingularLoop));
    if (!invertible) return Status::singular;
    posture.J_plate.setZero();
    posture.J_plate.template leftCols<P>() = posture.J_plate_loops * drive_gain.asDiagonal();

    for (int i = 0; i < Robot::kLimbs; ++i) {
      auto& limb = posture.limbs[i];
      Matrix<T, 3, N> J_u = R_LW[i] * posture.J_plate.template topRows<3>();
      if constexpr (Robot::kPlateTurns) J_u += limb.p_BA.first * posture.J_plate.row(3);
      J_u.col(i) -= limb.p_DE.first;
      J_u /= geometry.limbs[i].strut;
      if (const Status s = detail::strut_angles<T, N>(J_u, limb); s != Status::ok) return s;
    }
    if constexpr (Robot::kTelescope) {
      if (const Status s = detail::telescope_posture(geometry.telescope, posture); s != Status::ok) return s;
    }
  }
  return Status::ok;
}

}  // namespace deltadyn
