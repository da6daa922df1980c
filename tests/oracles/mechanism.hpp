#pragma once

/// \file
/// A Delta-like mechanism as loop equations and body poses, written from the drawing and sharing no code with the
/// library.
///
/// The plate is found by Newton's iteration on |A_i(y) - E_i(q_i)|^2 = L_i^2, orientations from directions and cross
/// products: no joint angle, no rate and no Jacobian of the library appears. Every function takes nested dual numbers.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "oracles/dual.hpp"

namespace oracles {

template <class S>
using Vec3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using Mat3 = Eigen::Matrix<S, 3, 3>;
using Numbers = std::vector<Real>;

struct Limb {
  Real azimuth = 0;
  /// Drive origin in the base frame; axis and elbow (at coordinate 0) in the limb frame
  Vec3<Real> drive, axis, elbow;
  Real strut = 0, spacing = 0;
  Vec3<Real> attachment;  ///< from the origin of the plate part, in the base frame
  int part = 0;
  Real tilt = 0;  ///< of the limb frame about its own x, after the azimuth
};

struct Part {
  Vec3<Real> c, a, b;
  Real kappa = 0;
  Real turn = 0;  ///< of the part's frame where the plate is not turned
};

struct Mechanism {
  bool prismatic = false, turning_plate = false, has_bar = false;
  std::vector<Limb> limbs;
  std::vector<Part> parts;
  Real yaw_ratio = 1;              ///< yaw of the tool, the fourth plate coordinate, a turn theta of the plate
  Vec3<Real> bar_top, bar_bottom;  ///< in the base frame, from the plate centre
  Vec3<Real> gravity;

