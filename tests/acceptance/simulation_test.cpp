// The virtual robot and the studies of the paper's examples, with the installed tools, against the figures that were
// promised.

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sstream>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/io/trajectory_file.hpp"
#include "deltadyn/runtime/effect_catalogue.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "acceptance/tool_run.hpp"
#include "acceptance/virtual_robot.hpp"
#include "identification/synthetic_log.hpp"

namespace deltadyn::acceptance {
namespace {

TEST_F(VirtualRobot, SameInputAndSeedGiveTheSameFile) {
  plan("t.csv", 1.5, 0.4, 1);
  const Words noisy = {"--encoder-bits", "17", "--encoder-noise-rad", "1e-5", "--torque-noise-n-m", "0.1",
                       "--seed",         "4"};
  succeed(simulate("t.csv", "a.csv", noisy));
  succeed(simulate("t.csv", "b.csv", noisy));
  EXPECT_EQ(read_text(path("a.csv")), read_text(path("b.csv")));
  succeed(simulate("t.csv", "c.csv", {"--encoder-bits", "17", "--torque-noise-n-m", "0.1", "--seed", "5"}));
  EXPECT_NE(read_text(path("a.csv")), read_text(path("c.csv")));
}

TEST_F(VirtualRobot, InverseModeGivesTheModelItself) {
  plan("t.csv", 6, 0.3, 1);
  succeed(simulate("t.csv", "log.csv", {"--inverse"}));
  run({"delta-identify", path("robot.urdf"), path("log.csv"), "--prior", path("truth.csv"), "--no-filter", "-o",
       path("p.csv"), "--summary", path("identify.csv")});
  for (int j = 1; j <= 4; ++j) {
    figure(fmt::format("inverse_residual_drive{}", j),
           number(read_summary(path("identify.csv")), fmt::format("rms_residual_drive{}", j)), 1e-9);
  }
}

TEST_F(VirtualRobot, TheTorqueOfTheLogIsThatOfTheMotionAndEnergyIsKept) {
  plan("t.csv", 4, 0.4, 2);
  succeed(simulate("t.csv", "log.csv", {"--with-derivatives"}));
  const auto summary = read_summary(path("summary.csv"));
  figure("energy_imbalance_joule", std::abs(number(summary, "energy_imbalance")), 1e-7);
  succeed({"delta-validate", path("robot.urdf"), "--params", path("truth.csv"), path("log.csv"), "--no-filter", "-o",
           path("r.csv")});
  const CsvTable table = read_csv(path("r.csv"));
  int off = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    for (int j = 1; j <= 4; ++j) {
      if (std::abs(table.number(row, table.require(fmt::format("residual{}_Nm", j)))) > 1e-6) {
        ++off;
        break;
      }
    }
  }
  // Only samples at which a joint is stuck, where sign(rate) says nothing.
  figure("samples_off_the_model", off, 2 * number(summary, "reversals") + 1000 * number(summary, "stuck_time_s"));
}

TEST_F(VirtualRobot, AnIdentificationFindsTheTruthInItsIntervals) {
  plan("fast.csv", 10, 0.4, 3);
  plan("slow.csv", 10, 0.1, 4);
  const Words sensors = {"--encoder-bits",    "19",  "--torque-noise-n-m", "0.1,0.1,0.1,0.012",
                         "--control-rate-hz", "4000"};
  succeed(simulate("fast.csv", "log_fast.csv", sensors));
  succeed(simulate("slow.csv", "log_slow.csv", sensors + Words{"--seed", "2"}));
  // Priors 20 % off.
  ParameterTable prior = read_parameters(path("truth.csv"));
  for (ParameterEntry& entry : prior.entries) entry.value *= 0.8;
  write_parameters(path("prior.csv"), prior);
  const ToolResult identified = run({"delta-identify", path("robot.urdf"), path("log_fast.csv"), path("log_slow.csv"),
                                     "--prior", path("prior.csv"), "-o", path("p.csv")});
  ASSERT_TRUE(identified.code == 0 || identified.code == 5) << identified.err;
  const ParameterTable truth = read_parameters(path("truth.csv")), found = read_parameters(path("p.csv"));
  double worst = 0;
  for (const ParameterEntry& entry : found.entries) {
    if (entry.name.rfind("drive", 0) != 0 || entry.name.find('.') == std::string::npos) continue;
    const double error = std::abs(entry.value - truth.find(entry.name)->value);
    std::cout << fmt::format("  {}: {:.5g}, truth {:.5g}, std {:.2g}\n", entry.name, entry.value,
                             truth.find(entry.name)->value, entry.std);
    worst = std::max(worst, error / entry.std);
  }
  figure("friction_error_in_standard_deviations", worst, 4);
}

TEST_F(VirtualRobot, EffectsComeFromAFileAsFromTheCommandLine) {
  plan("t.csv", 1, 0.4, 1);
  (void)folder.write(
      "effects.csv",
      "effect,joint,parameter,value,unit,std\n"
      "stribeck,drive2,friction,2,N*m,0.1\nstribeck,drive2,rate,0.25,rad/s,\nstribeck,drive2,exponent,2,,\n");
  succeed(simulate("t.csv", "file.csv", {"--effects", path("effects.csv")}));
  succeed(simulate("t.csv", "flag.csv", {"--effect", "stribeck@drive2:friction=2,rate=0.25,exponent=2"}));
  succeed(simulate("t.csv", "none.csv"));
  EXPECT_EQ(read_text(path("file.csv")), read_text(path("flag.csv")));
  EXPECT_NE(read_text(path("file.csv")), read_text(path("none.csv")));
}

TEST_F(VirtualRobot, AnUnknownEffectIsRefusedWithTheKnownOnes) {
  plan("t.csv", 1, 0.4, 1);
  const ToolResult unknown = run(simulate("t.csv", "log.csv", {"--effect", "gremlin@drive1:size=3"}));
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.err.find("stribeck"), std::string::npos) << unknown.err;
  const ToolResult key = run(simulate("t.csv", "log.csv", {"--effect", "stribeck@drive1:size=3"}));
  EXPECT_EQ(key.code, 2);
  EXPECT_NE(key.err.find("friction, rate, exponent"), std::string::npos) << key.err;
  const ToolResult joint =
      run(simulate("t.csv", "log.csv", {"--effect", "stribeck@drive9:friction=1,rate=1,exponent=1"}));
  EXPECT_EQ(joint.code, 2) << "a flag is wrong, not a file";
  EXPECT_NE(joint.err.find("drive4"), std::string::npos) << joint.err;
  EXPECT_FALSE(fs::exists(path("log.csv")));
}

