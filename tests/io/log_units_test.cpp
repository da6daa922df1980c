#include "deltadyn/io/log_units.hpp"

#include <gtest/gtest.h>
#include <numbers>

namespace deltadyn {
namespace {

TEST(LogUnits, KnowsUnitsInTheSpellingsOfRecorders) {
  struct Row {
    const char* text;
    Quantity quantity;
    Dimension dimension;
    double factor;
  };
  for (const Row& row :
       {Row{"[deg]", Quantity::position, Dimension::angle, std::numbers::pi / 180},
        Row{"\xC2\xB0", Quantity::position, Dimension::angle, std::numbers::pi / 180},
        Row{"1/min", Quantity::velocity, Dimension::angle, std::numbers::pi / 30},
        Row{"rad_s2", Quantity::acceleration, Dimension::angle, 1},
        Row{"rad/s^2", Quantity::acceleration, Dimension::angle, 1},
        Row{"deg/sec", Quantity::velocity, Dimension::angle, std::numbers::pi / 180},
        Row{"(mNm)", Quantity::torque, Dimension::moment, 1e-3}, Row{"N m", Quantity::torque, Dimension::moment, 1},
        Row{"N*m", Quantity::torque, Dimension::moment, 1}, Row{"N\xC2\xB7m", Quantity::torque, Dimension::moment, 1},
        Row{"kN", Quantity::torque, Dimension::force, 1e3}, Row{"Arms", Quantity::torque, Dimension::current, 1},
        Row{"0.1 %", Quantity::torque, Dimension::share_of_rated, 1e-3},
        Row{"\xE2\x80\xB0", Quantity::torque, Dimension::share_of_rated, 1e-3},
        Row{"[0/00]", Quantity::torque, Dimension::share_of_rated, 1e-3},
        Row{"cnt", Quantity::position, Dimension::counts, 1}, Row{"counts/s", Quantity::velocity, Dimension::counts, 1},
        Row{"mm", Quantity::position, Dimension::length, 1e-3},
        Row{"rev", Quantity::position, Dimension::angle, 2 * std::numbers::pi}}) {
    const auto unit = log_unit(row.text);
    ASSERT_TRUE(unit.has_value()) << row.text;
    EXPECT_EQ(unit->quantity, row.quantity) << row.text;
    EXPECT_EQ(unit->dimension, row.dimension) << row.text;
    EXPECT_NEAR(unit->factor, row.factor, 1e-12) << row.text;
  }
  for (const char* text : {"", "furlong", "V", "ms", "degC"}) EXPECT_FALSE(log_unit(text).has_value()) << text;
  EXPECT_EQ(time_unit_s("[ms]"), 1e-3);
  EXPECT_EQ(time_unit_s("sec"), 1.0);
  EXPECT_EQ(time_unit_s("\xC2\xB5s"), 1e-6);
  EXPECT_FALSE(time_unit_s("rad").has_value());
}

TEST(LogUnits, SplitsNameAndUnit) {
  struct Row {
    const char *column, *stem, *unit;
  };
  for (const Row& row :
       {Row{"q1 [rad]", "q1", "rad"}, Row{"Torque (Nm)", "Torque", "Nm"}, Row{"q1_rad_s", "q1", "rad_s"},
        Row{"t / s", "t", "s"}, Row{"PL.CMD([Axis1] Position command)[deg]", "PL.CMD([Axis1] Position command)", "deg"},
        Row{"position[0]", "position[0]", ""}, Row{"Drive A", "Drive A", ""}, Row{"pos_in", "pos_in", ""},
        Row{"actual_q_0", "actual_q_0", ""}, Row{"I1_A", "I1", "A"}, Row{"Speed, rpm", "Speed", "rpm"},
        Row{"Moment in mNm", "Moment", "mNm"}}) {
    const NameAndUnit parts = split_unit(row.column);
    EXPECT_EQ(parts.stem, row.stem) << row.column;
    EXPECT_EQ(parts.unit, row.unit) << row.column;
  }
}

}  // namespace
}  // namespace deltadyn
