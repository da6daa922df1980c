#pragma once

/// \file
/// Where three limbs put the plate: its centre lies on three spheres about c_i = E_i - p_BA_i with the strut lengths as
/// radii; of the two intersections the lower one is the robot's.

#include <Eigen/Geometry>
#include <cmath>

#include "deltadyn/kinematics/posture.hpp"

namespace deltadyn {

/// Lower intersection of three spheres.
/// \return unreachable if they do not meet, singular if their centres are in line
template <class T>
Status lower_intersection(const Vector3<T> (&c)[3], const T (&radius)[3], Vector3<T>& p) {
  using std::sqrt;
  const Vector3<T> d2 = c[1] - c[0];
  const Vector3<T> d3 = c[2] - c[0];
  const T length2 = sqrt(d2.squaredNorm());
  if (!(length2 > T(1e-6))) return Status::singular;
  const Vector3<T> e_x = d2 / length2;
  const T along3 = e_x.dot(d3);
  const Vector3<T> rest = d3 - along3 * e_x;
  const T across3 = sqrt(rest.squaredNorm());
  if (!(across3 > T(1e-6))) return Status::singular;
  const Vector3<T> e_y = rest / across3;
  const T r0 = radius[0] * radius[0];
  const T x = (r0 - radius[1] * radius[1] + length2 * length2) / (T(2) * length2);
  const T y = (r0 - radius[2] * radius[2] + d3.squaredNorm() - T(2) * along3 * x) / (T(2) * across3);
  const T square = r0 - x * x - y * y;
  if (!(square >= T(0))) return Status::unreachable;
  Vector3<T> e_z = e_x.cross(e_y);
  if (e_z.z() > T(0)) e_z = -e_z;
  p = c[0] + x * e_x + y * e_y + sqrt(square) * e_z;
  return Status::ok;
}

/// Plate centre that three limbs allow.
/// \param elbows    of all limbs, in W
/// \param left_out  the limb, from 0, that is not one of them
template <class T, class Robot>
Status centre_on_three_limbs(const Geometry<T, Robot>& geometry, const Vector3<T> (&elbows)[Robot::kLimbs],
                             const Attachments<T, Robot>& attachments, Vector3<T>& r, int left_out) {
  Vector3<T> centre[3];
  T radius[3];
  for (int k = 0; k < 3; ++k) {
    const int i = k < left_out ? k : k + 1;
    centre[k] = elbows[i] - attachments(i).value;
    radius[k] = geometry.limbs[i].strut;
  }
  return lower_intersection(centre, radius, r);
}

}  // namespace deltadyn
