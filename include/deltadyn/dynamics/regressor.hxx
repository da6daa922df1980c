#pragma once

namespace deltadyn {

template <class T, int N>
Matrix<T, 3, kInertialParameters> force_regressor(const BodyMotion<T, N>& body) {
  // f = m a + (S(w_d) + S(w) S(w)) m c
  Matrix<T, 3, kInertialParameters> F;
  const Matrix3<T> S = skew(body.w);
  F.col(0) = body.a;
  F.template middleCols<3>(1) = skew(body.w_d) + S.lazyProduct(S);
  F.template rightCols<6>().setZero();
  return F;
}

template <class T, int N>
Matrix<T, 3, kInertialParameters> moment_regressor(const BodyMotion<T, N>& body) {
  // n = m c x a + L(w_d) I + S(w) L(w) I with I w = L(w) (Ixx Iyy Izz Ixy Iyz Ixz)
  const auto inertia_times = [](const Vector3<T>& v) {
    Matrix<T, 3, 6> L;
    L << v.x(), T(0), T(0), v.y(), T(0), v.z(),  //
        T(0), v.y(), T(0), v.x(), v.z(), T(0),   //
        T(0), T(0), v.z(), T(0), v.y(), v.x();
    return L;
  };
  Matrix<T, 3, kInertialParameters> F;
  F.col(0).setZero();
  F.template middleCols<3>(1) = -skew(body.a);
  F.template rightCols<6>() = inertia_times(body.w_d) + skew(body.w).lazyProduct(inertia_times(body.w));
  return F;
}

template <class T, class Robot>
FrictionJoint<T, Robot> friction_joint(const Motion<T, Robot>& motion, int joint) {
  FrictionJoint<T, Robot> f;
  if constexpr (kHasInnerJoint<Robot>) {
    if (joint >= Robot::kDrives) {
      const InnerJoint<T, Robot> inner = inner_joint(motion);
      f.rate = inner.rate;
      f.J = inner.J;
      return f;
    }
  }
  f.rate = motion.qd(joint);
  f.J.setZero();
  f.J(joint) = T(1);
  return f;
}

template <class Layout, class T, class Robot>
void regressor(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
               Matrix<T, Robot::kDrives, Layout::kColumns>& Y) {
  Y.setZero();
  for_each_body(geometry, motion, [&Y](Body kind, int index, int count, const BodyMotion<T, Robot::kDrives>& body) {
    // Principle of virtual power: what the body needs, projected on the drives.
    Y.template middleCols<kInertialParameters>(kInertialParameters * Layout::body(kind, index)) +=
        T(count) * (body.J_v.transpose().lazyProduct(force_regressor(body)) +
                    body.J_w.transpose().lazyProduct(moment_regressor(body)));
  });
  for (int joint = 0; joint < Layout::kFrictionJoints; ++joint) {
    const auto f = friction_joint(motion, joint);
    Y.col(Layout::viscous(joint)) = f.rate * f.J.transpose();
    Y.col(Layout::coulomb(joint)) = sign_of(f.rate) * f.J.transpose();
  }
  for (int drive = 0; drive < Robot::kDrives; ++drive) {
    Y(drive, Layout::kRotorInertia + drive) = motion.qdd(drive);
    Y(drive, Layout::kOffset + drive) = T(1);
  }
}

}  // namespace deltadyn
