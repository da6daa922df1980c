#include "deltadyn/identification/log_gate.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "identification/faulty_logs.hpp"
#include "identification/pick_and_place_log.hpp"
#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

struct Recording {
  double rate_hz = 1000, noise = 0.1, encoder_bits = 19, duration_s = 8;
  double fast_hz = 0.35;  ///< base frequency of the fast log
  std::uint64_t seed = 1;
  double unbalance = 0;  ///< of the tool [kg m]: tells left from right
};

Eigen::VectorXd truth_of(const Robot& robot, const Recording& how) {
  Eigen::VectorXd p = delta_truth(robot);
  for (int k = 0; k < robot.parameters(); ++k) {
    if (robot.parameter_names()[static_cast<std::size_t>(k)] == "tool.mcx") p(k) = how.unbalance;
  }
  return p;
}

/// A fast log and a slow one, as a drive records them.
std::vector<Log> recordings_of(const Robot& robot, const Recording& how = {}) {
  std::vector<Log> logs;
  for (const std::uint64_t part : {0U, 1U}) {
    SyntheticOptions synthetic;
    synthetic.duration_s = how.duration_s;
    synthetic.rate_hz = how.rate_hz;
    synthetic.torque_noise = how.noise;
    const bool turns = robot.description().drive_kind == DriveKind::revolute;
    synthetic.encoder_step = (turns ? 6.283 : 0.5) / std::pow(2.0, how.encoder_bits);
    synthetic.with_derivatives = false;
    synthetic.seed = 10 * how.seed + part;
    synthetic.base_frequency_hz = part == 0 ? how.fast_hz : 0.15;
    logs.push_back(synthetic_log(robot, truth_of(robot, how), synthetic));
    logs.back().file = part == 0 ? "fast" : "slow";
  }
  return logs;
}

GateResult examine(const Robot& robot, std::vector<Log> logs, double prior = 1.3) {
  const Eigen::VectorXd value = prior * delta_truth(robot);
  Eigen::VectorXd std = 0.5 * value.cwiseAbs();
  for (Eigen::Index k = 0; k < std.size(); ++k) std(k) = std::max(std(k), 0.001);
  return examine_logs(robot, std::move(logs), value, std);
}

std::string told(const GateResult& result) {
  std::string text;
  for (const LogFinding& f : result.findings) text += "  [" + f.key + "] " + f.text + "\n";
  return text;
}

const LogFinding* find(const GateResult& result, const std::vector<std::string>& keys, FindingLevel level) {
  for (const LogFinding& f : result.findings) {
    if (f.level == level && std::find(keys.begin(), keys.end(), f.key) != keys.end()) return &f;
  }
  return nullptr;
}

class LogGate : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Robots, LogGate, testing::Values("delta3", "linear-delta3", "delta4"), [](const auto& robot) {
  return std::string(robot.param) == "linear-delta3" ? "linear" : robot.param;
});

TEST_P(LogGate, CallsEveryFaultByItsName) {
  const auto robot = make_robot(delta_description(GetParam()));
  const std::vector<Log> sound = recordings_of(*robot);
  for (const FaultyLog& fault : faulty_logs(robot->description())) {
    std::vector<Log> logs = sound;
    for (Log& log : logs) fault.spoil(log);
    const GateResult result = examine(*robot, logs);
    const LogFinding* finding = find(result, fault.keys, FindingLevel::fault);
    EXPECT_NE(finding, nullptr) << fault.name << "\n" << told(result);
    if (finding == nullptr || fault.value == 0) continue;
    EXPECT_NEAR(finding->value / fault.value, 1.0, 0.03) << fault.name << "\n" << told(result);
  }
}

// A thousand is farther off than any gear: it must not be told as two gears one behind the other.
TEST(LogGateUnits, PositionsOfCarriagesInMillimetresAreOneFault) {
  const auto robot = make_robot(delta_description("linear-delta3"));
  std::vector<Log> logs = recordings_of(*robot);
  for (Log& log : logs) log.q *= 1000;
  const GateResult result = examine(*robot, logs);
  const LogFinding* finding = find(result, {"position_scale"}, FindingLevel::fault);
  ASSERT_NE(finding, nullptr) << told(result);
  EXPECT_NE(finding->text.find("all drives looks like millimetres"), std::string::npos) << finding->text;
  EXPECT_EQ(finding->text.find("gear"), std::string::npos) << finding->text;
}

