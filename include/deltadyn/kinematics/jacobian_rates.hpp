#pragma once

/// \file
/// Time derivatives of a posture's Jacobians along a motion: what the Coriolis matrix C(q, qd) is made of, beside the
/// Jacobians.

#include "deltadyn/kinematics/motion.hpp"

namespace deltadyn {

/// d/dt of the members of Posture with the same names, for the drive rates of a motion. Zero for a robot at rest.
template <class T, class Robot>
struct JacobianRates {
  static constexpr int N = Robot::kDrives;
  struct Limb {
    RowVector<T, N> J_beta = RowVector<T, N>::Zero();
    RowVector<T, N> J_gamma = RowVector<T, N>::Zero();
  };
  Matrix<T, Posture<T, Robot>::kRows, N> J_plate = Matrix<T, Posture<T, Robot>::kRows, N>::Zero();
  Limb limbs[Robot::kLimbs];
  RowVector<T, N> J_length = RowVector<T, N>::Zero();  ///< of the telescope bar, as the next two
  RowVector<T, N> J_a = RowVector<T, N>::Zero(), J_b = RowVector<T, N>::Zero();
};

namespace detail {

template <class T, class Robot>
void set_telescope_jacobian_rates(const Motion<T, Robot>& motion, JacobianRates<T, Robot>& rates) {
  constexpr int N = Robot::kDrives;
  constexpr int kPsi = N - 1;
  const auto& bar = motion.posture.telescope;
  const auto& r = motion.telescope;
  const T psi_d = motion.qd(kPsi);
  const auto J_r = motion.posture.J_plate.template topRows<3>();
  const auto J_r_d = rates.J_plate.template topRows<3>();
  const Vector3<T> e_d = bar.J_e.lazyProduct(motion.qd);
  rates.J_length = -(e_d.transpose().lazyProduct(J_r) + bar.e.transpose().lazyProduct(J_r_d));
  const Matrix<T, 3, N> J_e_d =
      (-J_r_d - e_d * bar.J_length - bar.e * rates.J_length - r.length_d * bar.J_e) / bar.length;

  // As seen from the frame P that turns with psi: e_P = R_PW e, so J_e_P = R_PW J_e - (e_z x e_P) dpsi/dq.
  const Matrix3<T> R_PW = rot_z(bar.psi).transpose();
  const Matrix<T, 3, N> J_e_turned = R_PW.lazyProduct(bar.J_e);
  Matrix<T, 3, N> J_e_P_d = R_PW.lazyProduct(J_e_d);
  J_e_P_d.row(0) += psi_d * J_e_turned.row(1);
  J_e_P_d.row(1) -= psi_d * J_e_turned.row(0);
  const Vector3<T> e_P_d = R_PW * e_d - psi_d * cross_z(bar.e_P);
  J_e_P_d.col(kPsi) -= cross_z(e_P_d);
  const T tan_b = bar.b.sin / bar.b.cos;
  rates.J_b = J_e_P_d.row(0) / bar.b.cos + tan_b * r.b_d * bar.J_b;
  rates.J_a = -(bar.a.cos * J_e_P_d.row(1) + bar.a.sin * J_e_P_d.row(2)) / bar.b.cos +
              tan_b * (r.a_d * bar.J_b + r.b_d * bar.J_a);
}

}  // namespace detail

/// The rates for the posture and the drive rates of `motion`; its accelerations do not matter.
template <class T, class Robot>
JacobianRates<T, Robot> jacobian_rates(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion) {
  JacobianRates<T, Robot> rates;
  if constexpr (kHasPlate<Robot>) {
    constexpr int N = Robot::kDrives;
    constexpr int P = kPlateCoordinates<Robot>;
    const auto& posture = motion.posture;
    const T psi_d = Robot::kPlateTurns ? motion.zd(P - 1) : T(0);
    Matrix3<T> R_LW[Robot::kLimbs];
    Vector3<T> u_d[Robot::kLimbs];
    // Loop i: u_i . (dA_i/dy J_plate - dE_i/dq) = 0, differentiated by time.
    Matrix<T, P, N> right;
    for (int i = 0; i < Robot::kLimbs; ++i) {
      const auto& limb = posture.limbs[i];
      R_LW[i] = limb.R_WL.transpose();
      u_d[i] = R_LW[i] * motion.zd.template head<3>() - limb.p_DE.first * motion.qd(i);
      if constexpr (Robot::kPlateTurns) u_d[i] += limb.p_BA.first * psi_d;
      u_d[i] /= geometry.limbs[i].strut;
      Matrix<T, 3, P> J_A = Matrix<T, 3, P>::Zero();
      J_A.template leftCols<3>() = R_LW[i];
      Vector3<T> turning = Vector3<T>::Zero();
      if constexpr (Robot::kPlateTurns) {
        J_A.col(3) = limb.p_BA.first;
        turning = limb.p_BA.second * psi_d;
      }
      right.row(i) = -(u_d[i].transpose().lazyProduct(J_A)).lazyProduct(posture.J_plate);
      if constexpr (Robot::kPlateTurns) right.row(i) -= limb.u.dot(turning) * posture.J_plate.row(3);
      right(i, i) += u_d[i].dot(limb.p_DE.first) + limb.u.dot(limb.p_DE.second) * motion.qd(i);
    }
    rates.J_plate = posture.J_plate_loops.lazyProduct(right);

    for (int i = 0; i < Robot::kLimbs; ++i) {
      const auto& limb = posture.limbs[i];
      Matrix<T, 3, N> J_u_d = R_LW[i].lazyProduct(rates.J_plate.template topRows<3>());
      if constexpr (Robot::kPlateTurns) {
        J_u_d += limb.p_BA.first * rates.J_plate.row(3) + (limb.p_BA.second * psi_d) * posture.J_plate.row(3);
      }
      J_u_d.col(i) -= limb.p_DE.second * motion.qd(i);
      J_u_d /= geometry.limbs[i].strut;
      const T tan_gamma = limb.gamma.sin / limb.gamma.cos;
      const auto& angle = motion.limbs[i];
      rates.limbs[i].J_gamma = J_u_d.row(1) / limb.gamma.cos + tan_gamma * angle.gamma_d * limb.J_gamma;
      rates.limbs[i].J_beta = -(limb.beta.sin * J_u_d.row(0) + limb.beta.cos * J_u_d.row(2)) / limb.gamma.cos +
                              tan_gamma * (angle.beta_d * limb.J_gamma + angle.gamma_d * limb.J_beta);
    }
    if constexpr (Robot::kTelescope) detail::set_telescope_jacobian_rates(motion, rates);
  }
  return rates;
}

/// d/dt dz/dq, N x N.
template <class T, class Robot>
Matrix<T, Robot::kDrives, Robot::kDrives> task_jacobian_rate(const JacobianRates<T, Robot>& rates) {
  Matrix<T, Robot::kDrives, Robot::kDrives> J = Matrix<T, Robot::kDrives, Robot::kDrives>::Zero();
  constexpr int P = kPlateCoordinates<Robot>;
  if constexpr (P > 0) J.template topRows<P>() = rates.J_plate;
  return J;
}

}  // namespace deltadyn
