#pragma once

namespace deltadyn {

namespace detail {

// Each function below fills a BodyMotion, or a BodyState with the rest of its members.

/// Upper arm (rotates about +y of L, frame x along the arm) or carriage (translates, frame L).
template <class T, class Robot, class BodyType>
void upper_arm_motion(const LimbGeometry<T>& geometry, const LimbPosture<T, Robot::kDrives>& limb, int i,
                      const Vector3<T>& gravity_L, const T& qd, const T& qdd, BodyType& body) {
  body.J_v.setZero();
  body.J_w.setZero();
  if constexpr (Robot::kDrive == DriveKind::revolute) {
    body.a = rot_y(limb.q).transpose() * -gravity_L;
    body.w = Vector3<T>(T(0), qd, T(0));
    body.w_d = Vector3<T>(T(0), qdd, T(0));
    body.J_w(1, i) = T(1);
  } else {
    body.a = limb.p_DE.first * qdd - gravity_L;
    body.w.setZero();
    body.w_d.setZero();
    body.J_v.col(i) = limb.p_DE.first;
  }
  if constexpr (BodyType::kWithState) {
    body.Jd_v.setZero();
    body.Jd_w.setZero();
    body.R_WB = limb.R_WL;
    body.p_WB = geometry.p_WD;
    if constexpr (Robot::kDrive == DriveKind::revolute) {
      body.R_WB = body.R_WB * rot_y(limb.q);
    } else {
      body.p_WB += body.R_WB * (limb.p_DE.value - geometry.p_DE_0);
    }
  } else {
    (void)geometry;
  }
}

/// Strut: R_LS = Ry(beta) Rz(gamma), origin at the elbow.
template <class T, int N, class BodyType>
void strut_motion(const LimbPosture<T, N>& limb, const LimbMotion<T>& rates, int i, const Vector3<T>& gravity_L,
                  const T& qd, const T& qdd, BodyType& body) {
  const Matrix3<T> R_SL = rot_z(limb.gamma).transpose() * rot_y(limb.beta).transpose();
  const T& s = limb.gamma.sin;
  const T& c = limb.gamma.cos;
  body.w << s * rates.beta_d, c * rates.beta_d, rates.gamma_d;
  body.w_d << s * rates.beta_dd + c * rates.gamma_d * rates.beta_d,
      c * rates.beta_dd - s * rates.gamma_d * rates.beta_d, rates.gamma_dd;
  body.J_w.row(0) = s * limb.J_beta;
  body.J_w.row(1) = c * limb.J_beta;
  body.J_w.row(2) = limb.J_gamma;
  body.a = R_SL * (limb.p_DE.first * qdd + limb.p_DE.second * (qd * qd) - gravity_L);
  body.J_v.setZero();
  body.J_v.col(i) = R_SL * limb.p_DE.first;
}

/// What strut_motion() leaves of a BodyState.
template <class T, class Robot>
void strut_state(const LimbGeometry<T>& geometry, const LimbPosture<T, Robot::kDrives>& limb,
                 const LimbMotion<T>& motion, const typename JacobianRates<T, Robot>::Limb& rates, int i, const T& qd,
                 BodyState<T, Robot::kDrives>& body) {
  const Matrix3<T>& R_WL = limb.R_WL;
  const Matrix3<T> R_LS = rot_y(limb.beta) * rot_z(limb.gamma);
  const T& s = limb.gamma.sin;
  const T& c = limb.gamma.cos;
  body.Jd_v.setZero();
  body.Jd_v.col(i) = R_LS.transpose() * limb.p_DE.second * qd;
  body.Jd_w.row(0) = s * rates.J_beta + (c * motion.gamma_d) * limb.J_beta;
  body.Jd_w.row(1) = c * rates.J_beta - (s * motion.gamma_d) * limb.J_beta;
  body.Jd_w.row(2) = rates.J_gamma;
  body.R_WB = R_WL * R_LS;
  body.p_WB = geometry.p_WD + R_WL * limb.p_DE.value;
}

/// A part of the plate.
template <class T, class Robot, class BodyType>
void plate_part_motion(const Geometry<T, Robot>& geometry, int k, const Motion<T, Robot>& motion,
                       const JacobianRates<T, Robot>* rates, BodyType& body) {
  body.a = motion.zdd.template head<3>() - geometry.gravity;
  body.J_v = motion.posture.J_plate.template topRows<3>();
  body.w.setZero();
  body.w_d.setZero();
  body.J_w.setZero();
  if constexpr (BodyType::kWithState) {
    body.Jd_v = rates->J_plate.template topRows<3>();
    body.Jd_w.setZero();
    body.R_WB.setIdentity();
    body.p_WB = motion.posture.z.template head<3>();
  } else {
    (void)rates;
  }
  if constexpr (Robot::kPlateTurns) {
    const PartPose<T> part = part_pose(geometry.parts[k], motion.posture.z(3), geometry.yaw_ratio);
    const Vector3<T>& first = part.p.first;
    const Vector3<T>& second = part.p.second;
    body.a += first * motion.zdd(3) + second * (motion.zd(3) * motion.zd(3));
    body.J_v += first * motion.posture.J_plate.row(3);
    const Matrix3<T> R_BW = rot_z(SinCos<T>(T(-part.angle.sin), part.angle.cos));
    body.a = Vector3<T>(R_BW * body.a);
    body.J_v = Matrix<T, 3, Robot::kDrives>(R_BW * body.J_v);
    body.w.z() = part.rate * motion.zd(3);
    body.w_d.z() = part.rate * motion.zdd(3);
    body.J_w.row(2) = part.rate * motion.posture.J_plate.row(3);
    if constexpr (BodyType::kWithState) {
      body.Jd_v += first * rates->J_plate.row(3) + (second * motion.zd(3)) * motion.posture.J_plate.row(3);
      body.Jd_v = Matrix<T, 3, Robot::kDrives>(R_BW * body.Jd_v);
      body.Jd_w.row(2) = part.rate * rates->J_plate.row(3);
      body.R_WB = R_BW.transpose();
      body.p_WB += part.p.value;
    }
  } else {
    (void)k;
  }
}

/// Tool: at the plate's centre, turned by psi about the vertical.
template <class T, class Robot, class BodyType>
void tool_motion(const Vector3<T>& gravity, const Motion<T, Robot>& motion, const JacobianRates<T, Robot>* rates,
                 BodyType& body) {
  constexpr int kPsi = Robot::kDrives - 1;
  const Matrix3<T> R_BW = rot_z(motion.posture.telescope.psi).transpose();
  body.a = R_BW * (motion.zdd.template head<3>() - gravity);
  body.J_v = R_BW * motion.posture.J_plate.template topRows<3>();
  body.w = Vector3<T>(T(0), T(0), motion.qd(kPsi));
  body.w_d = Vector3<T>(T(0), T(0), motion.qdd(kPsi));
  body.J_w.setZero();
  body.J_w(2, kPsi) = T(1);
  if constexpr (BodyType::kWithState) {
    body.Jd_v = R_BW * rates->J_plate.template topRows<3>();
    body.Jd_w.setZero();
    body.R_WB = R_BW.transpose();
    body.p_WB = motion.posture.z.template head<3>();
  } else {
    (void)rates;
  }
}

/// Both parts of the bar: R_WT = Rz(psi) Rx(a) Ry(b); the upper part about its fixed joint, the lower one about the
/// plate's.
template <class T, class Robot, class BodyType>
void telescope_motion(const TelescopeGeometry<T>& geometry, const Vector3<T>& gravity, const Motion<T, Robot>& motion,
                      const JacobianRates<T, Robot>* rates, BodyType& upper, BodyType& lower) {
  constexpr int kPsi = Robot::kDrives - 1;
  const auto& bar = motion.posture.telescope;
  const auto& r = motion.telescope;
  const T psi_d = motion.qd(kPsi);
  const T psi_dd = motion.qdd(kPsi);
  const T &sa = bar.a.sin, &ca = bar.a.cos, &sb = bar.b.sin, &cb = bar.b.cos;

  upper.w << cb * r.a_d - sb * ca * psi_d, r.b_d + sa * psi_d, sb * r.a_d + cb * ca * psi_d;
  upper.w_d << cb * r.a_dd - sb * r.b_d * r.a_d - (cb * ca * r.b_d - sb * sa * r.a_d) * psi_d - sb * ca * psi_dd,
      r.b_dd + ca * r.a_d * psi_d + sa * psi_dd,
      sb * r.a_dd + cb * r.b_d * r.a_d - (sb * ca * r.b_d + cb * sa * r.a_d) * psi_d + cb * ca * psi_dd;
  upper.J_w.row(0) = cb * bar.J_a;
  upper.J_w.row(1) = bar.J_b;
  upper.J_w.row(2) = sb * bar.J_a;
  upper.J_w.col(kPsi) += Vector3<T>(-sb * ca, sa, cb * ca);

  const Matrix3<T> R_TW = rot_y(bar.b).transpose() * rot_x(bar.a).transpose() * rot_z(bar.psi).transpose();
  upper.a = R_TW * -gravity;
  upper.J_v.setZero();
  lower.w = upper.w;
  lower.w_d = upper.w_d;
  lower.J_w = upper.J_w;
  lower.a = R_TW * (motion.zdd.template head<3>() - gravity);
  lower.J_v = R_TW * motion.posture.J_plate.template topRows<3>();
  if constexpr (BodyType::kWithState) {
    upper.Jd_v.setZero();
    upper.Jd_w.row(0) = cb * rates->J_a - (sb * r.b_d) * bar.J_a;
    upper.Jd_w.row(1) = rates->J_b;
    upper.Jd_w.row(2) = sb * rates->J_a + (cb * r.b_d) * bar.J_a;
    upper.Jd_w.col(kPsi) +=
        Vector3<T>(sb * sa * r.a_d - cb * ca * r.b_d, ca * r.a_d, -sb * ca * r.b_d - cb * sa * r.a_d);
    upper.R_WB = R_TW.transpose();
    upper.p_WB = geometry.p_WU;
    lower.Jd_v = R_TW * rates->J_plate.template topRows<3>();
    lower.Jd_w = upper.Jd_w;
    lower.R_WB = upper.R_WB;
    lower.p_WB = motion.posture.z.template head<3>() + geometry.p_BV;
  } else {
    (void)geometry;
    (void)rates;
  }
}

/// \param rates  only looked at for a BodyState
template <class BodyType, class T, class Robot, class Visitor>
void visit_bodies(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                  const JacobianRates<T, Robot>* rates, Visitor&& visit) {
  BodyType body;
  for (int i = 0; i < Robot::kLimbs; ++i) {
    const auto& limb = motion.posture.limbs[i];
    const Vector3<T> gravity_L = limb.R_WL.transpose() * geometry.gravity;
    upper_arm_motion<T, Robot>(geometry.limbs[i], limb, i, gravity_L, motion.qd(i), motion.qdd(i), body);
    visit(Body::upper_arm, i, 1, body);
    if constexpr (kHasPlate<Robot>) {
      strut_motion(limb, motion.limbs[i], i, gravity_L, motion.qd(i), motion.qdd(i), body);
      if constexpr (BodyType::kWithState) {
        strut_state<T, Robot>(geometry.limbs[i], limb, motion.limbs[i], rates->limbs[i], i, motion.qd(i), body);
      }
      visit(Body::strut, i, 2, body);
    }
  }
  for (int k = 0; k < Robot::kPlateParts; ++k) {
    plate_part_motion(geometry, k, motion, rates, body);
    visit(Robot::kParts[k], k, 1, body);
  }
  if constexpr (Robot::kTelescope) {
    tool_motion(geometry.gravity, motion, rates, body);
    visit(Body::tool, 0, 1, body);
    BodyType lower;
    telescope_motion(geometry.telescope, geometry.gravity, motion, rates, body, lower);
    visit(Body::telescope_upper, 0, 1, body);
    visit(Body::telescope_lower, 0, 1, lower);
  }
}

}  // namespace detail

template <class T, class Robot, class Visitor>
void for_each_body(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion, Visitor&& visit) {
  const JacobianRates<T, Robot>* const none = nullptr;
  detail::visit_bodies<BodyMotion<T, Robot::kDrives>>(geometry, motion, none, visit);
}

template <class T, class Robot, class Visitor>
void for_each_body(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                   const JacobianRates<T, Robot>& rates, Visitor&& visit) {
  detail::visit_bodies<BodyState<T, Robot::kDrives>>(geometry, motion, &rates, visit);
}

}  // namespace deltadyn