TEST_P(LogGate, LeavesSoundLogsAlone) {
  const auto robot = make_robot(delta_description(GetParam()));
  std::uint64_t seed = 3;
  for (const double rate : {250.0, 1000.0, 4000.0}) {
    for (const double noise : {0.03, 0.1, 0.5}) {
      for (const double bits : {13.0, 24.0}) {
        Recording how;
        how.rate_hz = rate;
        how.noise = noise;
        how.encoder_bits = bits;
        how.seed = ++seed;
        const double prior = seed % 2 == 0 ? 0.7 : 1.3;  // 30 % off either way is no fault
        const GateResult result = examine(*robot, recordings_of(*robot, how), prior);
        for (const LogFinding& f : result.findings) {
          EXPECT_EQ(f.level, FindingLevel::fine)
              << rate << " Hz, noise " << noise << ", " << bits << " bits: " << f.text;
        }
      }
    }
  }
}

// A spring between base and arm is of the machine: no zero and no factor of the positions, which follow its torque to
// some extent.
TEST_P(LogGate, LeavesSpringsToTheDiagnosis) {
  const auto robot = make_robot(delta_description(GetParam()));
  const std::vector<Log> sound = recordings_of(*robot);
  for (const double share : {0.1, 0.3, 1.0}) {  // of the drive's largest torque, over its range
    for (const bool all : {false, true}) {
      std::vector<Log> logs = sound;
      const double range = sound[0].q.col(0).maxCoeff() - sound[0].q.col(0).minCoeff();
      const double stiffness = share * sound[0].tau.col(0).cwiseAbs().maxCoeff() / range;
      for (Log& log : logs) {
        for (Eigen::Index j = 0; j < (all ? 3 : 1); ++j)
          log.tau.col(j).array() += stiffness * (log.q.col(j).array() - 0.3);
      }
      const GateResult result = examine(*robot, logs);
      for (const LogFinding& f : result.findings) {
        EXPECT_NE(f.level, FindingLevel::fault) << share << (all ? ", all: " : ", one: ") << f.text;
        EXPECT_NE(f.level, FindingLevel::mended) << share << (all ? ", all: " : ", one: ") << f.text;
      }
    }
  }
}

// A rotor that only one drive has is of the machine, too.
TEST_P(LogGate, LeavesARotorToTheDiagnosis) {
  const auto robot = make_robot(delta_description(GetParam()));
  Recording how;
  how.encoder_bits = 24;
  const std::vector<Log> sound = recordings_of(*robot, how);
  const auto acceleration = [](const Log& log, Eigen::Index k, Eigen::Index j) {
    constexpr Eigen::Index kStep = 5;
    if (k < kStep || k + kStep >= log.q.rows()) return 0.0;
    const double h = log.t_s(k) - log.t_s(k - kStep);
    return (log.q(k + kStep, j) - 2 * log.q(k, j) + log.q(k - kStep, j)) / (h * h);
  };
  double largest = 0;
  for (Eigen::Index k = 0; k < sound[0].q.rows(); ++k)
    largest = std::max(largest, std::abs(acceleration(sound[0], k, 2)));
  for (const double share : {0.1, 0.3}) {  // of the drive's largest torque
    std::vector<Log> logs = sound;
    const double inertia = share * sound[0].tau.col(2).cwiseAbs().maxCoeff() / largest;
    for (std::size_t l = 0; l < logs.size(); ++l)
      for (Eigen::Index k = 0; k < logs[l].q.rows(); ++k) logs[l].tau(k, 2) += inertia * acceleration(sound[l], k, 2);
    const GateResult result = examine(*robot, logs);
    for (const LogFinding& f : result.findings) EXPECT_NE(f.level, FindingLevel::fault) << share << ": " << f.text;
  }
}

