#include "deltadyn/io/import_log.hpp"

#include <algorithm>
#include <gmock/gmock.h>
#include <random>

#include "deltadyn/io/log_file.hpp"
#include "deltadyn/runtime/error.hpp"

#include "io/recorded_motion.hpp"
#include "io/temporary_folder.hpp"

namespace deltadyn {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using namespace testing_support;

std::string with_comma(std::string text) {
  std::replace(text.begin(), text.end(), '.', ',');
  return text;
}

std::string words_of_error(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// A form in which the motion of one drive is recorded, what has to be said besides, and how exact its digits are.
struct Form {
  const char* name;
  std::string text;
  MapDefaults defaults;
  double position_error = 1e-7, torque_error = 1e-5;
};

MapDefaults defaults(const std::function<void(MapDefaults&)>& change) {
  MapDefaults result;
  change(result);
  return result;
}

std::vector<Form> forms() {
  const MapDefaults none;
  const auto si = [](char mark) {
    return
        [mark](int, double t) { return fmt::format("{1:.3f}{0}{2:.9f}{0}{3:.7f}\n", mark, t, position(t), torque(t)); };
  };
  std::vector<Form> all;
  all.push_back({"Brackets", recorded("Time [s],q1 [rad],tau1 [Nm]\n", si(',')), none});
  all.push_back({"Parentheses", recorded("t (s),q1 (rad),tau1 (Nm)\n", si(',')), none});
  all.push_back({"Tabs", recorded("Time [s]\tPosition [rad]\tTorque [Nm]\n", si('\t')), none});
  all.push_back({"Blanks", recorded("# t [s]  q1 [rad]  tau1 [Nm]\n", si(' ')), none});
  all.push_back({"BomAndQuotes", recorded("\xEF\xBB\xBF\"t_s\",\"q1_rad\",\"tau1_Nm\"\r\n", si(',')), none});
  all.push_back({"DecimalComma",
                 recorded("t_s;q1_rad;tau1_Nm\r\n", [&](int k, double t) { return with_comma(si(';')(k, t)); }), none});
  all.push_back({"QuotedDecimalComma",
                 recorded("\"t (s)\",\"q1 (rad)\",\"tau1 (Nm)\"\n",
                          [](int, double t) {
                            return with_comma(fmt::format("\"{:.3f}\"", t)) + "," +
                                   with_comma(fmt::format("\"{:.9f}\"", position(t))) + "," +
                                   with_comma(fmt::format("\"{:.7f}\"\n", torque(t)));
                          }),
                 none});
  all.push_back({"PreambleAndUnitRow",
                 recorded("Recorder 7;\nRate;1000;Hz\n\nZeit;Istposition;Drehmoment\n[ms];[\xC2\xB0];[mNm]\n",
                          [](int k, double t) {
                            return fmt::format("{};{:.8f};{:.5f}\n", k, kDegrees * position(t), 1e3 * torque(t));
                          }),
                 none});
  all.push_back({"FooterAndTrailingSeparator",
                 recorded("t_us;pos_deg;trq_Nm;\n",
                          [](int k, double t) {
                            return fmt::format("{};{:.8f};{:.7f};\n", 1000 * k, kDegrees * position(t), torque(t));
                          }) +
                     "EOF\n",
                 none});
  all.push_back({"FileTimeAndPermille",
                 recorded("Time,q1_deg,trq1_permille\n",
                          [](int k, double t) {
                            return fmt::format("{},{:.8f},{:.4f}\n", 132959733843760000LL + 10000LL * k,
                                               kDegrees * position(t), 1e3 * torque(t) / 2.5);
                          }),
                 defaults([](MapDefaults& d) { d.rated_torque = {2.5}; })});
  all.push_back({"EpochOfRos",
                 recorded("%time,field.header.stamp,field.name0,field.position0,field.effort0\n",
                          [](int k, double t) {
                            return fmt::format("{},{},joint,{:.9f},{:.7f}\n",
                                               1650000000000300000LL + 1000000LL * k + 7919 * k % 90000,
                                               1650000000000000000LL + 1000000LL * k, position(t), torque(t));
                          }),
                 none});
  all.push_back({"UrRtde",
                 recorded("timestamp actual_q_0 target_q_0 actual_current_0 actual_TCP_pose_0\n",
                          [](int, double t) {
                            return fmt::format("{:.3f} {:.9f} 0 {:.7f} 0.3\n", 7123.5 + t, position(t), torque(t) / 8);
                          }),
                 defaults([](MapDefaults& d) { d.torque_constant = {8}; })});
  all.push_back({"DatesOverMidnight",
                 recorded("Timestamp;q1 [deg];tau1 [Nm]\n",
                          [](int k, double t) {
                            const int ms = 59700 + k;
                            const std::string stamp =
                                ms < 60000 ? fmt::format("31.12.2025 23:59:{:02d},{:03d}", ms / 1000, ms % 1000)
                                           : fmt::format("01.01.2026 00:00:{:02d},{:03d}", ms / 1000 - 60, ms % 1000);
                            return fmt::format("{};{:.8f};{:.7f}\n", stamp, kDegrees * position(t), torque(t));
                          }),
                 none});
  all.push_back(
      {"NoTimeColumn",
       recorded("ActPos,ActTorque\n",
                [](int, double t) { return fmt::format("{:.8f},{:.7f}\n", kDegrees * position(t), torque(t)); }),
       defaults([](MapDefaults& d) {
         d.rate_hz = 1000;
         d.position_unit = "deg";
         d.torque_unit = "Nm";
       })});
  all.push_back({"Halscope",
                 recorded("# Sampling period is 1000000 ns\njoint.0.pos-fb;lcec.0.torque\n# Position: "
                          "0.000000;0.000000\n# Scale: 0;0\n",
                          [](int, double t) {
                            return fmt::format("{:.8f};{:.4f}\n", kDegrees * position(t), 1e3 * torque(t) / 2.5);
                          }),
                 defaults([](MapDefaults& d) {
                   d.position_unit = "deg";
                   d.torque_unit = "permille";
                   d.rated_torque = {2.5};
                 })});
  all.push_back({"CountsOfAMotorThatWrap",
                 recorded("Time [s],Position [cnt],Active Current [A]\n",
                          [](int, double t) {
                            const auto counts = std::lround(position(t) * 20.0 / (2.0 * std::numbers::pi) * 65536.0);
                            return fmt::format("{:.3f},{},{:.7f}\n", t, ((counts % 65536) + 65536) % 65536,
                                               torque(t) / 20.0 / 0.3);
                          }),
                 defaults([](MapDefaults& d) {
                   d.counts_per_turn = {65536};
                   d.gear_ratio = {20};
                   d.torque_constant = {0.3};
                 }),
                 3e-6});
  return all;
}

class ImportFormTest : public ::testing::TestWithParam<Form> {};

TEST_P(ImportFormTest, GivesTheMotion) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  ImportOptions options;
  options.defaults = GetParam().defaults;
  const Log log = LogImport({folder.write("log.txt", GetParam().text)}, robot, options).log().log;
  ASSERT_EQ(log.samples(), kMotionRows);
  EXPECT_EQ(log.t_s(0), 0.0);
  for (int k = 0; k < kMotionRows; ++k) {
    ASSERT_NEAR(log.t_s(k), 0.001 * k, 1e-9) << k;
    ASSERT_NEAR(log.q(k, 0), position(0.001 * k), GetParam().position_error) << k;
    ASSERT_NEAR(log.tau(k, 0), torque(0.001 * k), GetParam().torque_error) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Table, ImportFormTest, ::testing::ValuesIn(forms()),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(LogImport, UnicodeTextOfExcel) {
  const TemporaryFolder folder;
  const std::string text = recorded("Time [s]\tq1 [rad]\ttau1 [Nm]\r\n", [](int, double t) {
    return fmt::format("{:.3f}\t{:.9f}\t{:.7f}\r\n", t, position(t), torque(t));
  });
  std::string wide = "\xFF\xFE";
  for (const char c : text) wide += {c, '\0'};
  const RobotDescription robot = one_drive();
  const Log log = LogImport({folder.write("log.txt", wide)}, robot, {}).log().log;
  ASSERT_EQ(log.samples(), kMotionRows);
  EXPECT_NEAR(log.q(300, 0), position(0.3), 1e-8);
}

// A torque at a quarter of the rate, empty in between, has no phase error; a faster one is not folded.
TEST(LogImport, BringsUnequalRatesToOneGridWithoutPhaseError) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  const std::string slow = recorded("t_s,q1_rad,tau1_Nm\n", [](int k, double t) {
    return k % 4 == 0 ? fmt::format("{:.3f},{:.9f},{:.9f}\n", t, position(t), torque(t))
                      : fmt::format("{:.3f},{:.9f},\n", t, position(t));
  });
  const ImportedLog one = LogImport({folder.write("slow.csv", slow)}, robot, {}).log();
  EXPECT_NEAR(one.taken.back().step_s, 0.004, 1e-12);
  EXPECT_THAT(one.taken.back().how, HasSubstr("cubic"));
  ASSERT_EQ(one.log.samples(), 597);  // to the last torque
  for (int k = 0; k < 597; ++k) ASSERT_NEAR(one.log.tau(k, 0), torque(0.001 * k), 5e-6) << k;

  // Four times as fast, with a ripple of 1.6 kHz that would fold to 0.4 kHz.
  const std::string positions =
      recorded("t_s,q1_rad\n", [](int, double t) { return fmt::format("{:.3f},{:.9f}\n", t, position(t)); });
  std::string torques = "t_s,tau1_Nm\n";
  for (int k = 0; k < 4 * kMotionRows; ++k) {
    const double t = 0.00025 * k;
    torques += fmt::format("{:.5f},{:.9f}\n", t, torque(t) + std::sin(2.0 * std::numbers::pi * 1600.0 * t));
  }
  const ImportedLog two =
      LogImport({folder.write("q.csv", positions), folder.write("tau.csv", torques)}, robot, {}).log();
  EXPECT_THAT(two.taken.back().how, HasSubstr("low pass"));
  ASSERT_EQ(two.log.samples(), kMotionRows);
  for (int k = 20; k < kMotionRows - 20; ++k) ASSERT_NEAR(two.log.tau(k, 0), torque(0.001 * k), 2e-3) << k;
}

// Groups with time columns of their own, as spreadsheets and scopes export them: the slow one ends early, below it
// fields are empty.
TEST(LogImport, ColumnsBelongToTheTimeColumnToTheirLeft) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  for (const int slower : {1, 4}) {
    const std::string text = recorded("Time [ms];q1 [rad];Time [ms];tau1 [Nm]\n", [&](int k, double t) {
      const double late = 1e-3 * slower * k + 0.0004;  // the second recorder started 0.4 ms later
      std::string line = fmt::format("{};{:.9f}", k, position(t));
      line += late < 1e-3 * kMotionRows ? fmt::format(";{:.4f};{:.9f}\n", 1e3 * late, torque(late)) : ";;\n";
      return line;
    });
    const ImportedLog result = LogImport({folder.write("log.csv", text)}, robot, {}).log();
    ASSERT_GT(result.log.samples(), kMotionRows - 6) << slower;
    for (Eigen::Index k = 0; k < result.log.samples(); ++k) {
      // The first row is left out, as the torque begins after it.
      const double t = 0.001 * static_cast<double>(k + 1);
      ASSERT_NEAR(result.log.q(k, 0), position(t), 1e-8) << slower;
      ASSERT_NEAR(result.log.tau(k, 0), torque(t), 1e-5) << slower;
    }
  }
}

// A slow channel in TwinCAT's fast group, filled up with its last value: only the rows where it was sampled are its
// data.
TEST(LogImport, FilledUpRepeatsAreNoData) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  const std::string head =
      "Name\tP\nFile\tx\nStarttime of export\t132959733843760000\nEndtime of export\t132959733853750000\n\n\n"
      "Name\tActPos\tActTorque\nData-Type\tREAL64\tREAL64\nSampleTime[ms]\t1\t4\nUnit\trad\tNm\n\n";
  const std::string text = recorded(head, [](int k, double t) {
    const double sampled = 0.001 * (k < 2 ? 0 : (k - 2) / 4 * 4 + 2);  // new values in the rows 2, 6, 10, ...
    return fmt::format("{}\t{:.9f}\t{:.9f}\n", k, position(t), torque(sampled));
  });
  const ImportedLog result = LogImport({folder.write("scope.csv", text)}, robot, {}).log();
  EXPECT_NEAR(result.taken.back().step_s, 0.004, 1e-9);
  ASSERT_GT(result.log.samples(), kMotionRows - 8);
  for (Eigen::Index k = 0; k < result.log.samples(); ++k) {
    const double t = 0.001 * static_cast<double>(k + 2);
    ASSERT_NEAR(result.log.q(k, 0), position(t), 1e-8);
    ASSERT_NEAR(result.log.tau(k, 0), torque(t), 1e-5);
  }
}

