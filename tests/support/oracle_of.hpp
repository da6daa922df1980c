#pragma once

/// \file
/// The bridge between the library's types and the oracles, which share nothing else.

#include "deltadyn/model/geometry.hpp"
#include "deltadyn/model/parameter_layout.hpp"

#include "oracles/lagrange.hpp"

namespace deltadyn::testing_support {

template <class Robot>
oracles::Mechanism oracle_of(const Geometry<double, Robot>& geometry) {
  using oracles::Real;  // wider than double: every step up is written out
  const auto real = [](const Vector3<double>& v) { return oracles::Vec3<oracles::Real>(v.cast<oracles::Real>()); };
  oracles::Mechanism m;
  m.prismatic = Robot::kDrive == DriveKind::prismatic;
  m.turning_plate = Robot::kPlateTurns;
  m.has_bar = Robot::kTelescope;
  for (const LimbGeometry<double>& limb : geometry.limbs) {
    m.limbs.push_back({Real(limb.azimuth), real(limb.p_WD), real(limb.axis_L), real(limb.p_DE_0), Real(limb.strut),
                       Real(limb.strut_spacing), real(limb.p_BA), limb.part, Real(limb.tilt)});
  }
  for (int k = 0; k < Robot::kPlateParts; ++k) {
    const PlatePart<double>& part = geometry.parts[k];
    m.parts.push_back({real(part.c), real(part.a), real(part.b), Real(part.kappa), Real(part.turn)});
  }
  m.yaw_ratio = Real(geometry.yaw_ratio);
  m.bar_top = real(geometry.telescope.p_WU);
  m.bar_bottom = real(geometry.telescope.p_BV);
  m.gravity = real(geometry.gravity);
  return m;
}

/// Columns of the regressor as the oracle's bodies: a limb's strut stands for two.
template <class Robot, class Layout>
oracles::Load load_of(const Vector<double, Layout::kColumns>& p) {
  oracles::Load load;
  const auto add = [&](Body kind, int index) {
    oracles::Ten ten{};
    for (int k = 0; k < kInertialParameters; ++k) {
      ten[static_cast<std::size_t>(k)] = oracles::Real(p(kInertialParameters * Layout::body(kind, index) + k));
    }
    load.bodies.push_back(ten);
  };
  for (int i = 0; i < Robot::kLimbs; ++i) {
    add(Body::upper_arm, i);
    for (int strut = 0; strut < (kHasPlate<Robot> ? 2 : 0); ++strut) add(Body::strut, i);
  }
  for (int k = 0; k < Robot::kPlateParts; ++k) add(Robot::kParts[k], k);
  if constexpr (Robot::kTelescope) {
    add(Body::tool, 0);
    add(Body::telescope_upper, 0);
    add(Body::telescope_lower, 0);
  }
  for (int joint = 0; joint < Layout::kFrictionJoints; ++joint) {
    load.viscous.push_back(oracles::Real(p(Layout::viscous(joint))));
    load.coulomb.push_back(oracles::Real(p(Layout::coulomb(joint))));
  }
  for (int drive = 0; drive < Robot::kDrives; ++drive) {
    load.rotor_inertia.push_back(oracles::Real(p(Layout::kRotorInertia + drive)));
    load.offset.push_back(oracles::Real(p(Layout::kOffset + drive)));
  }
  return load;
}

template <class Derived>
oracles::Numbers numbers(const Eigen::MatrixBase<Derived>& v) {
  oracles::Numbers out;
  for (Eigen::Index i = 0; i < v.size(); ++i) out.push_back(static_cast<oracles::Real>(v(i)));
  return out;
}

/// A motion q(t) in second order, as nested dual numbers by time: value.value, slope.value and slope.slope hold the
/// derivatives.
template <class Derived>
std::vector<oracles::Dual<oracles::Dual<oracles::Real>>> in_time(const Eigen::MatrixBase<Derived>& q,
                                                                 const Eigen::MatrixBase<Derived>& qd,
                                                                 const Eigen::MatrixBase<Derived>& qdd) {
  using First = oracles::Dual<oracles::Real>;
  std::vector<oracles::Dual<First>> out;
  for (Eigen::Index i = 0; i < q.size(); ++i) out.push_back({First(q(i), qd(i)), First(qd(i), qdd(i))});
  return out;
}

template <int N>
Vector<double, N> to_vector(const oracles::Numbers& values) {
  Vector<double, N> v;
  for (int i = 0; i < N; ++i) v(i) = static_cast<double>(values[static_cast<std::size_t>(i)]);
  return v;
}

}  // namespace deltadyn::testing_support
