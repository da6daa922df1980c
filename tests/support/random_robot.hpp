#pragma once

/// \file
/// Seeded random robots, parameters and states that are far from singular poses. Nothing in them is symmetric.

#include <cstdint>
#include <random>
#include <type_traits>

#include "deltadyn/core/rotation.hpp"
#include "deltadyn/model/cast_geometry.hpp"
#include "deltadyn/model/geometry.hpp"
#include "deltadyn/model/h4.hpp"
#include "deltadyn/model/i4.hpp"
#include "deltadyn/model/par4.hpp"
#include "deltadyn/model/parameter_layout.hpp"

namespace deltadyn::testing_support {

/// Four limbs and two plate parts with an inner coordinate that move as no real plate does: all terms of a part's pose.
struct TurningPlate : Delta3 {
  static constexpr const char* kName = "turning-plate";
  static constexpr const char* kClass = "TurningPlate";
  static constexpr int kLimbs = 4;
  static constexpr int kDrives = 4;
  static constexpr bool kPlateTurns = true;
  static constexpr int kPlateParts = 2;
  static constexpr Body kParts[] = {Body::half_plate, Body::half_plate};
};

/// H4, I4, Par4 and the same with carriages: their parts come from a drawing.
template <class Robot>
inline constexpr bool kDrawnPlate = std::is_base_of_v<FourLimbs, Robot>;

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

/// Mean azimuth of a limb.
template <class Robot>
double mean_azimuth(int limb) {
  constexpr double kRight = 1.5707963267948966;
  if constexpr (std::is_base_of_v<H4, Robot>) {
    // With limbs at 45, 135, 225 and 315 degrees the halves could tip about the crossbar (oracles/bodies_test.cpp).
    constexpr double kAzimuths[] = {0, -kRight, 2 * kRight, -kRight};
    return kAzimuths[limb];
  }
  return (Robot::kPlateTurns ? kRight / 2 : 0.0) + limb * 4 * kRight / Robot::kLimbs;
}

/// About the size of a pick-and-place robot; no two limbs alike.
template <class Robot>
LimbGeometry<double> random_limb(Random& random, double azimuth) {
  // Two struts of an H4 look the same way and hold theta only where they lean.
  constexpr bool kLeans = std::is_base_of_v<H4, Robot> && Robot::kDrive == DriveKind::prismatic;
  constexpr double kFarther = kLeans ? 0.15 : 0;
  LimbGeometry<double> limb;
  limb.azimuth = azimuth + random.uniform(-0.15, 0.15);
  constexpr double kTilt = Robot::kDrive == DriveKind::revolute ? 0.3 : 0.15;  // tilted carriages run out of reach
  if (Robot::kPlateTurns) limb.tilt = random.uniform(-kTilt, kTilt);
  const Matrix3<double> radial = rot_z(SinCos<double>(limb.azimuth));
  if (Robot::kDrive == DriveKind::revolute) {
    limb.p_WD = radial * (Vector3<double>(random.uniform(0.2, 0.3), 0, 0) + random.cube(0.02));
    limb.p_DE_0 = Vector3<double>(random.uniform(0.42, 0.5), 0, 0) + random.cube(0.02);
  } else {
    limb.p_WD = radial * (Vector3<double>(kFarther + random.uniform(0.4, 0.5), 0, 0) + random.cube(0.02));
    limb.axis_L = (random.cube(0.2) - Vector3<double>::UnitZ()).normalized();
    limb.p_DE_0 = random.cube(0.03);
  }
  limb.strut = kFarther + random.uniform(0.95, 1.05);
  limb.strut_spacing = random.uniform(0.05, 0.15);
  limb.p_BA = radial * (Vector3<double>(random.uniform(0.04, 0.08), 0, 0) + random.cube(0.01));
  return limb;
}

/// Lengths of an articulated plate; half of the Par4 carry the tool on half plate 1.
template <class Robot>
PlateShape random_shape(Random& random) {
  constexpr double kRatios[] = {1, 4, -2.5};
  PlateShape shape;
  // Half plate 1 points towards the limbs that it holds.
  shape.azimuth = (std::is_base_of_v<H4, Robot> ? 0.0 : 1.5707963267948966) + random.uniform(-0.15, 0.15);
  shape.spacing = random.uniform(0.08, 0.16);
  shape.bar_spacing = random.uniform(0.05, 0.1);
  shape.pinion_radius = random.uniform(0.03, 0.06);
  const int ratio = static_cast<int>(random.uniform(0, 3));
  if constexpr (!std::is_base_of_v<I4, Robot>) shape.ratio = kRatios[ratio];
  if (random.uniform(0, 1) < 0.5 && std::is_base_of_v<Par4, Robot>) shape.tool = ToolPlace::half_plate;
  shape.range = 0.6;
  return shape;
}

/// Puts the parts of a plate where its drawing has them; limbs 1 and 2 hold half plate 1.
template <class Robot>
void set_plate(const PlateShape& shape, Geometry<double, Robot>& geometry) {
  for (PlatePart<double>& part : geometry.parts) part = {};  // of an earlier drawing nothing may stay
  Robot::place_parts(shape, geometry.parts);
  geometry.yaw_ratio = shape.ratio;
  for (int i = 0; i < Robot::kLimbs; ++i) geometry.limbs[i].part = i < 2 ? 0 : 1;
}

template <class Robot>
Geometry<double, Robot> random_geometry(Random& random) {
  Geometry<double, Robot> geometry;
  for (int i = 0; i < Robot::kLimbs; ++i) geometry.limbs[i] = random_limb<Robot>(random, mean_azimuth<Robot>(i));
  if constexpr (kDrawnPlate<Robot>) {
    set_plate(random_shape<Robot>(random), geometry);
  } else if constexpr (Robot::kPlateTurns) {
    // Limbs on either side of x share a part, which is what lets the loops hold theta.
    for (int i = 0; i < Robot::kLimbs; ++i) geometry.limbs[i].part = i == 0 || i == 3 ? 0 : 1;
    for (int k = 0; k < 2; ++k) {
      const double side = k == 0 ? 1 : -1;
      geometry.parts[k] = {random.cube(0.01), Vector3<double>(side * 0.1, 0, 0) + random.cube(0.01), random.cube(0.005),
                           side * random.uniform(0.2, 0.4), random.uniform(-3, 3)};
    }
    geometry.yaw_ratio = random.uniform(1, 2);
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
/// \param yaw_ratio  of the geometry: the tool may turn so many times as far as a plate that turns
template <class Robot>
RandomTask<Robot> random_task(Random& random, double yaw_ratio = 1) {
  RandomTask<Robot> task;
  constexpr double kHome[] = {0, 0, Robot::kDrive == DriveKind::revolute ? -0.85 : -1.1, 0};
  constexpr double kSpread[] = {0.2, 0.2, 0.08, Robot::kPlateTurns ? 0.5 : 3.0};
  for (int i = 0; i < Robot::kDrives; ++i) {
    task.z(i) = kHasPlate<Robot> ? kHome[i] + random.uniform(-kSpread[i], kSpread[i]) : random.uniform(-1.5, 1.5);
    task.zd(i) = random.uniform(-2, 2);
    task.zdd(i) = random.uniform(-20, 20);
  }
  if constexpr (Robot::kPlateTurns) {
    task.z(3) *= yaw_ratio;
    task.zd(3) *= yaw_ratio;
    task.zdd(3) *= yaw_ratio;
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
