#pragma once

namespace deltadyn {

namespace detail {

/// Velocity and acceleration of p_EA of limb i, in L, from the plate's and the drive's.
template <class T, class Robot>
void strut_end_rates(const LimbPosture<T, Robot::kDrives>& limb, const Vector<T, Robot::kDrives>& zd,
                     const Vector<T, Robot::kDrives>& zdd, const T& qd, const T& qdd, Vector3<T>& first,
                     Vector3<T>& second) {
  const Matrix3<T> R_LW = limb.R_WL.transpose();
  first = R_LW * zd.template head<3>() - limb.p_DE.first * qd;
  second = R_LW * zdd.template head<3>() - limb.p_DE.first * qdd - limb.p_DE.second * (qd * qd);
  if constexpr (Robot::kPlateTurns) {
    first += limb.p_BA.first * zd(3);
    second += limb.p_BA.first * zdd(3) + limb.p_BA.second * (zd(3) * zd(3));
  }
}

template <class T, class Robot>
void set_telescope_rates(Motion<T, Robot>& motion) {
  const auto& bar = motion.posture.telescope;
  auto& rates = motion.telescope;
  constexpr int kPsi = Robot::kDrives - 1;
  const T psi_d = motion.qd(kPsi);
  const T psi_dd = motion.qdd(kPsi);
  const Vector3<T> w_d = -motion.zd.template head<3>();
  const Vector3<T> w_dd = -motion.zdd.template head<3>();
  rates.length_d = bar.e.dot(w_d);
  rates.length_dd = bar.e.dot(w_dd) + (w_d.squaredNorm() - rates.length_d * rates.length_d) / bar.length;
  const Vector3<T> e_d = (w_d - rates.length_d * bar.e) / bar.length;
  const Vector3<T> e_dd = (w_dd - rates.length_dd * bar.e - T(2) * rates.length_d * e_d) / bar.length;

  // The direction as seen from the frame P that turns with psi, differentiated there.
  const Matrix3<T> R_PW = rot_z(bar.psi).transpose();
  const Vector3<T> v = R_PW * e_d;
  const Vector3<T> e_P_d = v - psi_d * cross_z(bar.e_P);
  const Vector3<T> e_P_dd = R_PW * e_dd - psi_d * cross_z(v) - psi_dd * cross_z(bar.e_P) - psi_d * cross_z(e_P_d);
  rates.b_d = e_P_d.x() / bar.b.cos;
  rates.a_d = -(bar.a.cos * e_P_d.y() + bar.a.sin * e_P_d.z()) / bar.b.cos;
  rates.b_dd = (e_P_dd.x() + bar.b.sin * rates.b_d * rates.b_d) / bar.b.cos;
  rates.a_dd =
      (-(bar.a.cos * e_P_dd.y() + bar.a.sin * e_P_dd.z()) + T(2) * bar.b.sin * rates.a_d * rates.b_d) / bar.b.cos;
}

}  // namespace detail

template <class T, class Robot>
void set_drive_rates(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& qd,
                     const Vector<T, Robot::kDrives>& qdd, Motion<T, Robot>& motion) {
  const auto& posture = motion.posture;
  constexpr int P = kPlateCoordinates<Robot>;
  motion.qd = qd;
  motion.qdd = qdd;
  motion.zd = qd;
  motion.zdd = qdd;
  if constexpr (kHasPlate<Robot>) {
    motion.zd.template head<P>() = posture.J_plate * qd;
    // Loop i: u_i . (A_i - E_i)'' = -|(A_i - E_i)'|^2 / strut; with the plate's acceleration left out first.
    Vector<T, Robot::kDrives> bias_dd = Vector<T, Robot::kDrives>::Zero();
    Vector<T, P> right;
    for (int i = 0; i < Robot::kLimbs; ++i) {
      Vector3<T> first, second;
      detail::strut_end_rates<T, Robot>(posture.limbs[i], motion.zd, bias_dd, qd(i), qdd(i), first, second);
      right(i) = -posture.limbs[i].u.dot(second) - first.squaredNorm() / geometry.limbs[i].strut;
    }
    motion.zdd.template head<P>() = posture.J_plate_loops * right;

    for (int i = 0; i < Robot::kLimbs; ++i) {
      const auto& limb = posture.limbs[i];
      Vector3<T> first, second;
      detail::strut_end_rates<T, Robot>(limb, motion.zd, motion.zdd, qd(i), qdd(i), first, second);
      first /= geometry.limbs[i].strut;
      second /= geometry.limbs[i].strut;
      auto& rates = motion.limbs[i];
      rates.gamma_d = first.y() / limb.gamma.cos;
      rates.beta_d = -(limb.beta.sin * first.x() + limb.beta.cos * first.z()) / limb.gamma.cos;
      rates.gamma_dd = (second.y() + limb.gamma.sin * rates.gamma_d * rates.gamma_d) / limb.gamma.cos;
      rates.beta_dd = (-(limb.beta.sin * second.x() + limb.beta.cos * second.z()) +
                       T(2) * limb.gamma.sin * rates.beta_d * rates.gamma_d) /
                      limb.gamma.cos;
    }
    if constexpr (Robot::kTelescope) detail::set_telescope_rates(motion);
  }
}

template <class T, class Robot>
Status drive_rates(const Geometry<T, Robot>& geometry, const Posture<T, Robot>& posture,
                   const Vector<T, Robot::kDrives>& zd, const Vector<T, Robot::kDrives>& zdd,
                   Vector<T, Robot::kDrives>& qd, Vector<T, Robot::kDrives>& qdd) {
  qd = zd;
  qdd = zdd;
  if constexpr (kHasPlate<Robot>) {
    using std::abs;
    for (int i = 0; i < Robot::kLimbs; ++i) {
      const auto& limb = posture.limbs[i];
      const T gain = limb.u.dot(limb.p_DE.first);  // u . dE/dq
      if (!(abs(gain) > T(1e-6) * geometry.limbs[i].strut)) return Status::singular;
      Vector3<T> first, second;
      detail::strut_end_rates<T, Robot>(limb, zd, zdd, T(0), T(0), first, second);
      qd(i) = limb.u.dot(first) / gain;
      detail::strut_end_rates<T, Robot>(limb, zd, zdd, qd(i), T(0), first, second);
      qdd(i) = (limb.u.dot(second) + first.squaredNorm() / geometry.limbs[i].strut) / gain;
    }
  }
  return Status::ok;
}

}  // namespace deltadyn