TEST(LogImport, MapGivesSourceUnitSignScaleOffsetAndDelay) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  const std::string text = recorded("a,b,c\n", [](int k, double t) {
    return fmt::format("{},{:.9f},{:.9f}\n", k, -kDegrees * position(t) + 30.0, torque(t - 0.003) / 2.0);  // 3 ms late
  });
  const std::string map = folder.write(
      "map.toml",
      "[time]\nsource = \"a\"\nunit = \"ms\"\n[[channel]]\ndrive = 1\nquantity = \"position\"\nsource = \"b\"\nunit = "
      "\"deg\"\nsign = -1\noffset = -30\n[[channel]]\ndrive = 1\nquantity = \"torque\"\nsource = 3\nunit = "
      "\"Nm\"\nscale = "
      "2\ndelay_s = 0.003\n");
  ImportOptions options;
  options.map_file = map;
  const Log log = LogImport({folder.write("log.csv", text)}, robot, options).log().log;
  ASSERT_EQ(log.samples(), kMotionRows - 3);
  for (Eigen::Index k = 0; k < log.samples(); ++k) {
    ASSERT_NEAR(log.q(k, 0), position(0.001 * static_cast<double>(k)), 1e-8);
    ASSERT_NEAR(log.tau(k, 0), torque(0.001 * static_cast<double>(k)), 1e-7);
  }
  // The other tools read the same file with the same map.
  LogReadOptions reading;
  reading.map = map;
  const Log same = read_log(folder.path("log.csv"), robot, reading);
  EXPECT_NEAR((same.q - log.q).cwiseAbs().maxCoeff(), 0.0, 1e-12);
  ASSERT_FALSE(same.notes.empty());
  EXPECT_THAT(same.notes[0],
              HasSubstr("read as text separated by ','; time from 'a' [ms]\n  q1_rad from 'b' [deg]\n  tau1_Nm from"));
}

