#pragma once

/// \file
/// Seeded random robots, parameters and states that are far from singular poses. Nothing in them is symmetric.

#include <cstdint>
#include <random>

#include "deltadyn/core/rotation.hpp"
#include "deltadyn/model/cast_geometry.hpp"
#include "deltadyn/model/geometry.hpp"
#include "deltadyn/model/parameter_layout.hpp"

namespace deltadyn::testing_support {

/// Four limbs and two plate parts with an inner coordinate: the general plate (H4, I4, Par4 are special cases).
struct TurningPlate : Delta3 {
  static constexpr const char* kName = "turning-plate";
  static constexpr int kLimbs = 4;
  static constexpr int kDrives = 4;
  static constexpr bool kPlateTurns = true;
  static constexpr int kPlateParts = 2;
};

/// The same numbers with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double lower, double upper) {
    return lower + (upper - lower) * static_cast<double>(engine_() >> 11U) * 0x1.0p-53;
  }
  Vector3<double> cube(double half) {
    const double x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
    return Vector3<double>(x, y, z);
  }

 private:
  std::mt19937_64 engine_;
};

/// About the size of a pick-and-place robot; no two limbs alike.
template <class Robot>
Geometry<double, Robot> random_geometry(Random& random) {
  Geometry<double, Robot> geometry;
  for (int i = 0; i < Robot::kLimbs; ++i) {
    LimbGeometry<double>& limb = geometry.limbs[i];
    const double first = Robot::kPlateTurns ? 0.785 : 0.0;
    limb.azimuth = first + i * 6.283185307179586 / Robot::kLimbs + random.uniform(-0.15, 0.15);
    const Matrix3<double> R_WL = rot_z(SinCos<double>(limb.azimuth));
    if (Robot::kDrive == DriveKind::revolute) {
      limb.p_WD = R_WL * (Vector3<double>(random.uniform(0.2, 0.3), 0, 0) + random.cube(0.02));
      limb.p_DE_0 = Vector3<double>(random.uniform(0.42, 0.5), 0, 0) + random.cube(0.02);
    } else {
      limb.p_WD = R_WL * (Vector3<double>(random.uniform(0.4, 0.5), 0, 0) + random.cube(0.02));
      limb.axis_L = (random.cube(0.2) - Vector3<double>::UnitZ()).normalized();
      limb.p_DE_0 = random.cube(0.03);
    }
    limb.strut = random.uniform(0.95, 1.05);
    limb.strut_spacing = random.uniform(0.05, 0.15);
    limb.p_BA = R_WL * (Vector3<double>(random.uniform(0.04, 0.08), 0, 0) + random.cube(0.01));
  }
  if constexpr (Robot::kPlateTurns) {
    // Limbs on either side of x share a part, which is what lets the loops hold theta.
    for (int i = 0; i < Robot::kLimbs; ++i) geometry.limbs[i].part = i == 0 || i == 3 ? 0 : 1;
    for (int k = 0; k < 2; ++k) {
      const double side = k == 0 ? 1 : -1;
      geometry.parts[k] = {random.cube(0.01), Vector3<double>(side * 0.1, 0, 0) + random.cube(0.01), random.cube(0.005),
                           side * random.uniform(0.2, 0.4)};
    }
  }
  geometry.telescope.p_WU = random.cube(0.03);
  geometry.telescope.p_BV = random.cube(0.03);
  geometry.gravity = Vector3<double>(0, 0, -9.81) + random.cube(2.0);
  return geometry;
}

template <class Robot>
struct RandomTask {
  using Drives = Vector<double, Robot::kDrives>;
  Drives z, zd, zdd;
};

/// In reach of every random geometry; speeds and accelerations of a fast motion.
template <class Robot>
RandomTask<Robot> random_task(Random& random) {
  RandomTask<Robot> task;
  constexpr double kHome[] = {0, 0, Robot::kDrive == DriveKind::revolute ? -0.85 : -1.1, 0};
  constexpr double kSpread[] = {0.2, 0.2, 0.08, Robot::kPlateTurns ? 0.5 : 3.0};
  for (int i = 0; i < Robot::kDrives; ++i) {
    task.z(i) = kHasPlate<Robot> ? kHome[i] + random.uniform(-kSpread[i], kSpread[i]) : random.uniform(-1.5, 1.5);
    task.zd(i) = random.uniform(-2, 2);
    task.zdd(i) = random.uniform(-20, 20);
  }
  return task;
}

/// Ten parameters of five point masses: physically consistent, none of them zero.
inline Vector<double, kInertialParameters> random_body(Random& random) {
  Vector<double, kInertialParameters> p = Vector<double, kInertialParameters>::Zero();
  const Vector3<double> middle = random.cube(0.2);
  for (int k = 0; k < 5; ++k) {
    const double m = random.uniform(0.1, 0.5);
    const Vector3<double> r = middle + random.cube(0.2);
    Vector<double, kInertialParameters> point;
    point << 1, r.x(), r.y(), r.z(), r.y() * r.y() + r.z() * r.z(), r.x() * r.x() + r.z() * r.z(),
        r.x() * r.x() + r.y() * r.y(), -r.x() * r.y(), -r.y() * r.z(), -r.x() * r.z();
    p += m * point;
  }
  return p;
}

/// All columns of a layout: consistent bodies, positive friction and rotor inertia, offsets of either sign.
template <class Layout>
Vector<double, Layout::kColumns> random_parameters(Random& random) {
  Vector<double, Layout::kColumns> p;
  for (int b = 0; b < Layout::kBodies; ++b) {
    p.template segment<kInertialParameters>(kInertialParameters * b) = random_body(random);
  }
  for (int k = Layout::kFriction; k < Layout::kOffset; ++k) p(k) = random.uniform(0.1, 3.0);
  for (int k = Layout::kOffset; k < Layout::kColumns; ++k) p(k) = random.uniform(-2.0, 2.0);
  return p;
}

}  // namespace deltadyn::testing_support
