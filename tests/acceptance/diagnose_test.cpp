// delta-diagnose with the installed tools: simulated logs in which an effect is hidden, bad input, and the labelled and
// measured logs.

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/io/effect_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"

#include "acceptance/tool_run.hpp"
#include "acceptance/virtual_robot.hpp"

namespace deltadyn::acceptance {
namespace {

constexpr const char* kNullRuns = "40";  // enough for plain cases

/// Three motions of the delta4: fast, slow, hold-out.
class Diagnosing : public VirtualRobot {
 protected:
  void record(const std::string& name, double frequency_hz, std::uint64_t seed, const Words& effect,
              double duration_s = 10) const {
    plan("motion.csv", duration_s, frequency_hz, seed);
    succeed(simulate(
        "motion.csv", name,
        Words{"--encoder-bits", "19", "--torque-noise-n-m", "0.1,0.1,0.1,0.012", "--seed", std::to_string(seed)} +
            effect));
  }
  void record_all(const Words& effect) const {
    record("fast.csv", 0.2, 1, effect);
    record("slow.csv", 0.08, 2, effect);
    record("check.csv", 0.15, 3, effect);
  }
  [[nodiscard]] Words diagnose(const std::string& params, const Words& flags = {}) const {
    return Words{"delta-diagnose", path("robot.urdf"), "--params",  path(params),
                 path("fast.csv"), path("slow.csv"),   "--holdout", path("check.csv"),
                 "--null-runs",    kNullRuns,          "-o",        path("diagnosis.csv"),
                 "--summary",      path("summary.csv")} +
           flags;
  }
  [[nodiscard]] std::map<std::string, std::string> summary() const { return read_summary(path("summary.csv")); }
};

TEST_F(Diagnosing, NothingIsMissingWhereNothingIsHidden) {
  record_all({});
  const std::string off = "the parameters are off";
  EXPECT_EQ(succeed(diagnose("truth.csv")).out.find(off), std::string::npos);
  EXPECT_EQ(summary().at("verdict"), "nothing-missing");
  EXPECT_EQ(summary().at("effect"), "");

  ParameterTable table = read_parameters(path("truth.csv"));
  for (ParameterEntry& entry : table.entries) {
    if (entry.name == "drive2.coulomb") entry.value *= 2;
  }
  write_parameters(path("off.csv"), table);
  EXPECT_NE(succeed(diagnose("off.csv")).out.find(off + ": at drive 2"), std::string::npos);
  EXPECT_EQ(summary().at("verdict"), "nothing-missing");
}

TEST_F(Diagnosing, NamesWhatIsHiddenAndFindsNothingMoreInTheImprovedModel) {
  // The paper's drive 4: friction that bends over (VIII.C).
  record_all({"--effect", "shear_thinning@drive4:friction=0.4,rate=2.5,exponent=0"});
  succeed(diagnose("truth.csv", {"--effects-out", path("effects.csv"), "--params-out", path("improved.csv")}));
  const auto first = summary();
  EXPECT_EQ(first.at("verdict"), "named");
  EXPECT_EQ(first.at("effect"), "shear_thinning");
  EXPECT_EQ(first.at("class"), "velocity-shape");
  EXPECT_EQ(first.at("joint"), "drive4");
  EXPECT_GE(number(first, "gap_shrink"), 0.9);
  const auto effects = read_effects(path("effects.csv"), read_robot_file(path("robot.urdf")));
  ASSERT_EQ(effects.size(), 1U);
  EXPECT_EQ(effects[0].id, effect_id<effects::ShearThinning>);

  EXPECT_EQ(folder.read("improved.csv").substr(0, 23), "# effects: effects.csv\n");
  const ToolResult again = succeed(diagnose("improved.csv", {"--effects", path("effects.csv")}));
  EXPECT_EQ(summary().at("verdict"), "nothing-missing")
      << again.out << read_text(path("diagnosis.csv")).substr(0, 1500);
}

TEST_F(Diagnosing, GivesNoNameToBendingFrictionFromASlowLogAlone) {
  // The paper's drive 4 again, moved no faster than the bend.
  const Words bend = {"--effect", "shear_thinning@drive4:friction=0.4,rate=2.5,exponent=0"};
  record("slow.csv", 0.02, 2, bend);
  record("check.csv", 0.15, 3, bend);
  const ToolResult slow = succeed({"delta-diagnose", path("robot.urdf"), "--params", path("truth.csv"),
                                   path("slow.csv"), "--holdout", path("check.csv"), "--null-runs", kNullRuns, "-o",
                                   path("diagnosis.csv"), "--summary", path("summary.csv")});
  EXPECT_EQ(summary().at("verdict"), "not-testable") << slow.out;
  EXPECT_EQ(summary().at("effect"), "") << slow.out;
}

TEST_F(Diagnosing, TellsTheSizeOfAStribeckEffect) {
  record_all({"--effect", "stribeck@drive2:friction=2,rate=0.25,exponent=2"});
  succeed(diagnose("truth.csv"));
  EXPECT_EQ(summary().at("effect"), "stribeck");
  EXPECT_EQ(summary().at("joint"), "drive2");
  figure("stribeck_size_error", std::abs(number(summary(), "amplitude") / 2 - 1), 0.05);
}

TEST_F(Diagnosing, NamesFrictionThatDiffersByDirectionWithADeadZone) {
  record_all({"--effect",
              "direction_dependent_friction@drive2:coulomb_difference=1,viscous_difference=0.3,dead_zone=3,rate=0.15"});
  succeed(diagnose("truth.csv"));
  EXPECT_EQ(summary().at("effect"), "direction_dependent_friction");
  EXPECT_EQ(summary().at("joint"), "drive2");
  EXPECT_GE(number(summary(), "gap_shrink"), 0.9);
}

TEST_F(Diagnosing, NamesASpringOnAnArm) {
  record_all({"--effect", "arm_spring@drive1:stiffness=8,zero=-0.4"});
  succeed(diagnose("truth.csv"));
  EXPECT_EQ(summary().at("effect"), "arm_spring");
  EXPECT_EQ(summary().at("joint"), "drive1");
  figure("spring_size_error", std::abs(number(summary(), "amplitude") / 8 - 1), 0.05);
  EXPECT_GE(number(summary(), "gap_shrink"), 0.9);
}

TEST_F(Diagnosing, CounterweightsAreHeldByTheArmsParameters) {
  // The machine has them, the model that is diagnosed does not: a re-fit of the arms is all that is needed.
  const ParameterTable bare = read_parameters(path("truth.csv"));
  ParameterTable weighted = bare;
  for (ParameterEntry& entry : weighted.entries) {
    if (entry.name == "upper_arm.m") entry.value += 1.5;
    if (entry.name == "upper_arm.mcx") entry.value -= 1.5 * 0.12;
    if (entry.name == "upper_arm.Iyy" || entry.name == "upper_arm.Izz") entry.value += 1.5 * 0.12 * 0.12;
  }
  write_parameters(path("truth.csv"), weighted);
  record_all({});
  write_parameters(path("truth.csv"), bare);
  const ToolResult told = succeed(diagnose("truth.csv"));
  EXPECT_EQ(summary().at("verdict"), "nothing-missing") << told.out;
  EXPECT_NE(told.out.find("the parameters are off"), std::string::npos) << told.out;
}

TEST_F(Diagnosing, SaysWhenTheLogsAreTooShort) {
  record("fast.csv", 0.5, 1, {}, 1.5);
  succeed({"delta-diagnose", path("robot.urdf"), "--params", path("truth.csv"), path("fast.csv"), "-o",
           path("diagnosis.csv"), "--summary", path("summary.csv")});
  EXPECT_EQ(summary().at("verdict"), "not-testable");
  EXPECT_GT(number(summary(), "needed_length_s"), 1.5);
}

TEST_F(Diagnosing, RefusesInputThatWouldProveNothing) {
  record("fast.csv", 0.5, 1, {}, 2);
  (void)folder.write("slow.csv", read_text(path("fast.csv")));
  (void)folder.write("check.csv", read_text(path("fast.csv")));
  const ToolResult same = run(diagnose("truth.csv"));
  EXPECT_EQ(same.code, 2);
  EXPECT_NE(same.err.find("hold-out log is one of the training logs"), std::string::npos) << same.err;
  EXPECT_FALSE(fs::exists(path("diagnosis.csv")));

  const std::string whole = read_text(path("fast.csv"));
  (void)folder.write("check.csv", whole.substr(0, whole.find('\n', whole.size() / 2) + 1));
  const ToolResult excerpt = run(diagnose("truth.csv"));
  EXPECT_EQ(excerpt.code, 2);
  EXPECT_NE(excerpt.err.find("cut from it"), std::string::npos) << excerpt.err;

  (void)folder.write("old.csv", "# deltadyn effects 0\neffect,joint,parameter,value,unit,std\n");
  const ToolResult old = run(diagnose("truth.csv", {"--effects", path("old.csv")}));
  EXPECT_EQ(old.code, 3);
  EXPECT_NE(old.err.find("version 0"), std::string::npos) << old.err;

  (void)folder.write("robot.urdf", read_text(installed("robots/linear_delta3.urdf")));
  EXPECT_EQ(run({"delta-diagnose", path("robot.urdf"), "--params", path("truth.csv"), path("fast.csv"), "-o",
                 path("diagnosis.csv")})
                .code,
            3);
}

/// The data folder, or empty.
std::string shared_data(const std::string& file) {
  const char* folder = std::getenv("DELTADYN_SHARED_DATA");  // NOLINT(concurrency-mt-unsafe)
  if (folder == nullptr || !fs::exists(fs::path(folder) / file)) return {};
  return folder;
}

struct Labelled {
  const char* folder;
  const char* verdict;
  const char* effect;
  const char* joint;
};

class LabelledLog : public ::testing::TestWithParam<Labelled> {};

TEST_P(LabelledLog, IsDiagnosedRight) {
  const std::string data = shared_data("mujoco_delta4/labelled/lag/fast.csv");
  if (data.empty()) GTEST_SKIP() << "DELTADYN_SHARED_DATA names no folder with mujoco_delta4/labelled";
  const std::string logs = data + "/mujoco_delta4/labelled/" + GetParam().folder;
  const testing_support::TemporaryFolder folder;
  // As a user comes to it: with parameters that were fitted although the effect is in the logs. Fitted they are,
  // trusted or not.
  const std::string robot = installed("robots/mujoco_delta4.urdf");
  const ToolResult identified =
      run({"delta-identify", robot, logs + "/fast.csv", logs + "/slow.csv", "-o", folder.path("p.csv")});
  EXPECT_TRUE(identified.code == 0 || identified.code == 5) << identified.err;
  succeed({"delta-diagnose", robot, "--params", folder.path("p.csv"), logs + "/fast.csv", logs + "/slow.csv",
           "--holdout", logs + "/holdout.csv", "--null-runs", kNullRuns, "-o", folder.path("diagnosis.csv"),
           "--summary", folder.path("summary.csv")});
  const auto summary = read_summary(folder.path("summary.csv"));
  EXPECT_EQ(summary.at("verdict"), GetParam().verdict);
  EXPECT_EQ(summary.at("effect"), GetParam().effect);
  EXPECT_EQ(summary.at("joint"), GetParam().joint);
  if (*GetParam().effect != '\0') figure("gap_left", 1 - number(summary, "gap_shrink"), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Diagnosing, LabelledLog,
                         ::testing::Values(Labelled{"null_white", "nothing-missing", "", ""},
                                           Labelled{"stribeck_2", "named", "stribeck", "drive2"},
                                           Labelled{"hose", "named", "hose_force", "platform"},
                                           Labelled{"lag", "named", "current_lag", "robot"}),
                         [](const auto& tested) { return std::string(tested.param.folder); });

TEST(MeasuredAxis, HasViscousFrictionThatDiffersByDirectionAndNothingElse) {
  const std::string data = shared_data("emps/identification.csv");
  if (data.empty()) GTEST_SKIP() << "DELTADYN_SHARED_DATA names no folder with emps/identification.csv";
  const testing_support::TemporaryFolder folder;
  const std::string robot = installed("robots/emps.urdf");
  succeed({"delta-identify", robot, data + "/emps/identification.csv", "-o", folder.path("params.csv")});
  succeed({"delta-diagnose", robot, "--params", folder.path("params.csv"), data + "/emps/identification.csv",
           "--holdout", data + "/emps/verification.csv", "--null-runs", kNullRuns, "-o", folder.path("diagnosis.csv"),
           "--effects-out", folder.path("effects.csv"), "--params-out", folder.path("improved.csv"), "--summary",
           folder.path("summary.csv")});
  const auto summary = read_summary(folder.path("summary.csv"));
  EXPECT_EQ(summary.at("effect"), "asymmetric_viscous");
  EXPECT_EQ(number(summary, "effects"), 1);
  // Published (Janot, Gautier, Brunot 2019): 166.7061 and 240.4236 N s/m by direction.
  const double viscous = read_parameters(folder.path("improved.csv")).find("drive1.viscous")->value;
  const double by_direction = read_effects(folder.path("effects.csv"), read_robot_file(robot)).at(0).amplitude(0);
  figure("viscous_forward_percent", 100 * std::abs((viscous + by_direction) / 166.7061 - 1), 1.0);
  figure("viscous_backward_percent", 100 * std::abs((viscous - by_direction) / 240.4236 - 1), 1.0);
}

/// A machine with small dirt everywhere, and a Stribeck excess beside it.
class DirtyLogs : public ::testing::Test {
 protected:
  /// Identifies, diagnoses, and compares what is written with what delta-validate says to it.
  std::map<std::string, std::string> diagnosed(const std::string& folder_of_logs) {
    const std::string logs = shared_data("mujoco_dirty/README.md") + "/mujoco_dirty/" + folder_of_logs;
    succeed({"delta-model", "create", "delta4", "--base-radius", "0.16", "--platform-radius", "0.045", "--upper-arm",
             "0.30", "--strut", "0.72", "--strut-spacing", "0.09", "-o", path("robot.urdf")});
    (void)run({"delta-identify", path("robot.urdf"), logs + "/fast.csv", logs + "/slow.csv", "-o", path("p.csv")});
    const ToolResult told =
        succeed({"delta-diagnose", path("robot.urdf"), "--params", path("p.csv"), logs + "/fast.csv",
                 logs + "/slow.csv", "--holdout", logs + "/holdout.csv", "--null-runs", kNullRuns, "-o", path("d.csv"),
                 "--effects-out", path("e.csv"), "--params-out", path("improved.csv"), "--summary", path("s.csv")});
    EXPECT_NE(told.out.find("friction of drive 2 builds up"), std::string::npos) << told.out;
    // What made up for the dirt and the effect is no prior of the model that knows them.
    const auto prior = [this](const std::string& file) {
      return read_parameters(path(file)).find("upper_arm.m")->prior;
    };
    EXPECT_EQ(prior("improved.csv"), prior("p.csv"));
    succeed({"delta-validate", path("robot.urdf"), "--params", path("improved.csv"), "--effects", path("e.csv"),
             logs + "/holdout.csv", "--summary", path("v.csv")});
    return read_summary(path("s.csv"));
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_.path(name); }

  testing_support::TemporaryFolder folder_;
};

TEST_F(DirtyLogs, MissNothingWhereNothingIsHidden) {
  if (shared_data("mujoco_dirty/README.md").empty())
    GTEST_SKIP() << "DELTADYN_SHARED_DATA names no folder with mujoco_dirty";
  const auto summary = diagnosed("nothing_hidden");
  EXPECT_EQ(summary.at("verdict"), "nothing-missing");
  EXPECT_EQ(summary.at("effect"), "");
}

TEST_F(DirtyLogs, NameTheStribeckEffectAndKeepTheDirt) {
  if (shared_data("mujoco_dirty/README.md").empty())
    GTEST_SKIP() << "DELTADYN_SHARED_DATA names no folder with mujoco_dirty";
  const auto summary = diagnosed("stribeck_1");
  EXPECT_EQ(summary.at("verdict"), "named");
  EXPECT_EQ(summary.at("effect"), "stribeck");
  EXPECT_EQ(summary.at("joint"), "drive1");
  figure("stribeck_size_percent", 100 * std::abs(number(summary, "amplitude") / 0.8 - 1), 5);
  EXPECT_NE(read_parameters(path("improved.csv")).find("drive2.presliding"), nullptr);
  // What is proved is what is written.
  const auto validated = read_summary(path("v.csv"));
  for (int drive = 1; drive <= 4; ++drive) {
    const double rms = number(validated, fmt::format("rms_residual_drive{}", drive));
    EXPECT_NEAR(number(summary, fmt::format("holdout_rms_written_drive{}", drive)), rms, 1e-4 * rms) << drive;
  }
  EXPECT_LT(number(summary, "holdout_rms_written_drive1"), 0.3 * number(summary, "holdout_rms_given_drive1"));
}

struct MeasuredSet {
  const char* name;
  Words robot;  ///< flags of delta-model create axis
  Words train;
  const char* holdout;
  Words right;  ///< effects, first or in the set, or verdicts
};

class DiagnosedDrive : public ::testing::TestWithParam<MeasuredSet> {};

TEST_P(DiagnosedDrive, IsNamedRightOrUndecided) {
  const std::string data = shared_data("measured/README.md") + "/measured/";
  if (shared_data("measured/README.md").empty()) GTEST_SKIP() << "DELTADYN_SHARED_DATA names no folder with measured";
  const testing_support::TemporaryFolder folder;
  const std::string robot = folder.path("robot.urdf");
  succeed(Words{"delta-model", "create", "axis", "-o", robot} + GetParam().robot);
  Words logs;
  for (const std::string& log : GetParam().train) logs.push_back(data + log);
  const std::string held = data + GetParam().holdout;
  succeed(Words{"delta-identify", robot, "-o", folder.path("p.csv")} + logs);
  succeed(Words{"delta-diagnose", robot, "--params", folder.path("p.csv"), "--holdout", held, "--null-runs", kNullRuns,
                "-o", folder.path("d.csv"), "--effects-out", folder.path("e.csv"), "--params-out",
                folder.path("improved.csv"), "--summary", folder.path("s.csv")} +
          logs);
  const auto summary = read_summary(folder.path("s.csv"));
  const std::string found = summary.at("effect").empty() ? summary.at("verdict") : summary.at("effect");
  bool right = false;
  for (const std::string& one : GetParam().right) {
    right |= found == one ||
             (summary.count("confusable_with") > 0 && summary.at("confusable_with").find(one) != std::string::npos);
  }
  EXPECT_TRUE(right) << found;
  // What is written is never worse than what was given.
  succeed({"delta-validate", robot, "--params", folder.path("p.csv"), held, "--summary", folder.path("given.csv")});
  succeed({"delta-validate", robot, "--params", folder.path("improved.csv"), "--effects", folder.path("e.csv"), held,
           "--summary", folder.path("written.csv")});
  EXPECT_LE(number(read_summary(folder.path("written.csv")), "rms_residual_drive1"),
            number(read_summary(folder.path("given.csv")), "rms_residual_drive1"));
}

INSTANTIATE_TEST_SUITE_P(Diagnosing, DiagnosedDrive,
                         ::testing::Values(MeasuredSet{"screw1",
                                                       {"--arm", "0.01", "--gravity-direction", "0,1,0"},
                                                       {"screw1/stairs_train.csv"},
                                                       "screw1/stairs_holdout.csv",
                                                       {"stribeck"}},
                                           MeasuredSet{"ur10e_joint3",
                                                       {"--arm", "0.6"},
                                                       {"ur10e/joint3_train.csv"},
                                                       "ur10e/joint3_holdout.csv",
                                                       {"load_dependent_friction"}},
                                           MeasuredSet{"ur10e_joint5",
                                                       {"--arm", "0.15", "--gravity-direction", "0,1,0"},
                                                       {"ur10e/joint5_train.csv"},
                                                       "ur10e/joint5_holdout.csv",
                                                       {"nothing-missing", "presliding", "shear_thinning"}},
                                           MeasuredSet{"dfki",
                                                       {"--arm", "0.5"},
                                                       {"dfki/ddp.csv", "dfki/dircol.csv"},
                                                       "dfki/pd_ident.csv",
                                                       {"time_skew", "current_lag", "not-testable"}},
                                           MeasuredSet{"dfki_other_rate",
                                                       {"--arm", "0.5"},
                                                       {"dfki/ddp.csv"},
                                                       "dfki/dircol.csv",
                                                       {"time_skew", "current_lag", "not-testable"}}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace deltadyn::acceptance
