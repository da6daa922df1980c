// From recorded logs to trusted parameters with the installed tools, against the figures that were promised.

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <random>
#include <thread>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/geometry_of.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "acceptance/tool_run.hpp"
#include "support/oracle_of.hpp"

namespace deltadyn::acceptance {
namespace {

const std::string kRobot = "robots/mujoco_delta4.urdf";
const std::string kLogs = "logs/mujoco_delta4/";

std::string log(const std::string& name) {
  return installed(kLogs + name);
}

ParameterTable scaled(ParameterTable table, double factor) {
  for (ParameterEntry& entry : table.entries) entry.value *= factor;
  return table;
}

/// The tools' part of the work, in a folder of its own.
class Identified {
 public:
  /// delta-identify on the two identification logs, then delta-validate on the third, in `folder`.
  Identified(const testing_support::TemporaryFolder& folder, const Words& flags) : folder_(folder) {
    Words words = {"delta-identify",
                   installed(kRobot),
                   log("identification_fast.csv"),
                   log("identification_slow.csv"),
                   "-o",
                   path("params.csv"),
                   "--base",
                   path("base.csv"),
                   "--summary",
                   path("summary.csv")};
    words.insert(words.end(), flags.begin(), flags.end());
    output = succeed(words).out;
    summary = read_summary(path("summary.csv"));
    params = read_parameters(path("params.csv"));
    validation = validate(path("params.csv"));
  }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_.path(name); }

  [[nodiscard]] std::map<std::string, std::string> validate(const std::string& parameters) const {
    succeed({"delta-validate", installed(kRobot), "--params", parameters, log("verification.csv"), "-o",
             path("residuals.csv"), "--summary", path("validation.csv")});
    return read_summary(path("validation.csv"));
  }

  std::string output;
  std::map<std::string, std::string> summary, validation;
  ParameterTable params;

 private:
  const testing_support::TemporaryFolder& folder_;
};

/// Largest ratio of the residual on the verification log to that of the true parameters, less 1, in percent.
double excess_residual(const Identified& result, bool print = true) {
  const auto truth = result.validate(log("truth.csv"));
  double worst = -100;
  for (int j = 1; j <= 4; ++j) {
    const std::string key = fmt::format("rms_residual_drive{}", j);
    const double excess = 100 * (number(result.validation, key) / number(truth, key) - 1);
    if (print)
      std::cout << fmt::format("  drive {}: {:.5g} N m, truth {:.5g} N m\n", j, number(result.validation, key),
                               number(truth, key));
    worst = std::max(worst, excess);
  }
  return worst;
}

// --- the model that the parameters make ---------------------------------------------------------

/// The robot with true and identified parameters.
struct Pair {
  std::unique_ptr<Robot> robot = make_robot(read_robot_file(installed(kRobot)));
  Eigen::VectorXd truth = values(read_parameters(log("truth.csv")), robot->parameter_names(), robot->parameter_units());
  Eigen::VectorXd found;

  explicit Pair(const ParameterTable& params)
      : found(values(params, robot->parameter_names(), robot->parameter_units())) {}
};

/// Poses in the lower half ball of 0.35 m about (0, 0, -0.80) m, psi in +-3 rad.
class HalfBall {
 public:
  HalfBall(const Robot& robot, std::uint64_t seed) : robot_(robot), engine_(seed) {}
  void next(Eigen::VectorXd& q) {
    Eigen::VectorXd z(4);
    do {
      for (int k = 0; k < 3; ++k) z(k) = 0.35 * uniform(-1, k == 2 ? 0 : 1);
    } while (z.head<3>().norm() > 0.35);
    z(2) -= 0.80;
    z(3) = uniform(-3, 3);
    q.resize(4);
    if (robot_.inverse_kinematics(z, q) != Status::ok) throw std::runtime_error("the workspace is not in reach");
  }

