#include "deltadyn/trajectory/region.hpp"

#include <gmock/gmock.h>

#include "deltadyn/runtime/error.hpp"

#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using testing_support::Random;

Region region_of(RegionShape shape) {
  Region region;
  region.shape = shape;
  region.centre = {0.1, -0.05, -0.8};
  region.radius = 0.3;
  region.top_radius = 0.5;
  region.height = 0.4;
  region.size = {0.6, 0.8, 0.3};
  return region;
}

constexpr RegionShape kAll[] = {RegionShape::ball, RegionShape::half_ball, RegionShape::cylinder, RegionShape::cone,
                                RegionShape::box};

/// The definition of each shape, once more.
bool inside(RegionShape shape, const Eigen::Vector3d& d) {
  switch (shape) {
    case RegionShape::ball: return d.norm() <= 0.3;
    case RegionShape::half_ball: return d.norm() <= 0.3 && d.z() <= 0;
    case RegionShape::cylinder: return d.head<2>().norm() <= 0.3 && std::abs(d.z()) <= 0.2;
    case RegionShape::cone: return std::abs(d.z()) <= 0.2 && d.head<2>().norm() <= 0.4 + 0.5 * d.z();
    case RegionShape::box: return std::abs(d.x()) <= 0.3 && std::abs(d.y()) <= 0.4 && std::abs(d.z()) <= 0.15;
  }
  return false;
}

TEST(Region, ContainsWhatItsDefinitionSays) {
  Random random(1);
  for (const RegionShape shape : kAll) {
    const Region region = region_of(shape);
    int count = 0;
    for (int k = 0; k < 4000; ++k) {
      const Eigen::Vector3d d = random.cube(0.6);
      const Eigen::Vector3d p = region.centre + d;
      ASSERT_EQ(region.contains(p), inside(shape, d)) << region.text() << " at " << d.transpose();
      if (!region.contains(p)) continue;
      ++count;
      EXPECT_TRUE((p.array() >= region.lower().array()).all() && (p.array() <= region.upper().array()).all());
    }
    EXPECT_GT(count, 50);
  }
}

TEST(Region, GradientsAreSlopes) {
  Random random(2);
  for (const RegionShape shape : kAll) {
    const Region region = region_of(shape);
    for (int wall = 0; wall < region.walls(); ++wall) {
      const Eigen::Vector3d p = region.centre + random.cube(0.2);
      Eigen::Vector3d gradient;
      region.usage(wall, p, &gradient);
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d h = 1e-6 * Eigen::Vector3d::Unit(axis);
        EXPECT_NEAR(gradient(axis), (region.usage(wall, p + h) - region.usage(wall, p - h)) / 2e-6, 1e-7);
      }
      EXPECT_FALSE(region.wall_name(wall).empty());
    }
  }
}

TEST(Region, RefusesMissingLengths) {
  for (const RegionShape shape : kAll) {
    EXPECT_NO_THROW(region_of(shape).validate());
    Region region;
    region.shape = shape;
    EXPECT_THROW(region.validate(), Error);
  }
  EXPECT_EQ(region_shape("half-ball"), RegionShape::half_ball);
  EXPECT_THROW((void)region_shape("sphere"), Error);
}

}  // namespace
}  // namespace deltadyn
