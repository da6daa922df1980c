#pragma once

/// \file
/// Approximated workspaces B of the plate's centre (paper IV.A, Fig. 2): simple convex bodies.

#include <Eigen/Core>
#include <string>

namespace deltadyn {

enum class RegionShape { ball, half_ball, cylinder, cone, box };

/// half_ball is the lower half of the ball; cylinder and cone (frustum) stand upright, with `centre` in the middle of
/// their axis.
struct Region {
  RegionShape shape = RegionShape::ball;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [m]
  double radius = 0;                                 ///< of ball, half ball, cylinder; of the cone at its lower end [m]
  double top_radius = 0;                             ///< of the cone at its upper end [m]
  double height = 0;                                 ///< of cylinder, cone [m]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< edges of the box along x, y, z [m]

  /// Number of inequalities usage(k) <= 1 that make the body.
  [[nodiscard]] int walls() const;
  [[nodiscard]] std::string wall_name(int wall) const;
  /// Share of the way to the wall, 1 on it, and its gradient by p. Round walls: the squared distance from the axis or
  /// centre over the squared radius.
  double usage(int wall, const Eigen::Vector3d& p, Eigen::Vector3d* gradient = nullptr) const;
  [[nodiscard]] bool contains(const Eigen::Vector3d& p) const;
  /// Corners of the upright box around the body.
  [[nodiscard]] Eigen::Vector3d lower() const;
  [[nodiscard]] Eigen::Vector3d upper() const;
  /// "lower half ball of radius 0.35 m about (0, 0, -0.8) m".
  [[nodiscard]] std::string text() const;
  /// Throws deltadyn::Error(usage) if a length that the shape needs is missing or not positive.
  void validate() const;
};

/// half-ball, ball, cylinder, cone, box. Throws deltadyn::Error(usage) for another word.
[[nodiscard]] RegionShape region_shape(const std::string& word);

}  // namespace deltadyn