 private:
  double uniform(double low, double high) { return low + (high - low) * unit_of_53_bits(engine_); }
  const Robot& robot_;
  std::mt19937_64 engine_;
};

void check_mass_matrix(const Pair& pair) {
  constexpr int kStates = 10000;
  HalfBall poses(*pair.robot, 11);
  Eigen::VectorXd q;
  Eigen::Matrix4d mean = Eigen::Matrix4d::Zero(), worst = Eigen::Matrix4d::Zero();
  Eigen::MatrixXd M(4, 4), T(4, 4);
  double diagonal = 0, rest = 0;
  for (int k = 0; k < kStates; ++k) {
    poses.next(q);
    ASSERT_EQ(pair.robot->mass_matrix(q, pair.found, M), Status::ok);
    ASSERT_EQ(pair.robot->mass_matrix(q, pair.truth, T), Status::ok);
    mean += T.cwiseAbs() / kStates;
    worst = worst.cwiseMax((M - T).cwiseAbs());
    for (int j = 0; j < 4; ++j) diagonal = std::max(diagonal, std::abs(M(j, j) / T(j, j) - 1));
    for (int j = 0; j < 3; ++j) rest = std::max(rest, std::abs(M(3, j) - T(3, j)) / std::sqrt(T(3, 3) * T(j, j)));
  }
  double arms = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < i; ++j) arms = std::max(arms, worst(i, j) / mean(i, j));
  }
  figure("mass_matrix_diagonal_percent", 100 * diagonal, 0.2);
  figure("mass_matrix_arms_percent_of_mean", 100 * arms, 0.5);
  figure("mass_matrix_rest_percent", 100 * rest, 0.2);
}

/// The library's M against a second derivative of the kinetic energy that shares no code with it.
void check_mass_matrix_by_energy(const Pair& pair) {
  using Layout = ParameterLayout<Delta4, Limbs::shared>;
  const auto geometry = geometry_of<double, Delta4>(pair.robot->description());
  Vector<double, Layout::kColumns> p = Vector<double, Layout::kColumns>::Zero();
  p.head(pair.found.size()) = pair.found;
  const oracles::Mechanism mechanism = testing_support::oracle_of(geometry);
  const oracles::Load load = testing_support::load_of<Delta4, Layout>(p);
  HalfBall poses(*pair.robot, 12);
  Eigen::VectorXd q, z(4);
  Eigen::MatrixXd M(4, 4);
  double worst = 0;
  for (int k = 0; k < 20; ++k) {
    poses.next(q);
    ASSERT_EQ(pair.robot->mass_matrix(q, pair.found, M), Status::ok);
    ASSERT_EQ(pair.robot->forward_kinematics(q, z), Status::ok);
    const oracles::Numbers guess = testing_support::numbers(z.head<3>());
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) {
        const auto energy = oracles::mass_matrix_entry(mechanism, load, testing_support::numbers(q), i, j, guess);
        const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
        worst = std::max(
            worst, std::abs(static_cast<double>(energy) - M(row, column)) / std::sqrt(M(row, row) * M(column, column)));
      }
    }
  }
  figure("mass_matrix_against_energy", worst, 1e-10);
}

/// Coriolis and acceleration torque along the motion of a residual file.
void check_torque_parts(const Pair& pair, const std::string& residual_file) {
  const CsvTable table = read_csv(residual_file);
  Eigen::MatrixXd q(table.rows(), 4), qd(table.rows(), 4), qdd(table.rows(), 4);
  for (int j = 0; j < 4; ++j) {
    q.col(j) = table.numbers(fmt::format("q{}_rad", j + 1));
    qd.col(j) = table.numbers(fmt::format("qd{}_rad_s", j + 1));
    qdd.col(j) = table.numbers(fmt::format("qdd{}_rad_s2", j + 1));
  }
  Eigen::VectorXd truth = pair.truth, found = pair.found;
  for (Eigen::Index k = 0; k < truth.size(); ++k) {
    const std::string& name = pair.robot->parameter_names()[static_cast<std::size_t>(k)];
    if (name.find("viscous") != std::string::npos || name.find("coulomb") != std::string::npos) truth(k) = found(k) = 0;
  }
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(4);
  const auto parts = [&](Eigen::Index row, const Eigen::VectorXd& p, Eigen::VectorXd& coriolis,
                         Eigen::VectorXd& acceleration) {
    Eigen::VectorXd gravity(4), moving(4), all(4);
    const Eigen::VectorXd at = q.row(row), rate = qd.row(row), growth = qdd.row(row);
    EXPECT_EQ(pair.robot->inverse_dynamics(at, still, still, p, gravity), Status::ok);
    EXPECT_EQ(pair.robot->inverse_dynamics(at, rate, still, p, moving), Status::ok);
    EXPECT_EQ(pair.robot->inverse_dynamics(at, rate, growth, p, all), Status::ok);
    coriolis = moving - gravity;
    acceleration = all - moving;
  };
  Eigen::Vector4d largest_c = Eigen::Vector4d::Zero(), largest_a = largest_c, error_c = largest_c, error_a = largest_c;
  for (Eigen::Index row = 0; row < q.rows(); ++row) {
    Eigen::VectorXd c, a, c_true, a_true;
    parts(row, found, c, a);
    parts(row, truth, c_true, a_true);
    largest_c = largest_c.cwiseMax(c_true.cwiseAbs());
    largest_a = largest_a.cwiseMax(a_true.cwiseAbs());
    error_c = error_c.cwiseMax((c - c_true).cwiseAbs());
    error_a = error_a.cwiseMax((a - a_true).cwiseAbs());
  }
  ASSERT_GT(q.rows(), 500);
  // The Coriolis torque of the telescope's drive is a few mN m, below the noise of any log: no relative error of its
  // own.
  figure("coriolis_torque_percent_of_largest", 100 * error_c.maxCoeff() / largest_c.maxCoeff(), 0.3);
  for (int j = 0; j < 4; ++j) {
    figure(fmt::format("acceleration_torque_percent_drive{}", j + 1), 100 * error_a(j) / largest_a(j), 0.3);
    std::cout << fmt::format("  drive {}: Coriolis torque up to {:.4g} N m, error up to {:.2g} N m ({:.2g} %)\n", j + 1,
                             largest_c(j), error_c(j), 100 * error_c(j) / largest_c(j));
  }
}

