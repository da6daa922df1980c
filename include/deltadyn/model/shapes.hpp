#pragma once

/// \file
/// Inertial parameters of simple shapes: what a drawing tells before anything is measured (Gnad et al. 2024, VIII.A).
///
/// All functions give the 10-vector of paper (4), `m mcx mcy mcz Ixx Iyy Izz Ixy Iyz Ixz`, about the origin of the
/// frame in which the places are given. Shapes are homogeneous. Cylinders lie along z with their centre at the origin,
/// or between two points. Masses in kg, lengths in m. Bodies are built by adding the vectors of their parts, which
/// share one frame.

#include <Eigen/Geometry>
#include <cmath>

#include "deltadyn/core/types.hpp"
#include "deltadyn/model/inertial_parameters.hpp"

namespace deltadyn::shapes {

/// Pi in scalar T; `std::numbers` is not part of C++17.
template <class T>
inline constexpr T kPi = T(3.14159265358979323846);

/// The body seen from frame A: frame B of `p_B` has orientation R_AB and the same origin.
template <class T>
[[nodiscard]] InertialVector<T> rotated(const InertialVector<T>& p_B, const Matrix3<T>& R_AB) {
  PseudoInertia<T> X = PseudoInertia<T>::Identity();
  X.template topLeftCorner<3, 3>() = R_AB;
  const PseudoInertia<T> half = X.lazyProduct(to_pseudo_inertia(p_B));
  return from_pseudo_inertia<T>(half.lazyProduct(X.transpose()));
}

/// The body seen from frame A: frame B of `p_B` is parallel to A with its origin at p_AB. The law of parallel axes
/// holds for any origin here, not only for the centre of mass.
template <class T>
[[nodiscard]] InertialVector<T> translated(const InertialVector<T>& p_B, const Vector3<T>& p_AB) {
  PseudoInertia<T> X = PseudoInertia<T>::Identity();
  X.template topRightCorner<3, 1>() = p_AB;
  const PseudoInertia<T> half = X.lazyProduct(to_pseudo_inertia(p_B));
  return from_pseudo_inertia<T>(half.lazyProduct(X.transpose()));
}

/// The round shape that lies along z around the origin, moved so that it reaches from `from` to `to`.
/// A shape of no length (from = to) keeps its direction.
template <class T>
[[nodiscard]] InertialVector<T> between(const InertialVector<T>& along_z, const Vector3<T>& from,
                                        const Vector3<T>& to) {
  using std::sqrt;
  const Vector3<T> direction = to - from;
  const Vector3<T> centre = T(0.5) * (from + to);
  const T length = sqrt(direction.squaredNorm());
  if (!(length > T(0))) return translated<T>(along_z, centre);
  // Any turn with z along the direction will do, so start from the axis that is farthest from it.
  Matrix3<T> R;
  R.col(2) = direction / length;
  int least = 0;
  R.col(2).cwiseAbs().minCoeff(&least);
  const Vector3<T> x = Vector3<T>::Unit(least).cross(R.col(2));
  R.col(0) = x / sqrt(x.squaredNorm());
  R.col(1) = R.col(2).cross(R.col(0));
  return translated<T>(rotated<T>(along_z, R), centre);
}

/// Hollow cylinder along z, centre at the origin: Izz = m (Ro^2 + Ri^2) / 2, Ixx = Iyy = m (L^2 + 3 (Ro^2 + Ri^2)) /
/// 12.
template <class T>
[[nodiscard]] InertialVector<T> hollow_cylinder(T mass, T outer_radius, T inner_radius, T length) {
  const T squares = outer_radius * outer_radius + inner_radius * inner_radius;
  InertialVector<T> p = InertialVector<T>::Zero();
  p(inertial::kM) = mass;
  p(inertial::kIxx) = p(inertial::kIyy) = mass * (length * length + T(3) * squares) / T(12);
  p(inertial::kIzz) = mass * squares / T(2);
  return p;
}

/// Hollow cylinder between two points on its axis.
template <class T>
[[nodiscard]] InertialVector<T> hollow_cylinder(T mass, T outer_radius, T inner_radius, const Vector3<T>& from,
                                                const Vector3<T>& to) {
  return between<T>(hollow_cylinder<T>(mass, outer_radius, inner_radius, T((to - from).norm())), from, to);
}

/// Solid cylinder along z, centre at the origin.
template <class T>
[[nodiscard]] InertialVector<T> solid_cylinder(T mass, T radius, T length) {
  return hollow_cylinder<T>(mass, radius, T(0), length);
}

/// Solid cylinder between two points on its axis.
template <class T>
[[nodiscard]] InertialVector<T> solid_cylinder(T mass, T radius, const Vector3<T>& from, const Vector3<T>& to) {
  return hollow_cylinder<T>(mass, radius, T(0), from, to);
}

/// Mass of a tube [kg] from its density [kg/m^3]; inner radius 0 for a solid one.
template <class T>
[[nodiscard]] T cylinder_mass(T density, T outer_radius, T inner_radius, T length) {
  return density * kPi<T> * (outer_radius * outer_radius - inner_radius * inner_radius) * length;
}

}  // namespace deltadyn::shapes