// A counterweight that carries the arms, a little more or a little less, turns no base upside down.
TEST_P(LogGate, LeavesACounterweightToTheDiagnosis) {
  const auto robot = make_robot(delta_description(GetParam()));
  const std::vector<Log> sound = recordings_of(*robot);
  EquationTerms terms;
  for (const double share : {0.95, 1.0, 1.05, 1.1, 2.0}) {  // the last one: all of gravity the other way
    std::vector<Log> logs = sound;
    for (Log& log : logs) {
      for (Eigen::Index k = 0; k < log.q.rows(); ++k) {
        const Eigen::VectorXd q = log.q.row(k).transpose(), still = Eigen::VectorXd::Zero(q.size());
        ASSERT_EQ(robot->equations_of_motion(q, still, delta_truth(*robot), Coordinates::drives, terms), Status::ok);
        log.tau.row(k) -= share * terms.g.transpose();
      }
    }
    const GateResult result = examine(*robot, logs);
    const bool faulty =
        std::ranges::any_of(result.findings, [](const LogFinding& f) { return f.level == FindingLevel::fault; });
    EXPECT_EQ(faulty, share == 2) << share << ": " << told(result);
    EXPECT_EQ(find(result, {"gravity_carried"}, FindingLevel::warning) != nullptr, share < 2)
        << share << ": " << told(result);
  }
}

// Stops, a log that begins at rest, and high rates are no fault, alone and beside a planned motion.
TEST_P(LogGate, LeavesPickAndPlaceAndStandstillAlone) {
  const auto robot = make_robot(delta_description(GetParam()));
  const bool turns = robot->description().drive_kind == DriveKind::revolute;
  std::uint64_t seed = 40;
  for (const double rate : {250.0, 1000.0, 8000.0}) {
    for (const double noise : {0.03, 0.5}) {
      for (const double first_stop_s : {0.0, 2.5}) {
        SyntheticOptions synthetic;
        synthetic.rate_hz = rate;
        synthetic.torque_noise = noise;
        synthetic.duration_s = 8;
        synthetic.seed = ++seed;
        synthetic.encoder_step = (turns ? 6.283 : 0.5) / std::exp2(seed % 2 == 0 ? 15 : 20);
        PickAndPlace work;
        work.first_stop_s = first_stop_s;
        std::vector<Log> logs = {pick_and_place_log(*robot, delta_truth(*robot), synthetic, work)};
        if (seed % 2 == 0) {
          Recording how;
          how.rate_hz = rate;
          how.noise = noise;
          how.seed = seed;
          logs.push_back(recordings_of(*robot, how).front());
        }
        const GateResult result = examine(*robot, logs);
        for (const LogFinding& f : result.findings) {
          EXPECT_EQ(f.level, FindingLevel::fine)
              << rate << " Hz, noise " << noise << ", seed " << seed << ": " << f.text;
        }
      }
    }
  }
}

TEST_P(LogGate, RemovesADelayAndSaysHowLongItWas) {
  const auto robot = make_robot(delta_description(GetParam()));
  std::uint64_t seed = 1;
  for (const double delay : {-5e-3, -2e-3, -0.5e-3, 0.5e-3, 1e-3, 2e-3, 3.3e-3, 5e-3, 7e-3, 10e-3}) {
    Recording how;
    how.seed = ++seed;
    how.fast_hz = 0.6;  // as a planned excitation
    std::vector<Log> logs = recordings_of(*robot, how);
    const std::vector<Log> sound = logs;
    for (Log& log : logs) make_late(log, delay, 0);
    const GateResult result = examine(*robot, logs);
    EXPECT_FALSE(result.fault()) << told(result);
    const LogFinding* finding = find(result, {"delay"}, FindingLevel::mended);
    // Alike if short
    if (finding == nullptr && std::abs(delay) < 1e-3) finding = find(result, {"lag"}, FindingLevel::mended);
    ASSERT_NE(finding, nullptr) << delay << "\n" << told(result);
    EXPECT_NEAR(finding->value, delay, 1e-4) << told(result);
    EXPECT_LT(std::abs(finding->value - delay), 4 * finding->std) << told(result);
    const Eigen::Index inner = sound[0].samples() - 200;
    const Eigen::VectorXd left = (result.logs[0].tau - sound[0].tau).col(0).segment(100, inner);
    EXPECT_LT(left.norm(), 0.05 * sound[0].tau.col(0).norm());
  }
}