TEST(LogImport, TellsDrivesApartByTheNumberThatDiffersCountedFromZeroOrOne) {
  const TemporaryFolder folder;
  const RobotDescription robot = drives(3);
  for (const int first : {0, 1}) {
    // In a mixed order, with the machine's own number in every name.
    std::string head = "Time [s]";
    for (const int drive : {2, 0, 1})
      head += fmt::format(",Robot4.Axis{0}.ActPos [rad],Robot4.Axis{0}.SetPos [rad],Robot4.Axis{0}.ActTorque [Nm]",
                          drive + first);
    const std::string text = recorded(head + "\n", [](int, double t) {
      std::string line = fmt::format("{:.3f}", t);
      for (const int drive : {2, 0, 1})
        line += fmt::format(",{:.6f},9,{:.6f}", position(t) + drive, torque(t) + 10 * drive);
      return line + "\n";
    });
    const Log log = LogImport({folder.write("log.csv", text)}, robot, {}).log().log;
    for (int drive = 0; drive < 3; ++drive) {
      EXPECT_NEAR(log.q(50, drive), position(0.05) + drive, 1e-6) << first;
      EXPECT_NEAR(log.tau(50, drive), torque(0.05) + 10 * drive, 1e-6) << first;
    }
  }
}

TEST(LogImport, SlidingDriveWithASpindle) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive(DriveKind::prismatic);
  const std::string text = recorded("Time [s],Motor angle [deg],Motor torque [Nm]\n", [](int, double t) {
    return fmt::format("{:.3f},{:.9f},{:.9f}\n", t, position(t) / 0.01 * 360.0,
                       torque(t) * 0.01 / (2.0 * std::numbers::pi));
  });
  ImportOptions options;
  const std::string file = folder.write("log.csv", text);
  EXPECT_THAT(words_of_error([&] { (void)LogImport({file}, robot, options).log(); }), HasSubstr("--lead-m-turn"));
  options.defaults.lead = {0.01};
  const Log log = LogImport({file}, robot, options).log().log;
  EXPECT_NEAR(log.q(77, 0), position(0.077), 1e-9);
  EXPECT_NEAR(log.tau(77, 0), torque(0.077), 1e-5);
}

