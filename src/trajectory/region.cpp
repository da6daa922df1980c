#include "deltadyn/trajectory/region.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/plausibility.hpp"

namespace deltadyn {

using Eigen::Vector3d;

int Region::walls() const {
  static constexpr int kWalls[] = {1, 2, 3, 3, 6};
  return kWalls[static_cast<std::size_t>(shape)];
}

std::string Region::wall_name(int wall) const {
  if (shape == RegionShape::box) {
    constexpr const char* kNames[] = {"workspace +x", "workspace -x", "workspace +y",
                                      "workspace -y", "workspace +z", "workspace -z"};
    return kNames[wall];
  }
  if (wall == 0) return "workspace radius";
  return wall == 1 ? "workspace top" : "workspace bottom";
}

double Region::usage(int wall, const Vector3d& p, Vector3d* gradient) const {
  const Vector3d d = p - centre;
  Vector3d g = Vector3d::Zero();
  double value = 0;
  if (shape == RegionShape::box) {
    const int axis = wall / 2;
    const double scale = (wall % 2 == 0 ? 2.0 : -2.0) / size(axis);
    value = scale * d(axis);
    g(axis) = scale;
  } else if (wall == 0) {
    const bool round = shape == RegionShape::ball || shape == RegionShape::half_ball;
    const double slope = shape == RegionShape::cone ? (top_radius - radius) / height : 0.0;
    const double r = shape == RegionShape::cone ? (radius + top_radius) / 2 + slope * d.z() : radius;
    const double across = d.head<2>().squaredNorm() + (round ? d.z() * d.z() : 0.0);
    value = across / (r * r);
    g = 2 * d / (r * r);
    if (!round) g.z() = -2 * across / (r * r * r) * slope;
  } else if (shape == RegionShape::half_ball) {
    value = 1 + d.z() / radius;
    g.z() = 1 / radius;
  } else {
    const double scale = (wall == 1 ? 2.0 : -2.0) / height;
    value = scale * d.z();
    g.z() = scale;
  }
  if (gradient != nullptr) *gradient = g;
  return value;
}

bool Region::contains(const Vector3d& p) const {
  for (int wall = walls() - 1; wall >= 0; --wall) {
    if (!(usage(wall, p) <= 1)) return false;
  }
  return true;
}

Vector3d Region::lower() const {
  switch (shape) {
    case RegionShape::box: return centre - size / 2;
    case RegionShape::ball:
    case RegionShape::half_ball: return centre.array() - radius;
    default: {
      const double r = shape == RegionShape::cone ? std::max(radius, top_radius) : radius;
      return centre - Vector3d(r, r, height / 2);
    }
  }
}

Vector3d Region::upper() const {
  Vector3d corner = 2 * centre - lower();
  if (shape == RegionShape::half_ball) corner.z() = centre.z();
  return corner;
}

std::string Region::text() const {
  // What rounding left of a zero is not told.
  const auto told = [](double length) { return std::abs(length) < 1e-6 ? 0.0 : length; };
  const std::string about =
      fmt::format("about ({:.4g}, {:.4g}, {:.4g}) m", told(centre.x()), told(centre.y()), told(centre.z()));
  switch (shape) {
    case RegionShape::ball: return fmt::format("ball of radius {:.4g} m {}", radius, about);
    case RegionShape::half_ball: return fmt::format("lower half ball of radius {:.4g} m {}", radius, about);
    case RegionShape::cylinder:
      return fmt::format("cylinder of radius {:.4g} m and height {:.4g} m {}", radius, height, about);
    case RegionShape::cone:
      return fmt::format("cone frustum of radii {:.4g} m below, {:.4g} m above and height {:.4g} m {}", radius,
                         top_radius, height, about);
    case RegionShape::box:
      return fmt::format("box of {:.4g} x {:.4g} x {:.4g} m {}", size.x(), size.y(), size.z(), about);
  }
  return "";
}

void Region::validate() const {
  const auto need = [](double value, const char* what) {
    if (!(value > 0) || !std::isfinite(value))
      throw Error(fmt::format("the {} of the workspace is {} m, but must be positive", what, value), "workspace",
                  "give a positive length in metres", ExitCode::usage);
    plausibility::require(plausibility::kOffset, value, fmt::format("the {} of the workspace", what), "workspace",
                          ExitCode::usage);
  };
  if (!centre.allFinite())
    throw Error("the centre of the workspace is not finite", "workspace", "give three finite numbers", ExitCode::usage);
  plausibility::require(plausibility::kOffset, centre.cwiseAbs().maxCoeff(), "the centre of the workspace", "workspace",
                        ExitCode::usage);
  if (shape == RegionShape::box) {
    need(size.minCoeff(), "shortest edge");
    need(size.maxCoeff(), "longest edge");
    return;
  }
  need(radius, "radius");
  if (shape == RegionShape::cylinder || shape == RegionShape::cone) need(height, "height");
  if (shape == RegionShape::cone) need(top_radius, "upper radius");
}

RegionShape region_shape(const std::string& word) {
  static constexpr const char* kWords[] = {"ball", "half-ball", "cylinder", "cone", "box"};
  const auto found = std::ranges::find(kWords, word);
  if (found != std::end(kWords)) return static_cast<RegionShape>(found - kWords);
  throw Error("'" + word + "' is not a shape of a workspace", "workspace", "use half-ball, ball, cylinder, cone or box",
              ExitCode::usage);
}

}  // namespace deltadyn