TEST_P(LogGate, FindsALowPassOfTheTorque) {
  const auto robot = make_robot(delta_description(GetParam()));
  for (const double lag : {0.5e-3, 3e-3}) {
    std::vector<Log> logs = recordings_of(*robot);
    for (Log& log : logs) make_late(log, 0, lag);
    const GateResult result = examine(*robot, logs);
    const LogFinding* finding = find(result, {"lag", "delay"}, FindingLevel::mended);
    ASSERT_NE(finding, nullptr) << told(result);
    EXPECT_NEAR(finding->value, lag, 0.1e-3 + 0.03 * lag) << told(result);
  }
}

TEST(LogGateDelay, OfOneDriveOrOneLogOnly) {
  const auto robot = make_robot(delta_description("delta4"));
  Recording other;
  other.seed = 2;
  // In a slow log 3 ms hardly show: both are fast.
  std::vector<Log> one_drive = recordings_of(*robot), one_log = {one_drive[0], recordings_of(*robot, other)[0]};
  one_log[1].file = "another";
  for (Log& log : one_drive) make_late(log, 3e-3, 0, 1);
  const GateResult by_drive = examine(*robot, one_drive);
  const LogFinding* finding = find(by_drive, {"delay"}, FindingLevel::mended);
  ASSERT_NE(finding, nullptr) << told(by_drive);
  EXPECT_EQ(finding->drive, 1) << told(by_drive);
  EXPECT_NEAR(finding->value, 3e-3, 2e-4);
  make_late(one_log[0], 3e-3, 0);
  const GateResult by_log = examine(*robot, one_log);
  finding = find(by_log, {"delay"}, FindingLevel::mended);
  ASSERT_NE(finding, nullptr) << told(by_log);
  EXPECT_EQ(finding->file, "fast") << told(by_log);
  EXPECT_NEAR(finding->value, 3e-3, 2e-4);
}

TEST_P(LogGate, FindsClocksThatRunApart) {
  const auto robot = make_robot(delta_description(GetParam()));
  Recording how;
  how.noise = 0.03;
  const std::vector<Log> sound = recordings_of(*robot, how);
  std::vector<Log> logs = sound;
  constexpr double kRate = 8e-4;
  for (Log& log : logs) {
    const Eigen::VectorXd late = -kRate * (log.t_s.array() - log.t_s(0));
    for (Eigen::Index j = 0; j < log.drives(); ++j)
      log.tau.col(j) = mend_delays(log.tau.col(j), log.sample_time_s(), late);
  }
  const GateResult result = examine(*robot, logs);
  const LogFinding* finding = find(result, {"drift"}, FindingLevel::mended);
  ASSERT_NE(finding, nullptr) << told(result);
  EXPECT_NEAR(finding->value, kRate, 0.1 * kRate) << told(result);
  // What is left of the change.
  const Eigen::Index middle = result.logs[0].samples() / 2;
  const double before = (sound[0].tau - logs[0].tau).middleRows(middle, 2000).norm();
  const double after = (sound[0].tau - result.logs[0].tau).middleRows(middle, 2000).norm();
  EXPECT_LT(after, 0.3 * before) << told(result);
}

TEST_P(LogGate, NamesATorqueWhoseZeroIsOff) {
  const auto robot = make_robot(delta_description(GetParam()));
  std::vector<Log> logs = recordings_of(*robot);
  for (Log& log : logs) log.tau.col(1).array() += 5;
  const GateResult result = examine(*robot, logs);
  const LogFinding* finding = find(result, {"torque_offset"}, FindingLevel::warning);
  ASSERT_NE(finding, nullptr) << told(result);
  EXPECT_EQ(finding->drive, 1);
  EXPECT_NEAR(finding->value, 5, 0.1);
  EXPECT_FALSE(result.stop());
  EXPECT_EQ(find(result, {"scale"}, FindingLevel::warning), nullptr) << told(result);
}

// Each of its own size: no smaller set and no other size stands for them.
TEST_P(LogGate, NamesTheOffsetsOfAllDrives) {
  const auto robot = make_robot(delta_description(GetParam()));
  for (const Eigen::Vector3d& offsets : {Eigen::Vector3d(1.5, -2, 1), Eigen::Vector3d(3, 3, 3)}) {
    const double unit = robot->description().kind_of_drive(0) == DriveKind::revolute ? 1 : 5;
    std::vector<Log> logs = recordings_of(*robot);
    for (Log& log : logs) log.tau.leftCols(3).rowwise() += unit * offsets.transpose();
    const GateResult result = examine(*robot, logs);
    const LogFinding* finding = find(result, {"torque_offset"}, FindingLevel::warning);
    ASSERT_NE(finding, nullptr) << told(result);
    EXPECT_EQ(finding->drive, -1);
    const char* who = robot->drives() == 3 ? "all drives" : "drives 1, 2 and 3";
    EXPECT_NE(finding->text.find(who), std::string::npos) << told(result);
    EXPECT_NEAR(finding->value, unit * offsets(0), 0.2 * unit) << told(result);
    EXPECT_FALSE(result.stop());
  }
}