TEST(LogImport, TimeGapsStayGapsWhereASlowerChannelIsInterpolated) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  const std::string text = recorded("t_s,q1_rad,tau1_Nm\n", [](int k, double t) {
    const bool lost = k > 200 && k < 260;
    return k % 2 == 0 && !lost ? fmt::format("{:.3f},{:.9f},{:.9f}\n", t, position(t), torque(t))
                               : fmt::format("{:.3f},{:.9f},\n", t, position(t));
  });
  const Log log = LogImport({folder.write("log.csv", text)}, robot, {}).log().log;
  EXPECT_TRUE(std::isnan(log.tau(230, 0)));
  EXPECT_FALSE(std::isnan(log.tau(199, 0)));
  EXPECT_FALSE(std::isnan(log.tau(270, 0)));
}

/// A recording that must not be guessed, and what the words say.
struct Refused {
  const char* name;
  std::string head;
  std::string row;  ///< with {t}, {q} and {tau}
  int drives;
  std::vector<const char*> message;
};

class ImportRefusalTest : public ::testing::TestWithParam<Refused> {};

TEST_P(ImportRefusalTest, NamesTheNextStep) {
  const TemporaryFolder folder;
  const RobotDescription robot = drives(GetParam().drives);
  const std::string text = recorded(GetParam().head, [](int, double t) {
    return fmt::format(fmt::runtime(GetParam().row), fmt::arg("t", t), fmt::arg("q", position(t)),
                       fmt::arg("tau", torque(t))) +
           "\n";
  });
  const std::string words = words_of_error([&] { (void)LogImport({folder.write("log.csv", text)}, robot, {}).log(); });
  for (const char* part : GetParam().message) EXPECT_THAT(words, HasSubstr(part));
  EXPECT_THAT(words, HasSubstr("mend: "));
}