TEST_F(VirtualRobot, AResolutionForDrivesThatAreNotThereIsRefused) {
  plan("t.csv", 1, 0.4, 1);
  const ToolResult refused = run(simulate("t.csv", "log.csv", {"--encoder-step-m", "1e-6"}));
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("--encoder-bits"), std::string::npos) << refused.err;
  EXPECT_FALSE(fs::exists(path("log.csv")));
}

TEST_F(VirtualRobot, AMotionBeyondTheTorqueIsToldAsSuch) {
  plan("t.csv", 2, 0.4, 1);
  std::string robot = read_text(path("robot.urdf"));
  for (auto at = robot.find("effort=\""); at != std::string::npos; at = robot.find("effort=\"", at + 1)) {
    robot.replace(at, robot.find('"', at + 8) + 1 - at, "effort=\"3\"");
  }
  (void)folder.write("robot.urdf", robot);
  const ToolResult lost = run(simulate("t.csv", "log.csv"));
  EXPECT_EQ(lost.code, 4) << lost.out;
  EXPECT_NE(lost.err.find("met their torque limits"), std::string::npos) << lost.err;
  EXPECT_NE(lost.err.find("--drive-torque-n-m"), std::string::npos) << lost.err;
}

TEST_F(VirtualRobot, InverseModeRefusesASpringAndPlay) {
  plan("t.csv", 1, 0.4, 1);
  for (const char* effect :
       {"joint_elasticity@drive2:inertia_over_stiffness=1e-5", "backlash@drive2:share=0.6,gap=0.01"}) {
    const ToolResult refused = run(simulate("t.csv", "log.csv", {"--inverse", "--effect", effect}));
    EXPECT_EQ(refused.code, 2) << refused.out << refused.err;
    EXPECT_NE(refused.err.find("drive 2 has a spring or play"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("without --inverse"), std::string::npos) << refused.err;
    EXPECT_FALSE(fs::exists(path("log.csv")));
    succeed(simulate("t.csv", "closed.csv", {"--effect", effect}));
  }
}

// What the list says an effect takes is what the flag takes: every effect is built from its list entry and simulated.
TEST_F(VirtualRobot, EveryEffectOfTheListRuns) {
  plan("t.csv", 0.5, 0.4, 1);
  std::istringstream list(succeed({"delta-simulate", "--list-effects"}).out);
  std::string line, effect, keys;
  const auto usual = [&effect](const std::string& key) {
    if (key == "kind" || key == "recorded" || key == "encoder" || key == "log") return "1";
    if (key == "share") return "0.5";  // of the load, of a peak or of a torque constant
    if (key == "motor_share") return "0.4";
    if (key == "exponent") return effect.starts_with("shear") ? "0.5" : "2";
    return key == "inertia_over_stiffness" ? "1e-5" : "0.01";
  };
  std::size_t count = 0;
  const auto finish = [&] {
    if (effect.empty()) return;
    const ToolResult result = run(simulate("t.csv", "log.csv", {"--effect", effect + ":" + keys}));
    EXPECT_EQ(result.code, 0) << effect << ":" << keys << "\n" << result.err;
    // Nothing at all is refused, and the message names what the list names.
    const ToolResult empty = run(simulate("t.csv", "none.csv", {"--effect", effect}));
    EXPECT_EQ(empty.code, 2) << effect;
    EXPECT_NE(empty.err.find(keys.substr(0, keys.find('='))), std::string::npos) << empty.err;
    ++count;
  };
  while (std::getline(list, line)) {
    std::istringstream words(line);
    std::string first, second;
    words >> first >> second;
    const auto indent = line.find_first_not_of(' ');
    if (indent == 0 && line.find("  @") != std::string::npos) {  // name  @place
      finish();
      const auto at = line.find('@');
      const std::string place = line.substr(at, line.find_first_of(" ,", at) - at);
      effect = first + (place == "@driveK" ? "@drive1" : place);
      keys.clear();
    } else if (indent == 4) {  // key [unit] limits
      keys += (keys.empty() ? "" : ",") + first + "=" + usual(first);
    } else if (indent == 0) {
      finish();
      effect.clear();
    }
  }
  finish();
  EXPECT_EQ(count, effect_catalogue().size());
}

TEST_F(VirtualRobot, TakesOneEffectOfAKindAtAJoint) {
  plan("t.csv", 1, 0.4, 1);
  const std::string bend = "stribeck@drive2:friction=2,rate=0.25,exponent=2";
  const ToolResult twice = run(simulate("t.csv", "log.csv", {"--effect", bend, "--effect", bend}));
  EXPECT_EQ(twice.code, 2) << twice.out << twice.err;
  EXPECT_NE(twice.err.find("there is a second stribeck at drive2"), std::string::npos) << twice.err;
  EXPECT_FALSE(fs::exists(path("log.csv")));
}

TEST_F(VirtualRobot, AnUnstableLoopIsToldAndLeavesNoLog) {
  plan("t.csv", 1, 0.4, 1);
  const ToolResult wild = run(simulate("t.csv", "log.csv", {"--bandwidth-hz", "200"}));
  EXPECT_EQ(wild.code, 4) << wild.out << wild.err;
  EXPECT_NE(wild.err.find("bandwidth"), std::string::npos) << wild.err;
  EXPECT_FALSE(fs::exists(path("log.csv")));
}

/// A study by its installed script; `run` takes tools from bin/, so the script is named from there.
std::map<std::string, std::string> study(const testing_support::TemporaryFolder& folder, const std::string& script) {
  const std::string results = folder.path("results");
  const ToolResult result = run({"../libexec/deltadyn/" + script, results, "--short"}, {600});
  EXPECT_EQ(result.code, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("report: " + results + "/report.html"), std::string::npos);
  const ToolResult again = run({"../libexec/deltadyn/" + script, results, "--short"}, {600});
  EXPECT_EQ(again.code, 2) << "a second run must not overwrite the first";
  return read_summary(results + "/summary.csv");
}

TEST(Studies, SurrogateModelMeetsThePapersFigures) {
  const testing_support::TemporaryFolder folder;
  const auto summary = study(folder, "surrogate.sh");
  for (const std::string id : {"id1", "id2"}) {
    figure("friction_percent_" + id, number(summary, "friction_" + id), 0.2);
    figure("mass_diagonal_percent_" + id, number(summary, "m_diagonal_" + id), 0.1);
    figure("mass_off_diagonal_percent_" + id, number(summary, "m_off_diagonal_" + id), 0.2);
    figure("coriolis_percent_" + id, number(summary, "coriolis_torque_" + id), 0.1);
    figure("acceleration_percent_" + id, number(summary, "acceleration_torque_" + id), 0.1);
    figure("friction_percent_noise_" + id, number(summary, "friction_" + id + "_noise"), 2.2);
    figure("mass_diagonal_percent_noise_" + id, number(summary, "m_diagonal_" + id + "_noise"), 1);
    figure("mass_off_diagonal_percent_noise_" + id, number(summary, "m_off_diagonal_" + id + "_noise"), 2);
    figure("coriolis_percent_noise_" + id, number(summary, "coriolis_torque_" + id + "_noise"), 1);
    figure("acceleration_percent_noise_" + id, number(summary, "acceleration_torque_" + id + "_noise"), 1);
  }
  EXPECT_EQ(number(summary, "base_parameters"), 37);
  EXPECT_EQ(number(summary, "variables_with_rotor_inertia"), 36);
  for (const char* name : {"figure3_parameters", "figure4_mass_matrix", "figure5_coriolis", "figure6_acceleration"}) {
    EXPECT_TRUE(fs::exists(folder.path(std::string("results/") + name + ".png"))) << name;
    EXPECT_TRUE(fs::exists(folder.path(std::string("results/") + name + ".svg"))) << name;
  }
}

TEST(Studies, IndustrialRobotNeedsItsSpindleMendedByHand) {
  const testing_support::TemporaryFolder folder;
  const auto summary = study(folder, "industrial.sh");
  figure("rms_spindle_identified", number(summary, "rms_identified_drive4"), 0.25);
  figure("rms_spindle_by_hand", number(summary, "rms_by_hand_drive4"), 0.18);
  figure("rms_spindle_by_hand_over_identified",
         number(summary, "rms_by_hand_drive4") / number(summary, "rms_identified_drive4"), 0.9);
  // What the slow motion asks for goes the way of the paper's 5 and 0.75.
  EXPECT_GT(number(summary, "viscous_factor"), 2.5);
  EXPECT_LT(number(summary, "coulomb_factor"), 0.9);
}

}  // namespace
}  // namespace deltadyn::acceptance
