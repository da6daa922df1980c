#include "deltadyn/io/parameter_file.hpp"

#include <cmath>
#include <filesystem>
#include <gmock/gmock.h>
#include <random>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

#include "io/temporary_folder.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using ::deltadyn::testing_support::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ParameterFile, ReadsBackExactly) {
  const TemporaryFolder folder;
  std::mt19937_64 random(7);
  UniformDistribution exponent(-12, 3);
  ParameterTable table;
  for (int i = 0; i < 200; ++i) {
    table.entries.push_back({"p" + std::to_string(i), std::pow(10.0, exponent(random)), "kg*m^2"});
    if (i % 3 == 0) table.entries.back().std = std::pow(10.0, exponent(random));
    if (i % 5 == 0) table.entries.back().data_share = 1.0 / 3.0;
  }
  write_parameters(folder.path("p.csv"), table);
  EXPECT_EQ(folder.read("p.csv").substr(0, 31), "name,value,unit,std,data_share\n");
  const ParameterTable back = read_parameters(folder.path("p.csv"));
  ASSERT_EQ(back.entries.size(), table.entries.size());
  for (std::size_t i = 0; i < table.entries.size(); ++i) {
    EXPECT_EQ(back.entries[i].name, table.entries[i].name);
    EXPECT_EQ(back.entries[i].value, table.entries[i].value);
    EXPECT_EQ(back.entries[i].unit, table.entries[i].unit);
    EXPECT_EQ(std::isnan(back.entries[i].std), std::isnan(table.entries[i].std));
    if (!std::isnan(table.entries[i].std)) {
      EXPECT_EQ(back.entries[i].std, table.entries[i].std);
    }
    if (i % 5 == 0) {
      EXPECT_EQ(back.entries[i].data_share, 1.0 / 3.0);
    }
    EXPECT_TRUE(std::isnan(back.entries[i].prior));
  }
}

TEST(ParameterFile, NamesTheEffectsThatItBelongsTo) {
  const TemporaryFolder folder;
  namespace fs = std::filesystem;
  for (const char* name : {"here", "moved"}) fs::create_directory(folder.path(name));
  ParameterTable table;
  table.remark = "a remark";
  table.entries.push_back({"upper_arm.m", 1, "kg"});
  EXPECT_EQ(missing_effects(table, ""), "");
  table.effects = folder.path("effects.csv");
  write_parameters(folder.path("here/p.csv"), table);
  EXPECT_THAT(folder.read("here/p.csv"), HasSubstr("# effects: ../effects.csv\nname,value,unit\n"));
  const ParameterTable back = read_parameters(folder.path("here/p.csv"));
  EXPECT_EQ(back.effects, folder.path("here/../effects.csv"));
  EXPECT_THAT(missing_effects(back, ""), HasSubstr("effects.csv, which is not there: give --effects"));
  (void)folder.write("effects.csv", "effect,joint,parameter,value,unit\n");
  EXPECT_THAT(missing_effects(back, ""), ::testing::EndsWith("give --effects " + folder.path("here/../effects.csv")));
  EXPECT_EQ(missing_effects(back, "any.csv"), "");
  fs::rename(folder.path("here/p.csv"), folder.path("p.csv"));
  EXPECT_THAT(missing_effects(read_parameters(folder.path("p.csv")), ""), HasSubstr("which is not there"));
  // Written elsewhere, it still names the same file.
  write_parameters(folder.path("moved/p.csv"), back);
  EXPECT_TRUE(fs::equivalent(read_parameters(folder.path("moved/p.csv")).effects, folder.path("effects.csv")));

  table.effects = kEffectsNotWritten;
  write_parameters(folder.path("q.csv"), table);
  EXPECT_THAT(missing_effects(read_parameters(folder.path("q.csv")), ""),
              HasSubstr("delta-diagnose again with --effects-out"));
}

TEST(ParameterFile, MatchesSharedNamesAndTellsTheRest) {
  const TemporaryFolder folder;
  const ParameterTable table =
      read_parameters(folder.write("p.csv",
                                   "unit,value,name\nkg,1.5,upper_arm.m\nkg,2.5,upper_arm2.m\nkg m2,0.1,strut.Ixx\nN m "
                                   "s,3,drive1.viscous\nkg,9,gripper.m\n"));
  const ParameterMatch match =
      match_parameters(table, {"upper_arm1.m", "upper_arm2.m", "strut3.Ixx", "drive1.viscous", "drive1.coulomb"},
                       {"kg", "kg", "kg*m^2", "N*m*s/rad", "N*m"});
  EXPECT_EQ(match.value, (Eigen::VectorXd(5) << 1.5, 2.5, 0.1, 3, 0).finished());
  EXPECT_THAT(match.missing, ElementsAre("drive1.coulomb"));
  EXPECT_THAT(match.warnings, ElementsAre(::testing::AllOf(HasSubstr("line 6"), HasSubstr("gripper.m")),
                                          HasSubstr("counted as 0 (1): drive1.coulomb")));
  EXPECT_EQ(values(table, {"strut.Ixx"})(0), 0.1);
}