INSTANTIATE_TEST_SUITE_P(
    Table, ImportRefusalTest,
    ::testing::Values(
        Refused{"NoUnit",
                "t_s,position,torque [Nm]\n",
                "{t},{q},{tau}",
                1,
                {"states no unit", "--position-unit", "[[channel]]", "source = \"position\""}},
        Refused{"TwoPositions",
                "t_s,motor angle [rad],arm angle [rad],torque [Nm]\n",
                "{t},{q},{q},{tau}",
                1,
                {"'motor angle [rad]'", "'arm angle [rad]'", "map"}},
        Refused{"OnlyCommanded",
                "t_s,target position [rad],torque [Nm]\n",
                "{t},{q},{tau}",
                1,
                {"only a commanded position"}},
        Refused{"CurrentWithoutConstant",
                "t_s,q1_rad,current1_A\n",
                "{t},{q},{tau}",
                1,
                {"torque constant", "--torque-constant"}},
        Refused{
            "PercentWithoutRated", "t_s,q1_rad,torque [%]\n", "{t},{q},{tau}", 1, {"rated torque", "--rated-torque"}},
        Refused{"CountsWithoutTurn",
                "t_s,position [cnt],torque [Nm]\n",
                "{t},{q},{tau}",
                1,
                {"counts in a turn", "--counts-per-turn"}},
        Refused{"MoreJointsThanDrives",
                "t_s,q1 [rad],q2 [rad],q3 [rad],tau1 [Nm],tau2 [Nm],tau3 [Nm]\n",
                "{t},{q},{q},{q},{tau},{tau},{tau}",
                2,
                {"'q1 [rad]', 'q2 [rad]', 'q3 [rad]'"}},
        Refused{"TimeOfUnknownUnit",
                "time,q1_rad,tau1_Nm\n",
                "{t:.0f}e3,{q},{tau}",
                1,
                {"usual step is 1000", "--time-unit"}},
        Refused{"WordsInAColumn",
                "t_s,q1 [rad],torque [Nm]\n",
                "{t},{q},on",
                1,
                {"line 2, column torque [Nm]", "'on' is not a number"}},
        Refused{"OtherDrivesTorque", "t_s,q1 [rad],tau2 [Nm]\n", "{t},{q},{tau}", 1, {"'tau2 [Nm]'"}},
        Refused{"NoHeader", "", "{t},{q},{tau}", 1, {"line 1", "header line is missing", "source = 2"}}),
    [](const auto& one) { return std::string(one.param.name); });

