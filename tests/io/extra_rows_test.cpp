#include "deltadyn/io/extra_rows.hpp"

#include <gtest/gtest.h>
#include <numbers>

#include "deltadyn/runtime/error.hpp"

#include "io/temporary_folder.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

TEST(PreslidingOf, ReadsTheRowsAndRefusesOtherJoints) {
  const RobotDescription robot = testing_support::delta_description("delta4");
  ParameterTable table;
  table.entries.push_back({"drive2.presliding", 2e-3, "rad"});
  table.entries.push_back({"telescope.presliding", 1e-4, "m"});
  Eigen::VectorXd expected(5);
  expected << 0, 2e-3, 0, 0, 1e-4;
  EXPECT_EQ(presliding_of(table, robot), expected);
  EXPECT_EQ(presliding_name(robot, 4), "telescope.presliding");
  // The rows are no columns of the regressor, and nobody is told that they are not used.
  table.entries.push_back({"drive2.coulomb", 1.0, "N*m"});
  EXPECT_TRUE(match_parameters(table, {"drive2.coulomb"}).warnings.empty());
  table.entries.push_back({"drive7.presliding", 2e-3, "rad"});
  EXPECT_THROW((void)presliding_of(table, robot), Error);
}

TEST(RippleRows, ReadBackAsTheyWere) {
  const RobotDescription robot = testing_support::delta_description("delta4");
  const std::vector<Ripple> ripples = {
      {0, 31.02, 0.02, -0.01, 0.1, 1e-3}, {0, 62.1, 0.004, 0.003, 0.2, 1e-3}, {3, 9, -1e-3, 2e-3, 0, 0}};
  ParameterTable table;
  table.entries.push_back({"drive1.coulomb", 1.0, "N*m"});
  for (const ParameterEntry& row : ripple_rows(ripples, robot)) table.entries.push_back(row);
  const testing_support::TemporaryFolder folder;
  write_parameters(folder.path("p.csv"), table);
  const ParameterTable read = read_parameters(folder.path("p.csv"), robot);
  const std::vector<Ripple> found = ripples_of(read, robot);
  ASSERT_EQ(found.size(), ripples.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(found[k].drive, ripples[k].drive);
    EXPECT_EQ(found[k].n, ripples[k].n);
    EXPECT_EQ(found[k].cosine, ripples[k].cosine);
    EXPECT_EQ(found[k].sine, ripples[k].sine);
  }
  // The rows are no columns of the regressor, and nobody is told that they are not used.
  EXPECT_TRUE(match_parameters(read, {"drive1.coulomb"}).warnings.empty());
}

// One unit everywhere: waves a turn, or a metre of a sliding drive. Files that count rad, as the law does, are read as
// they are.
TEST(RippleRows, CountWavesATurnOrAMetre) {
  const RobotDescription robot = testing_support::delta_description("delta4"),
                         linear = testing_support::delta_description("linear-delta3");
  EXPECT_EQ(ripple_rows({{0, 31, 0.1, 0.1, 0.5, 0}}, robot)[0].unit, "waves/turn");
  EXPECT_EQ(ripple_rows({{0, 31, 0.1, 0.1, 0.5, 0}}, robot)[0].value, 31);
  ParameterTable table;
  table.entries = ripple_rows({{0, 100 * 2 * std::numbers::pi, 0.1, 0.1, std::numbers::pi, 0}}, linear);
  EXPECT_EQ(table.entries[0].unit, "waves/m");
  EXPECT_NEAR(table.entries[0].value, 100, 1e-12);
  EXPECT_NEAR(table.entries[0].std, 0.5, 1e-12);
  EXPECT_NEAR(ripples_of(table, linear)[0].n, 100 * 2 * std::numbers::pi, 1e-9);
  table.entries[0].unit = "1/m";
  EXPECT_NEAR(ripples_of(table, linear)[0].n, 100, 1e-12);
}

TEST(RippleRows, AreRefusedInPartsAndForOtherDrives) {
  const RobotDescription robot = testing_support::delta_description("delta4");
  const std::vector<ParameterEntry> rows = ripple_rows({{1, 31, 0.02, 0.01, 0, 0}}, robot);
  for (std::size_t left_out = 1; left_out < 3; ++left_out) {
    ParameterTable table;
    for (std::size_t k = 0; k < 3; ++k) {
      if (k != left_out) table.entries.push_back(rows[k]);
    }
    EXPECT_THROW((void)ripples_of(table, robot), Error);
  }
  ParameterTable table;
  table.entries = rows;
  table.entries[0].value = 0;
  EXPECT_THROW((void)ripples_of(table, robot), Error);
  table.entries[0].value = 31;
  for (ParameterEntry& row : table.entries) row.name.replace(0, 6, "drive8");
  EXPECT_THROW((void)ripples_of(table, robot), Error);
}

TEST(PreslidingDampingOf, ReadsTheRowsAndRefusesOtherJoints) {
  const RobotDescription robot = testing_support::delta_description("delta4");
  ParameterTable table;
  table.entries.push_back({presliding_damping_name(robot, 1), 2e-3, "s"});
  table.entries.push_back({"telescope.presliding_damping", 1e-3, "s"});
  Eigen::VectorXd expected(5);
  expected << 0, 2e-3, 0, 0, 1e-3;
  EXPECT_EQ(presliding_damping_of(table, robot), expected);
  table.entries[0].value = -1e-3;
  EXPECT_THROW((void)presliding_damping_of(table, robot), Error);
  table.entries[0] = {"drive7.presliding_damping", 2e-3, "s"};
  EXPECT_THROW((void)presliding_damping_of(table, robot), Error);
}

}  // namespace
}  // namespace deltadyn