TEST(LogGateScale, IsJudgedBesideATorqueWhoseZeroIsOff) {
  const auto robot = make_robot(delta_description("delta3"));
  const Eigen::VectorXd prior = delta_truth(*robot);
  const Eigen::VectorXd std = (0.02 * prior.cwiseAbs()).cwiseMax(1e-4);
  std::vector<Log> logs = recordings_of(*robot);
  for (Log& log : logs) {
    log.tau *= 1.5;
    log.tau.col(1).array() += 5;
  }
  const GateResult result = examine_logs(*robot, logs, prior, std);
  EXPECT_NE(find(result, {"torque_offset"}, FindingLevel::warning), nullptr) << told(result);
  const LogFinding* scale = find(result, {"scale"}, FindingLevel::fault);
  ASSERT_NE(scale, nullptr) << told(result);
  EXPECT_NEAR(scale->value, 1.5, 0.05);
}

TEST(LogGateDelay, StaysInTheLogIfAsked) {
  const auto robot = make_robot(delta_description("delta3"));
  std::vector<Log> logs = recordings_of(*robot);
  for (Log& log : logs) make_late(log, 2e-3, 0);
  GateOptions options;
  options.keep_delay = true;
  const GateResult result = examine_logs(*robot, logs, {}, {}, options);
  EXPECT_NE(find(result, {"delay"}, FindingLevel::warning), nullptr) << told(result);
  EXPECT_EQ((result.logs[0].tau - logs[0].tau).norm(), 0);
}

TEST(LogGateScale, WeighedMassesMakeItCertain) {
  const auto robot = make_robot(delta_description("delta3"));
  const Eigen::VectorXd prior = delta_truth(*robot);
  const Eigen::VectorXd std = (0.02 * prior.cwiseAbs()).cwiseMax(1e-4);
  std::vector<Log> logs = recordings_of(*robot);
  EXPECT_FALSE(examine_logs(*robot, logs, prior, std).fault());
  for (Log& log : logs) log.tau *= 1.5;
  const GateResult result = examine_logs(*robot, logs, prior, std);
  const LogFinding* finding = find(result, {"scale"}, FindingLevel::fault);
  ASSERT_NE(finding, nullptr) << told(result);
  EXPECT_NEAR(finding->value, 1.5, 0.05);
  EXPECT_FALSE(result.stop());
}

void turn_yaw(Log& log) {
  log.q.col(3) *= -1;
  log.tau.col(3) *= -1;
}

void number_clockwise(Log& log) {
  log.q.col(1).swap(log.q.col(2));
  log.tau.col(1).swap(log.tau.col(2));
}

// One of the two mirrored is a machine that the robot file does not describe, both are its mirror image.
TEST(LogGateMirror, TellsLimbsAndYawThatDoNotBelongTogether) {
  const auto robot = make_robot(delta_description("delta4"));
  for (const double noise : {0.03, 0.1}) {
    Recording how;
    how.noise = noise;
    how.fast_hz = 0.6;
    how.unbalance = 0.002;
    for (const auto& [yaw, limbs] : {std::pair(true, false), {false, true}, {true, true}, {false, false}}) {
      std::vector<Log> logs = recordings_of(*robot, how);
      for (Log& log : logs) {
        if (yaw) turn_yaw(log);
        if (limbs) number_clockwise(log);
      }
      const GateResult result = examine(*robot, logs);
      EXPECT_FALSE(result.fault()) << told(result);
      const LogFinding* finding = find(result, {"mirrored"}, FindingLevel::warning);
      EXPECT_EQ(finding != nullptr, yaw != limbs) << noise << " " << yaw << limbs << "\n" << told(result);
      if (finding != nullptr) {
        EXPECT_NE(finding->mend.find("counter-clockwise"), std::string::npos);
      }
    }
  }
}