TEST(LogImport, NamesOfALogOfTheseToolsMeanTheirDrive) {
  const TemporaryFolder folder;
  const auto row = [](int, double t) { return fmt::format("{:.3f};1;2;3;11;12;13\n", t); };
  const std::string file = folder.write("a.csv", recorded("t_s;q3_rad;q1_rad;q2_rad;tau3_Nm;tau1_Nm;tau2_Nm\n", row));
  const RobotDescription two = drives(2);
  const Log log = LogImport({file}, two, {}).log().log;
  EXPECT_THAT(log.notes,
              Contains(HasSubstr("2 drives, so as position 'q1_rad', 'q2_rad' were taken; 'q3_rad' is not used")));
  EXPECT_THAT(log.notes, Contains(HasSubstr("as torque 'tau1_Nm', 'tau2_Nm' were taken; 'tau3_Nm' is not used")));
  EXPECT_EQ(log.q(5, 0), 2.0);
  EXPECT_EQ(log.q(5, 1), 3.0);
  EXPECT_EQ(log.tau(5, 1), 13.0);
  const RobotDescription four = drives(4);
  EXPECT_THAT(words_of_error([&] { (void)LogImport({file}, four, {}).log(); }), HasSubstr("4 drives"));
}

TEST(LogImport, PrefersTorqueToCurrentAndMeasuredToCommandedAndSaysWhenItTakesACommand) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  const auto row = [](int, double t) { return fmt::format("{:.3f},{:.9f},7,8,9\n", t, position(t)); };
  const LogImport both(
      {folder.write("a.csv", recorded("t_s,actual position [rad],current [A],torque [Nm],position [cnt]\n", row))},
      robot, {});
  EXPECT_EQ(both.log().log.tau(3, 0), 8.0);
  EXPECT_NEAR(both.log().log.q(3, 0), position(0.003), 1e-8);
  const LogImport command({folder.write("b.csv", recorded("t_s,q1 [rad],x,torque command [Nm],y\n", row))}, robot, {});
  EXPECT_THAT(command.log().log.notes, ::testing::Contains(HasSubstr("commanded torque")));
}

TEST(LogImport, DamagedFilesAreReadOrRefusedButNeverCrash) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  std::mt19937_64 engine(7);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(engine() % n); };
  const std::vector<std::string> pieces = {
      ",", ";", "\t", "\n", "\"", "#", "nan", "1e308", "99999999999999999999", "12:30:00", "0001-01-01", "[", "\xff"};
  int read = 0, refused = 0;
  for (const Form& form : forms()) {
    for (int k = 0; k < 12; ++k) {
      std::string text = form.text;
      for (int change = 0; change <= k % 3; ++change) {
        const std::size_t at = below(change == 0 ? std::min<std::size_t>(text.size(), 120) : text.size());
        if (k % 3 == 0) text.erase(at, 1 + below(60));
        if (k % 3 != 0) text.insert(at, pieces[below(pieces.size())]);
        if (k % 6 == 0) text.resize(text.size() - below(text.size() / 3));
      }
      ImportOptions options;
      options.defaults = form.defaults;
      try {
        const LogImport import({folder.write("log.txt", text)}, robot, options);
        (void)import.map_text();
        (void)import.log();
        ++read;
      } catch (const Error& error) {
        EXPECT_FALSE(error.mend().empty()) << error.what();
        ++refused;
      }
    }
  }
  EXPECT_GT(read, 10);
  EXPECT_GT(refused, 10);
}

TEST(LogImport, FilesWithTheSameColumnsAreRecordingsOfTheirOwn) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  const std::string text = recorded("t_s,q1_rad,tau1_Nm\n",
                                    [](int, double t) { return fmt::format("{},{},{}\n", t, position(t), torque(t)); });
  const std::string words = words_of_error([&] {
    (void)LogImport({folder.write("a.csv", text), folder.write("b.csv", text)}, robot, {});
  });
  EXPECT_THAT(words, HasSubstr("recordings of their own"));
}

TEST(LogImport, MapTextOfAnIncompleteGuessNamesEveryColumnAndIsAMap) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  const std::string text =
      recorded("t_s,x \"1\",y\n", [](int, double t) { return fmt::format("{},{},{}\n", t, position(t), torque(t)); });
  const LogImport import({folder.write("log.csv", text)}, robot, {});
  EXPECT_FALSE(import.is_complete());
  const std::string map = import.map_text();
  EXPECT_THAT(map, HasSubstr("STILL OPEN"));
  EXPECT_THAT(map, HasSubstr("\"y\""));
  const ColumnMap back = read_column_map(folder.write("map.toml", map), robot);
  EXPECT_EQ(back.time_source, "t_s");
}