void check_positive_definite(const Pair& pair) {
  constexpr int kStates = 1000000, kParts = 4;
  std::atomic<int> bad{0};
  std::vector<std::thread> threads;
  for (int part = 0; part < kParts; ++part) {
    threads.emplace_back([&pair, &bad, part] {
      HalfBall poses(*pair.robot, 100 + static_cast<std::uint64_t>(part));
      Eigen::VectorXd q;
      Eigen::MatrixXd M(4, 4);
      for (int k = 0; k < kStates / kParts; ++k) {
        poses.next(q);
        const bool done = pair.robot->mass_matrix(q, pair.found, M) == Status::ok;
        if (!done || Eigen::LLT<Eigen::Matrix4d>(Eigen::Matrix4d(M)).info() != Eigen::Success) ++bad;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  figure("states_with_indefinite_mass_matrix_of_1000000", bad, 0);
}

// --- identification -----------------------------------------------------------------------------

class FromPrior : public ::testing::TestWithParam<double> {};

TEST_P(FromPrior, MeetsTheTargets) {
  const testing_support::TemporaryFolder folder;
  const ParameterTable truth = read_parameters(log("truth.csv"));
  write_parameters(folder.path("prior.csv"), scaled(truth, GetParam()));
  const Identified result(folder, {"--prior", folder.path("prior.csv")});

  EXPECT_EQ(result.summary.at("verdict"), "trusted");
  EXPECT_EQ(number(result.summary, "base_parameters"), 37);
  EXPECT_EQ(number(result.summary, "columns"), 70);
  figure("verification_rms_above_truth_percent", excess_residual(result), 2);

  for (const ParameterEntry& entry : truth.entries) {
    const bool viscous = entry.name.find(".viscous") != std::string::npos,
               coulomb = entry.name.find(".coulomb") != std::string::npos;
    if (!viscous && !coulomb) continue;
    const ParameterEntry* found = result.params.find(entry.name);
    ASSERT_NE(found, nullptr) << entry.name;
    if (entry.name.rfind("telescope", 0) == 0) {
      ASSERT_GT(found->std, 0);
      figure(entry.name + "_standard_deviations", std::abs(found->value - entry.value) / found->std, 1.96);
    } else {
      figure(entry.name + "_percent", 100 * std::abs(found->value / entry.value - 1), viscous ? 0.8 : 0.3);
    }
  }
  std::cout << "  solve time " << 1000 * number(result.summary, "solve_time_s") << " ms, fold "
            << 1000 * number(result.summary, "fold_time_s") << " ms (told, not judged: machines differ)\n";

  const CsvTable base = read_csv(result.path("base.csv"));
  EXPECT_EQ(base.rows(), 37U);
  const Pair pair(result.params);
  ASSERT_NO_FATAL_FAILURE(check_mass_matrix(pair));
  ASSERT_NO_FATAL_FAILURE(check_mass_matrix_by_energy(pair));
  ASSERT_NO_FATAL_FAILURE(check_torque_parts(pair, result.path("residuals.csv")));
  check_positive_definite(pair);
}

INSTANTIATE_TEST_SUITE_P(ThirtyPercent, FromPrior, ::testing::Values(0.7, 1.3),
                         [](const auto& one) { return one.param < 1 ? "Below" : "Above"; });

TEST(Identification, OtherPriorsAndMethodsPredictAsWell) {
  const testing_support::TemporaryFolder folder;
  succeed({"delta-model", "prior", installed(kRobot), "-o", folder.path("nominal.csv")});
  const std::pair<const char*, Words> variants[] = {
      {"nominal prior", {"--prior", folder.path("nominal.csv")}},
      {"no prior given", {}},
      {"full set", {"--prior", folder.path("nominal.csv"), "--parameters", "full"}},
      {"bregman metric", {"--prior", folder.path("nominal.csv"), "--metric", "bregman"}},
      {"riemannian metric", {"--prior", folder.path("nominal.csv"), "--metric", "riemannian"}},
      {"robust loss", {"--prior", folder.path("nominal.csv"), "--robust"}},
      {"individual limbs", {"--prior", folder.path("nominal.csv"), "--individual-limbs"}},
  };
  for (const auto& [name, flags] : variants) {
    SCOPED_TRACE(name);
    const Identified result(folder, flags + Words{"--cutoff-hz", "40"});
    EXPECT_EQ(number(result.summary, "columns"), std::string(name) == "individual limbs" ? 110 : 70);
    figure(std::string("verification_rms_above_truth_percent, ") + name, excess_residual(result, false), 2);
  }
}

TEST(Identification, AVeryShortLogGivesAConsistentModelThatIsNotTrusted) {
  const testing_support::TemporaryFolder folder;
  const std::string text = read_text(log("identification_fast.csv"));
  std::size_t end = 0;
  for (int line = 0; line < 700; ++line) end = text.find('\n', end) + 1;
  const std::string part = folder.write("short.csv", text.substr(0, end));
  const ToolResult result = run({"delta-identify", installed(kRobot), part, "--prior", log("truth.csv"), "--cutoff-hz",
                                 "50", "-o", folder.path("params.csv"), "--summary", folder.path("summary.csv")});
  ASSERT_TRUE(result.code == 0 || result.code == 5) << result.err;
  const auto summary = read_summary(folder.path("summary.csv"));
  EXPECT_NE(summary.at("verdict"), "trusted") << "0.7 s do not make a trusted model";
  EXPECT_GT(number(summary, "mass_matrix_min_eigenvalue"), 0);
}

TEST(Identification, ReportsAreWholePages) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const testing_support::TemporaryFolder folder;
  const std::string identification = folder.path("identification.html"), validation = folder.path("validation.html");
  succeed({"delta-identify", installed(kRobot), log("identification_fast.csv"), log("identification_slow.csv"),
           "--cutoff-hz", "40", "--prior", log("truth.csv"), "-o", folder.path("params.csv"), "--report",
           identification});
  succeed({"delta-validate", installed(kRobot), "--params", folder.path("params.csv"), log("verification.csv"),
           "--cutoff-hz", "40", "--report", validation});
  for (const std::string& file : {identification, validation}) {
    const std::string page = read_text(file);
    EXPECT_GT(page.size(), 20000U) << file;
    EXPECT_NE(page.find("<svg"), std::string::npos) << file << " has no plot";
    EXPECT_NE(page.rfind("</html>"), std::string::npos) << file << " is cut off";
    EXPECT_EQ(page.find("src=\"http"), std::string::npos) << file << " needs the network";
    EXPECT_EQ(page.find(">nan"), std::string::npos) << file << " shows a number that is none";
  }
  EXPECT_EQ(folder.files(), 3);
}

TEST(Identification, SameInputSameBytesWithAnyNumberOfThreads) {
  const testing_support::TemporaryFolder folder;
  const auto identify = [&](const std::string& threads, const std::string& name) {
    succeed({"delta-identify", installed(kRobot), log("identification_slow.csv"), "--prior", log("truth.csv"),
             "--cutoff-hz", "40", "--threads", threads, "-o", folder.path(name), "--base",
             folder.path("base_" + name)});
    return folder.read(name) + folder.read("base_" + name);
  };
  const std::string first = identify("1", "a.csv");
  EXPECT_EQ(identify("1", "b.csv"), first);
  EXPECT_EQ(identify("2", "c.csv"), first);
  const auto validate = [&](const std::string& threads, const std::string& name) {
    succeed({"delta-validate", installed(kRobot), log("identification_slow.csv"), "--params", log("truth.csv"),
             "--cutoff-hz", "40", "--threads", threads, "-o", folder.path(name)});
    return folder.read(name);
  };
  const std::string residuals = validate("1", "d.csv");
  EXPECT_EQ(validate("2", "e.csv"), residuals);
}

TEST(Identification, RigidStatesOfTheMuJoCoPlant) {
  const testing_support::TemporaryFolder folder;
  ParameterTable rigid = read_parameters(log("truth.csv"));
  for (ParameterEntry& entry : rigid.entries) {
    if (entry.name.find("viscous") != std::string::npos || entry.name.find("coulomb") != std::string::npos)
      entry.value = 0;
  }
  write_parameters(folder.path("rigid.csv"), rigid);
  succeed({"delta-validate", installed(kRobot), "--params", folder.path("rigid.csv"), log("rigid_states.csv"),
           "--no-filter", "--summary", folder.path("summary.csv")});
  const auto summary = read_summary(folder.path("summary.csv"));
  const CsvTable states = read_csv(log("rigid_states.csv"));
  EXPECT_EQ(number(summary, "samples"), static_cast<double>(states.rows()));
  for (int j = 1; j <= 4; ++j) {
    const double largest = states.numbers(fmt::format("tau{}_Nm", j)).cwiseAbs().maxCoeff();
    figure(fmt::format("rigid_states_percent_drive{}", j),
           100 * number(summary, fmt::format("max_residual_drive{}", j)) / largest, 0.02);
  }
}

// --- published robots, whose data may not travel with the product -------------------------------

/// The folder with the data, or empty after a message why the test is skipped.
std::string shared_data(const std::string& name) {
  const char* folder = std::getenv("DELTADYN_SHARED_DATA");
  if (folder == nullptr) return {};
  const std::string path = std::string(folder) + "/" + name;
  return fs::exists(path) ? path : std::string();
}

TEST(PublishedRobots, EmpsAsAnAxis) {
  const std::string data = shared_data("emps/identification.csv");
  if (data.empty()) GTEST_SKIP() << "DELTADYN_SHARED_DATA names no folder with emps/identification.csv";
  const testing_support::TemporaryFolder folder;
  const ToolResult result =
      succeed({"delta-identify", installed("robots/emps.urdf"), data, "-o", folder.path("params.csv")});
  const ParameterTable params = read_parameters(folder.path("params.csv"));
  for (const auto& [name, value] : {std::pair{"upper_arm.m", 95.11},
                                    {"drive1.viscous", 203.4},
                                    {"drive1.coulomb", 20.40},
                                    {"drive1.offset", -3.17}}) {
    const ParameterEntry* found = params.find(name);
    ASSERT_NE(found, nullptr) << name;
    std::cout << "  " << name << " " << found->value << " published " << value << "\n";
    figure(std::string("emps_") + name + "_percent", 100 * std::abs(found->value / value - 1), 0.2);
  }
}

TEST(PublishedRobots, TorqueOfTheAutonoxDelta) {
  const std::string data = shared_data("delta_rl5/trajectory1.csv");
  if (data.empty()) GTEST_SKIP() << "DELTADYN_SHARED_DATA names no folder with delta_rl5/trajectory1.csv";
  const testing_support::TemporaryFolder folder;
  succeed({"delta-validate", installed("robots/delta_rl5.urdf"), "--params", shared_data("delta_rl5/params.csv"), data,
           "--no-filter", "--summary", folder.path("summary.csv")});
  const auto summary = read_summary(folder.path("summary.csv"));
  EXPECT_EQ(number(summary, "samples"), static_cast<double>(read_csv(data).rows()));
  for (int j = 1; j <= 3; ++j)
    figure(fmt::format("delta_rl5_torque_Nm_drive{}", j), number(summary, fmt::format("max_residual_drive{}", j)),
           1e-9);
}

}  // namespace
}  // namespace deltadyn::acceptance