// A heavy unbalance makes it plain: a fault, and both causes are said.
TEST(LogGateMirror, NamesBothCausesOfAPlainFault) {
  const auto robot = make_robot(delta_description("delta4"));
  Recording how;
  how.unbalance = 0.02;
  for (const auto& spoil : {turn_yaw, number_clockwise}) {
    std::vector<Log> logs = recordings_of(*robot, how);
    for (Log& log : logs) spoil(log);
    const GateResult result = examine(*robot, logs);
    const LogFinding* finding = find(result, {"position_sign"}, FindingLevel::fault);
    ASSERT_NE(finding, nullptr) << told(result);
    EXPECT_NE(finding->text.find("as well explained: the limbs are numbered clockwise"), std::string::npos)
        << told(result);
  }
}

// Noise, motions and friction of other laws make no mirror image; where the noise hides it, nothing is said.
TEST(LogGateMirror, IsSilentOnSoundLogs) {
  const auto robot = make_robot(delta_description("delta4"));
  std::uint64_t seed = 60;
  for (const double noise : {0.03, 0.06, 0.1, 0.25, 0.5}) {
    for (const double fast_hz : {0.25, 0.35, 0.5, 0.6}) {
      Recording how;
      how.noise = noise;
      how.fast_hz = fast_hz;
      how.encoder_bits = seed % 2 == 0 ? 16 : 20;
      how.unbalance = seed % 3 == 0 ? 0.005 : 0;
      how.seed = ++seed;
      const GateResult result = examine(*robot, recordings_of(*robot, how));
      EXPECT_EQ(find(result, {"mirrored"}, FindingLevel::warning), nullptr) << noise << " " << fast_hz << "\n"
                                                                            << told(result);
    }
  }
}

TEST(LogGateDerivatives, AreComparedWithThePositions) {
  const auto robot = make_robot(delta_description("delta3"));
  SyntheticOptions synthetic;
  const Log sound = synthetic_log(*robot, delta_truth(*robot), synthetic);
  GateOptions options;
  options.given_derivatives = true;
  EXPECT_FALSE(examine_logs(*robot, {sound}, {}, {}, options).fault())
      << told(examine_logs(*robot, {sound}, {}, {}, options));
  const auto text_of = [&](const std::function<void(Log&)>& spoil) {
    Log log = sound;
    spoil(log);
    const GateResult result = examine_logs(*robot, {log}, {}, {}, options);
    const LogFinding* finding = find(result, {"rate"}, FindingLevel::fault);
    return finding == nullptr ? std::string("nothing") : finding->text;
  };
  EXPECT_EQ(text_of([](Log& log) { log.qd *= 30 / 3.141592653589793; }),
            "qd1 is 9.55 times dq1/dt: revolutions per minute?");
  EXPECT_EQ(text_of([](Log& log) { log.qd.setZero(); }), "qd1 is zero while the drive moves");
  EXPECT_EQ(text_of([](Log& log) { log.qd *= -1; }), "qd1 is -1 times dq1/dt: the sign is wrong");
  EXPECT_EQ(text_of([](Log& log) {
              const Eigen::MatrixXd before = log.qd;
              log.qd.bottomRows(before.rows() - 5) = before.topRows(before.rows() - 5);
            }),
            "qd1 is 5.0 ms late");
}

TEST(LogGateLoad, AnotherLoadInOneLogIsNoFault) {
  const auto robot = make_robot(delta_description("delta3"));
  Eigen::VectorXd heavy = delta_truth(*robot);
  for (int k = 0; k < robot->parameters(); ++k) {
    if (robot->parameter_names()[static_cast<std::size_t>(k)] == "platform.m") heavy(k) += 1.5;
  }
  std::vector<Log> logs = recordings_of(*robot);
  SyntheticOptions synthetic;
  synthetic.torque_noise = 0.1;
  synthetic.encoder_step = 1.2e-5;
  synthetic.with_derivatives = false;
  synthetic.seed = 99;
  logs.push_back(synthetic_log(*robot, heavy, synthetic));
  const GateResult result = examine(*robot, logs);
  EXPECT_FALSE(result.fault()) << told(result);
}

}  // namespace
}  // namespace deltadyn