// What the names do not say is for the user to fill in: no more than drive, quantity and unit.
TEST(LogImport, MapTextHoldsABlockForEveryColumnThatIsNotTaken) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  const std::string text = recorded("t_s,left [deg],right [Nm],heat\n", [](int, double t) {
    return fmt::format("{},{},{},20\n", t, position(t), torque(t));
  });
  const std::string file = folder.write("log.csv", text);
  std::string map = LogImport({file}, robot, {}).map_text();
  const std::string block =
      "# [[channel]]\n# drive = DRIVE\n# quantity = QUANTITY\n# source = \"heat\"\n# unit = \"UNIT\"\n";
  ASSERT_THAT(map, HasSubstr(block));
  // Filled in, the block is a channel.
  std::string filled = block;
  for (const auto& [from, to] :
       {std::pair<std::string, std::string>{"# ", ""}, {"DRIVE", "1"}, {"QUANTITY", "\"velocity\""}, {"UNIT", "rpm"}}) {
    for (auto at = filled.find(from); at != std::string::npos; at = filled.find(from))
      filled.replace(at, from.size(), to);
  }
  map.replace(map.find(block), block.size(), filled);
  const ColumnMap back = read_column_map(folder.write("map.toml", map), robot);
  ASSERT_NE(back.find(Quantity::velocity, 1), nullptr);
  EXPECT_EQ(back.find(Quantity::velocity, 1)->source, "heat");
}

// What import would refuse next stands in the block of its channel, as a line to fill in.
TEST(LogImport, MapTextMarksTheConstantsThatAreOpen) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  struct Case {
    const char *head, *line;
  };
  for (const auto& [head, line] : {Case{"t_s,q1 [rad],current1 [A]\n", "torque_constant_Nm_A"},
                                   Case{"t_s,q1 [rad],torque1 [%]\n", "rated_torque_Nm"},
                                   Case{"t_s,q1 [cnt],torque1 [Nm]\n", "counts_per_turn"}}) {
    const std::string file = folder.write(
        "log.csv", recorded(head, [](int, double t) { return fmt::format("{},{},{}\n", t, position(t), torque(t)); }));
    std::string map = LogImport({file}, robot, {}).map_text();
    EXPECT_THAT(map, HasSubstr(fmt::format("# STILL OPEN below: {}\n", line)));
    const std::string open = fmt::format("# {} = NUMBER   # STILL OPEN", line);
    ASSERT_THAT(map, HasSubstr(open));
    map.replace(map.find(open), open.size(), fmt::format("{} = 2   # ", line));
    ImportOptions options;
    options.map_file = folder.write("map.toml", map);
    EXPECT_EQ(LogImport({file}, robot, options).log().log.samples(), kMotionRows) << line;
  }
}

TEST(LogImport, MapTextOfColumnsWithoutNamesBeginsWithTheTime) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  const std::string file = folder.write(
      "log.csv", recorded("", [](int k, double t) { return fmt::format("{},{},{}\n", k, position(t), torque(t)); }));
  std::string map = LogImport({file}, robot, {}).map_text();
  EXPECT_THAT(map, HasSubstr("\n[time]\nsource = \"column1\"\n# unit = \"UNIT\"   # STILL OPEN"));
  EXPECT_THAT(map, Not(HasSubstr("# source = \"column1\"")));
  EXPECT_THAT(map, HasSubstr("# source = \"column2\""));
  EXPECT_THAT(map, Not(HasSubstr("--map-out")));  // it is written
  map.replace(map.find("# unit = \"UNIT\"   #"), 19, "unit = \"ms\"   #");
  for (const char* channel : {"position\"\nsource = 2\nunit = \"rad\"\n", "torque\"\nsource = 3\nunit = \"Nm\"\n"})
    map += fmt::format("[[channel]]\ndrive = 1\nquantity = \"{}", channel);
  ImportOptions options;
  options.map_file = folder.write("map.toml", map);
  EXPECT_NEAR(LogImport({file}, robot, options).log().log.q(300, 0), position(0.3), 1e-6);
}