TEST(ParameterFile, ThePriorOfEachValueIsThatOfTheFile) {
  const TemporaryFolder folder;
  const ParameterTable table = read_parameters(
      folder.write("p.csv", "name,value,unit,prior\nupper_arm.m,1.5,kg,1.2\nstrut.m,0.1,kg,\ntool.m,0.4,kg,0.3\n"));
  EXPECT_EQ(match_parameters(table, {"upper_arm.m", "strut.m"}).prior, Eigen::Vector2d(1.2, 0.1));
  EXPECT_EQ(match_parameters(table, {"upper_arm1.m", "tool.m"}).prior, Eigen::Vector2d(1.2, 0.3)) << "shared name";
}

TEST(ParameterFile, RefusesLimbValuesWhereTheSharedOneIsWanted) {
  const TemporaryFolder folder;
  const ParameterTable table =
      read_parameters(folder.write("p.csv", "name,value,unit\nupper_arm1.m,1,kg\nstrut.m,1,kg\n"));
  try {
    (void)values(table, {"upper_arm.m", "strut.m"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("line 2"));
    EXPECT_THAT(error.mend(), HasSubstr("--individual-limbs"));
  }
  EXPECT_THROW((void)values(table, {"platform.m"}), Error);
}

TEST(ParameterFile, RefusesTheFileOfAnotherRobot) {
  const TemporaryFolder folder;
  const std::vector<std::string> names = {"strut.m", "crossbar.m", "crossbar.Izz"};
  const auto table = [&](const std::string& rows) {
    return read_parameters(folder.write("p.csv", "name,value,unit\nstrut.m,1,kg\n" + rows));
  };
  EXPECT_NO_THROW((void)values(table("crossbar.m,0.7,kg\nplatform.m,1,kg\n"), names));  // the moment is 0
  EXPECT_NO_THROW((void)values(table(""), names));  // base parameters may leave out a body
  try {
    (void)values(table("platform.m,1,kg\n"), names);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.problem(), HasSubstr("no value of crossbar"));
    EXPECT_THAT(error.where(), HasSubstr("line 3"));
    EXPECT_EQ(error.code(), ExitCode::bad_input);
  }
}

TEST(ParameterFile, RefusesTheUnitOfAnotherRobot) {
  const TemporaryFolder folder;
  const ParameterTable table = read_parameters(folder.write("p.csv", "name,value,unit\ndrive1.viscous,1,N*s/m\n"));
  EXPECT_NO_THROW((void)values(table, {"drive1.viscous"}, {"N*s/m"}));
  EXPECT_THROW((void)values(table, {"drive1.viscous"}, {"N*m*s/rad"}), Error);
}

struct BadParameters {
  const char* name;
  const char* text;
  std::vector<const char*> message;
};

class BadParametersTest : public ::testing::TestWithParam<BadParameters> {};

TEST_P(BadParametersTest, IsRefusedWithItsPlace) {
  const TemporaryFolder folder;
  try {
    (void)read_parameters(folder.write("p.csv", GetParam().text));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    for (const char* part : GetParam().message) EXPECT_THAT(error.what(), HasSubstr(part));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadParametersTest,
    ::testing::Values(
        BadParameters{
            "Twice", "name,value,unit\nstrut.m,1,kg\nstrut.m,2,kg\n", {"p.csv, line 3", "already given in line 2"}},
        BadParameters{"WrongUnit", "name,value,unit\nstrut.m,100,g\n", {"p.csv, line 2, column unit", "'g'", "kg"}},
        BadParameters{"NoUnitColumn", "name,value\nstrut.m,1\n", {"column unit is missing"}},
        BadParameters{"Text", "name,value,unit\nstrut.m,heavy,kg\n", {"line 2, column value", "'heavy'"}},
        BadParameters{"NoName", "name,value,unit\n,1,kg\n", {"line 2, column name"}},
        BadParameters{"NegativeStd", "name,value,unit,std\nstrut.m,1,kg,-1\n", {"line 2, column std", "negative"}},
        BadParameters{"Share", "name,value,unit,data_share\nstrut.m,1,kg,1.5\n", {"line 2, column data_share"}},
        BadParameters{"NoRows", "name,value,unit\n", {"no data rows"}}),
    [](const auto& information) { return std::string(information.param.name); });

TEST(ParameterFile, WritesNothingWhenAValueIsNotFinite) {
  const TemporaryFolder folder;
  ParameterTable table;
  table.entries.push_back({"strut.m", std::nan(""), "kg"});
  EXPECT_THROW(write_parameters(folder.path("p.csv"), table), Error);
  EXPECT_EQ(folder.files(), 0);
}

// What is read by name must land in the columns that were written.
TEST(ParameterOptionsOf, FindsTheColumnsThatAFileWasWrittenFor) {
  const RobotDescription robot = testing_support::delta_description("delta4");
  for (const bool individual : {false, true}) {
    for (const bool tool : {false, true}) {
      const ParameterOptions written{individual, tool, tool ? std::vector<int>{1, 4} : std::vector<int>{}, individual};
      const auto columns_of = [&](const ParameterOptions& options) {
        return make_robot(robot, options)->parameter_names();
      };
      ParameterTable table;
      for (const std::string& name : columns_of(written)) table.entries.push_back({name, 1.0, ""});
      EXPECT_EQ(columns_of(parameter_options_of(table, robot)), columns_of(written));
    }
  }
}

}  // namespace
}  // namespace deltadyn