  [[nodiscard]] std::size_t drives() const { return limbs.size() + (has_bar ? 1 : 0); }
  [[nodiscard]] std::size_t plate_coordinates() const { return parts.empty() ? 0 : (turning_plate ? 4 : 3); }
};

/// Orientation and origin of a body frame in the base frame.
template <class S>
struct Pose {
  Mat3<S> R;
  Vec3<S> p;
};

template <class S>
Vec3<S> lift(const Vec3<Real>& v) {
  return Vec3<S>(S(v.x()), S(v.y()), S(v.z()));
}

/// Right-hand turn about e_x (axis 0), e_y (axis 1) or e_z (axis 2).
template <class S>
Mat3<S> turn(int axis, const S& angle) {
  using std::cos;
  using std::sin;
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  Mat3<S> R;
  for (int k = 0; k < 9; ++k) R(k / 3, k % 3) = S(k / 3 == k % 3 ? 1 : 0);
  R(i, i) = R(j, j) = cos(angle);
  R(j, i) = sin(angle);
  R(i, j) = -R(j, i);
  return R;
}

template <class S>
Vec3<S> unit(const Vec3<S>& v) {
  using std::sqrt;
  const S length = sqrt(S(v.dot(v)));
  return Vec3<S>(v.x() / length, v.y() / length, v.z() / length);
}

template <class S>
Mat3<S> columns(const Vec3<S>& x, const Vec3<S>& y, const Vec3<S>& z) {
  Mat3<S> R;
  R.col(0) = x;
  R.col(1) = y;
  R.col(2) = z;
  return R;
}

/// Orientation of the limb frame: x radially outwards, y along the axis of a revolute drive.
template <class S>
Mat3<S> limb_axes(const Limb& limb) {
  return turn<S>(2, S(limb.azimuth)) * turn<S>(0, S(limb.tilt));
}

template <class S>
Vec3<S> elbow_point(const Mechanism& m, std::size_t i, const S& q) {
  const Limb& limb = m.limbs[i];
  Vec3<S> d = lift<S>(limb.elbow);
  if (m.prismatic) {
    for (int k = 0; k < 3; ++k) d(k) += q * S(limb.axis(k));
  } else {
    d = turn<S>(1, q) * d;
  }
  return lift<S>(limb.drive) + limb_axes<S>(limb) * d;
}

/// Inner coordinate of a plate that turns.
template <class S>
S theta(const Mechanism& m, const std::vector<S>& y) {
  return y[3] / S(m.yaw_ratio);
}

template <class S>
Pose<S> part_pose(const Mechanism& m, std::size_t k, const std::vector<S>& y) {
  const Part& part = m.parts[k];
  const Vec3<S> r(y[0], y[1], y[2]);
  if (!m.turning_plate) return {turn<S>(2, S(0)), r};
  const S angle = theta(m, y);
  Vec3<S> origin = r + lift<S>(part.c) + turn<S>(2, angle) * lift<S>(part.a);
  for (int j = 0; j < 3; ++j) origin(j) += angle * S(part.b(j));
  return {turn<S>(2, angle * S(part.kappa) + S(part.turn)), origin};
}

template <class S>
Vec3<S> attachment_point(const Mechanism& m, std::size_t i, const std::vector<S>& y) {
  const auto k = static_cast<std::size_t>(m.limbs[i].part);
  const Pose<S> part = part_pose(m, k, y);
  // The attachment is given along the axes of the base, so it knows nothing of the part's own frame.
  const Mat3<S> back = m.turning_plate ? turn<S>(2, S(-m.parts[k].turn)) : turn<S>(2, S(0));
  return part.p + part.R * (back * lift<S>(m.limbs[i].attachment));
}

/// |A_i - E_i|^2 - L_i^2, zero where limb i is closed.
template <class S>
S loop_error(const Mechanism& m, std::size_t i, const S& q, const std::vector<S>& y) {
  const Vec3<S> w = attachment_point(m, i, y) - elbow_point(m, i, q);
  return w.dot(w) - S(m.limbs[i].strut * m.limbs[i].strut);
}

/// Gaussian elimination with row exchange for one right side of any scalar; A is n x n, row by row.
template <class S>
std::vector<S> solve_linear(std::vector<Numbers> A, std::vector<S> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (std::abs(A[i][k]) > std::abs(A[pivot][k])) pivot = i;
    }
    std::swap(A[k], A[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const Real factor = A[i][k] / A[k][k];
      for (std::size_t j = k; j < n; ++j) A[i][j] -= factor * A[k][j];
      b[i] -= S(factor) * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= S(A[k][j]) * b[j];
    b[k] /= S(A[k][k]);
  }
  return b;
}

template <class S>
std::vector<S> loop_errors(const Mechanism& m, const std::vector<S>& q, const std::vector<S>& y) {
  std::vector<S> errors;
  for (std::size_t i = 0; i < y.size(); ++i) errors.push_back(loop_error(m, i, q[i], y));
  return errors;
}

/// Derivatives of the loop errors by the plate coordinates.
inline std::vector<Numbers> loop_jacobian(const Mechanism& m, const Numbers& q, const Numbers& y) {
  const std::size_t n = y.size();
  std::vector<Numbers> J(n, Numbers(n));
  for (std::size_t j = 0; j < n; ++j) {
    std::vector<Dual<Real>> seeded;
    for (std::size_t k = 0; k < n; ++k) seeded.push_back(Dual<Real>(y[k], k == j ? 1.0L : 0.0L));
    for (std::size_t i = 0; i < n; ++i) J[i][j] = loop_error(m, i, Dual<Real>(q[i]), seeded).slope;
  }
  return J;
}

/// Plate coordinates at drive coordinates q, the solution that Newton's iteration reaches from `guess`.
/// Throws std::runtime_error if it does not converge.
template <class S>
std::vector<S> plate(const Mechanism& m, const std::vector<S>& q, const Numbers& guess) {
  Numbers y0(guess.begin(), guess.begin() + static_cast<std::ptrdiff_t>(m.plate_coordinates()));
  Numbers q0;
  for (const S& x : q) q0.push_back(base(x));
  if (y0.empty()) return {};
  const auto subtract = [](auto& y, const auto& step) {
    for (std::size_t k = 0; k < y.size(); ++k) y[k] -= step[k];
  };
  Real largest = 1;
  for (int iteration = 0; iteration < 60 && !(largest < 1e-18L); ++iteration) {
    const Numbers errors = loop_errors(m, q0, y0);
    subtract(y0, solve_linear(loop_jacobian(m, q0, y0), errors));
    largest = 0;
    for (const Real& error : loop_errors(m, q0, y0)) largest = std::max(largest, std::abs(error));
  }
  if (!(largest < 1e-15L)) throw std::runtime_error("Newton's iteration did not converge");
  // With the Jacobian at the solution each further step makes the derivatives exact to one order more.
  const std::vector<Numbers> J = loop_jacobian(m, q0, y0);
  std::vector<S> y;
  for (const Real& x : y0) y.push_back(S(x));
  for (int order = 0; order < 4; ++order) subtract(y, solve_linear(J, loop_errors(m, q, y)));
  return y;
}

/// Distance of the two universal joints of the bar.
template <class S>
S bar_length(const Mechanism& m, const std::vector<S>& y) {
  using std::sqrt;
  const Vec3<S> w = lift<S>(m.bar_top) - Vec3<S>(y[0], y[1], y[2]) - lift<S>(m.bar_bottom);
  return sqrt(S(w.dot(w)));
}

/// Poses of all bodies: for each limb the upper arm and its two struts, then the parts of the plate, the tool, the
/// upper and the lower part of the bar.
template <class S>
std::vector<Pose<S>> poses(const Mechanism& m, const std::vector<S>& q, const Numbers& guess) {
  const std::vector<S> y = plate(m, q, guess);
  std::vector<Pose<S>> bodies;
  for (std::size_t i = 0; i < m.limbs.size(); ++i) {
    const Limb& limb = m.limbs[i];
    const Mat3<S> R_L = limb_axes<S>(limb);
    if (m.prismatic) {
      Vec3<S> along = lift<S>(limb.axis);
      for (int k = 0; k < 3; ++k) along(k) *= q[i];
      bodies.push_back({R_L, lift<S>(limb.drive) + R_L * along});
    } else {
      bodies.push_back({R_L * turn<S>(1, q[i]), lift<S>(limb.drive)});
    }
    if (m.parts.empty()) continue;
    const Vec3<S> E = elbow_point(m, i, q[i]);
    const Vec3<S> A = attachment_point(m, i, y);
    const Vec3<S> y_L = R_L.col(1);
    for (const Real side : {0.5L, -0.5L}) {
      // Each strut between its own two ball joints. It turns about y of the limb and about its own z, so z stays at
      // right angles to y of the limb.
      const Vec3<S> offset = lift<S>(Vec3<Real>(0, side * limb.spacing, 0));
      const Vec3<S> from = E + R_L * offset;
      const Vec3<S> to = A + R_L * offset;
      const Vec3<S> x = unit<S>(to - from);
      const Vec3<S> z = unit<S>(x.cross(y_L));
      bodies.push_back({columns<S>(x, z.cross(x), z), from});
    }
  }
  for (std::size_t k = 0; k < m.parts.size(); ++k) bodies.push_back(part_pose(m, k, y));
  if (m.has_bar) {
    const Vec3<S> r(y[0], y[1], y[2]);
    const Mat3<S> R_psi = turn<S>(2, q.back());
    bodies.push_back({R_psi, r});
    const Vec3<S> lower = r + lift<S>(m.bar_bottom);
    const Vec3<S> z = unit<S>(lift<S>(m.bar_top) - lower);
    const Vec3<S> x_psi = R_psi.col(0);
    const Vec3<S> y_T = unit<S>(z.cross(x_psi));  // the first axis of the joint is x of the turned frame
    const Mat3<S> R_T = columns<S>(y_T.cross(z), y_T, z);
    bodies.push_back({R_T, lift<S>(m.bar_top)});
    bodies.push_back({R_T, lower});
  }
  return bodies;
}

/// All drive coordinates in [lower, upper] that close limb i at plate coordinates y, ascending: sign changes, then
/// bisection.
inline Numbers drive_roots(const Mechanism& m, std::size_t i, const Numbers& y, Real lower, Real upper) {
  constexpr int kSteps = 500;
  Numbers roots;
  const Real step = (upper - lower) / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    Real a = lower + step * k, b = lower + step * (k + 1);
    const bool rises = loop_error(m, i, a, y) < 0;
    if (rises == (loop_error(m, i, b, y) < 0)) continue;
    for (int bisection = 0; bisection < 70; ++bisection) {
      const Real middle = (a + b) / 2;
      ((loop_error(m, i, middle, y) < 0) == rises ? a : b) = middle;
    }
    roots.push_back((a + b) / 2);
  }
  return roots;
}

}  // namespace oracles