// A machine with more joints than drives, so that all are to be chosen: their units are those of the message.
TEST(LogImport, MapTextOfJointStatesHasTheUnitsOfRos) {
  const TemporaryFolder folder;
  const auto row = [](int, double t) { return fmt::format("{:.3f},1,2,3,4,5,6\n", 1.7e9 + t); };
  const std::string text = recorded(
      "__time,/joint_states/a/position,/joint_states/b/position,/joint_states/a/velocity,/joint_states/b/velocity,"
      "/joint_states/a/effort,/joint_states/b/effort\n",
      row);
  const std::string file = folder.write("log.csv", text);
  for (const DriveKind kind : {DriveKind::revolute, DriveKind::prismatic}) {
    const RobotDescription robot = one_drive(kind);
    const std::string map = LogImport({file}, robot, {}).map_text();
    EXPECT_THAT(map, Not(HasSubstr("\"UNIT\"")));
    const bool turns = kind == DriveKind::revolute;
    for (const char* unit : {turns ? "rad" : "m", turns ? "rad/s" : "m/s", turns ? "Nm" : "N"})
      EXPECT_THAT(map, HasSubstr(fmt::format("# unit = \"{}\"", unit)));
  }
}

TEST(LogImport, RateIsThatOfTheRowsAndNotOfTheUsualInterval) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  const std::string text = recorded("t_s,q1_rad,tau1 [Nm]\n", [](int k, double t) {
    return fmt::format("{:.5f},{},{}\n", t + (k % 3 == 0 ? 2e-5 : 0.0), position(t),
                       torque(t));  // two of three steps are longer or shorter
  });
  const ImportedLog log = LogImport({folder.write("log.csv", text)}, robot, {}).log();
  EXPECT_NEAR(log.taken[0].rate_hz, 599.0 / (0.599 - 2e-5), 1e-6);
}

TEST(LogImport, NextStepNamesTheMapThatIsThere) {
  for (const char* mend :
       {"write a column map (delta-log import --map-out map.toml begins one) and give it with --map; it needs",
        "name the column q1_rad; or write a column map (--map)\n",
        "say which in a column map (delta-log import --map-out map.toml begins one)\n",
        "give delta-log import --rated-torque, or rated_torque_Nm in a column map (--map)"}) {
    EXPECT_THAT(mend_in_map(mend, "m.toml"), HasSubstr("m.toml"));
    EXPECT_THAT(mend_in_map(mend, "m.toml"), Not(HasSubstr("column map"))) << mend;
  }
}

// The Scope scales on its screen; the rows are raw, and so is a unit after "Unit ScaleFactor" not theirs.
TEST(LogImport, SaysThatTheScalesOfTheScopesScreenWereNotApplied) {
  const TemporaryFolder folder;
  std::string text = "Name\tProject\nFile\tx.csv\nStarttime of export\t132959733843760000\nEndtime of export\t1\n\n\n";
  text += "Name\tActPos\tActTorque\tplain\nSampleTime[ms]\t1\t1\t1\nOffset\t1\t0\t0\nScaleFactor\t-1\t1\t1\n";
  text += "Unit\trad (Angle)\tNm (Torque)\trad (Angle)\nUnit ScaleFactor\t1\t-10\t1\nUnit Offset\t0\t10\t0\n\n";
  for (int k = 0; k < 100; ++k) text += fmt::format("{}\t{}\t{}\t0\n", k, 0.01 * k, 2 * k);
  const RobotDescription robot = one_drive();
  const std::string file = folder.write("scope.csv", text);
  MapDefaults units;
  units.torque_unit = "mNm";
  ImportOptions options;
  options.defaults = units;
  const std::string map = folder.write("map.toml",
                                       "[[channel]]\ndrive = 1\nquantity = \"position\"\nsource = \"ActPos\"\n"
                                       "[[channel]]\ndrive = 1\nquantity = \"torque\"\nsource = \"ActTorque\"\n");
  options.map_file = map;
  const Log log = LogImport({file}, robot, options).log().log;
  EXPECT_NEAR(log.q(50, 0), 0.5, 1e-12);
  EXPECT_THAT(
      log.notes,
      Contains(HasSubstr("'ActPos': ScaleFactor -1, Offset 1, Unit ScaleFactor 1 and Unit Offset 0 of the header are "
                         "of the Scope's display")));
  EXPECT_THAT(log.notes, Contains(HasSubstr("the unit Nm is of the display, too, and was not taken")));
}

}  // namespace
}  // namespace deltadyn
