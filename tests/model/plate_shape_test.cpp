#include "deltadyn/model/plate_shape.hpp"

#include <gtest/gtest.h>

#include "deltadyn/model/h4.hpp"
#include "deltadyn/model/i4.hpp"
#include "deltadyn/model/par4.hpp"

namespace deltadyn {
namespace {

using Vec = Vector3<double>;

PlateShape some_shape() {
  PlateShape shape;
  shape.azimuth = 0.3;
  shape.spacing = 0.12;
  shape.bar_spacing = 0.07;
  shape.pinion_radius = 0.04;
  shape.ratio = 4;
  return shape;
}

/// Origin of a part from the plate's centre.
Vec part_origin(const PlatePart<double>& part, double theta) {
  return part.c + rot_z(SinCos<double>(theta)) * part.a + theta * part.b;
}

TEST(H4, TheHingesStayAtTheEndsOfTheCrossbar) {
  PlatePart<double> parts[H4::kPlateParts];
  H4::place_parts(some_shape(), parts);
  for (const double theta : {-0.8, 0.0, 0.5}) {
    const double angle = parts[2].turn + parts[2].kappa * theta;
    const Vec along(std::cos(angle), std::sin(angle), 0);
    EXPECT_LT((part_origin(parts[0], theta) - 0.06 * along).norm(), 1e-15);
    EXPECT_LT((part_origin(parts[1], theta) + 0.06 * along).norm(), 1e-15);
    EXPECT_EQ(part_origin(parts[2], theta).norm(), 0);
  }
  EXPECT_EQ(parts[0].kappa, 0);
  EXPECT_EQ(parts[1].kappa, 0);
  EXPECT_EQ(parts[3].kappa, 4);
}

TEST(I4, TheRacksMoveAsThePinionRolls) {
  PlatePart<double> parts[I4::kPlateParts];
  I4::place_parts(some_shape(), parts);
  for (const double theta : {-1.5, 0.0, 2.0}) {
    // The teeth of half 1 are on its own side of the pinion: e_z theta x radius.
    const Vec travel = 0.04 * theta * cross_z<double>(some_shape().outwards());
    EXPECT_LT((part_origin(parts[0], theta) - travel).norm(), 1e-15);
    EXPECT_LT((part_origin(parts[1], theta) + travel).norm(), 1e-15);
  }
  EXPECT_EQ(parts[2].kappa, 1);
}

TEST(Par4, TheBarsJoinTheHingesOfBothHalves) {
  PlatePart<double> parts[Par4::kPlateParts];
  Par4::place_parts(some_shape(), parts);
  const Vec side = 0.035 * cross_z<double>(some_shape().outwards());
  for (const double theta : {-0.8, 0.0, 0.5}) {
    for (const int bar : {2, 3}) {
      const Vec offset = bar == 2 ? side : Vec(-side);
      const Vec end = 0.06 * (rot_z(SinCos<double>(theta)) * some_shape().outwards());
      EXPECT_LT((part_origin(parts[bar], theta) + end - part_origin(parts[0], theta) - offset).norm(), 1e-15);
      EXPECT_LT((part_origin(parts[bar], theta) - end - part_origin(parts[1], theta) - offset).norm(), 1e-15);
    }
  }
}

TEST(Par4, TheToolStandsInTheCentreOrOnAHalf) {
  PlatePart<double> parts[Par4::kPlateParts];
  Par4::place_parts(some_shape(), parts);
  EXPECT_EQ(part_origin(parts[4], 0.4).norm(), 0);
  PlateShape on_half = some_shape();
  on_half.tool = ToolPlace::half_plate;
  Par4::place_parts(on_half, parts);
  EXPECT_LT((part_origin(parts[4], 0.4) - part_origin(parts[0], 0.4)).norm(), 1e-15);
}

}  // namespace
}  // namespace deltadyn
