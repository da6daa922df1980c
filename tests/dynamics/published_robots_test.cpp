// Two robots whose torques somebody else computed: an industrial Delta with a published model, and a
// simulation with closed loops.

#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "support/descriptions.hpp"
#include "support/matchers.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

/// Autonox RL5-1450-6kg after its authors' open repository, testbedCIIRC/delta-robot-public.
RobotDescription published_delta() {
  RobotDescription robot = delta_description("delta3", {0.330, 0.125, 0.420, 1.055, 0.1});
  robot.gravity = Vector3<double>(0, 0, -9.80665);
  return robot;
}

/// Masses and inertias of that robot; all others are zero.
Eigen::VectorXd published_parameters(const Robot& robot) {
  ParameterTable table;
  table.entries = {{"upper_arm.m", 3.922, "kg"},           {"upper_arm.mcx", 0.87108, "kg*m"},
                   {"upper_arm.Iyy", 0.8833662, "kg*m^2"}, {"strut.m", 0.525, "kg"},
                   {"strut.mcx", 0.184625, "kg*m"},        {"strut.Iyy", 0.194779375, "kg*m^2"},
                   {"strut.Izz", 0.194779375, "kg*m^2"},   {"platform.m", 3.594, "kg"}};
  return values(table, robot.parameter_names(), robot.parameter_units());
}

struct Row {
  Vector3<double> q, qd, qdd, tau;
};

// Ten rows of the repository's first trajectory, torques from the authors' own program.
const Row kRows[] = {
    {{0.0923972374293, 0.0923692961136, 0.0923759973315},
     {0, 0, 0},
     {0, 0, 0},
     {-18.1559155485, -18.156266717, -18.1561824966}},
    {{0.340953856807, 0.151128300616, -0.00995355095533},
     {0.838640455999, 0.235793518717, -0.160994735212},
     {0.367435926588, 0.297108721076, 0.938935606173},
     {-14.7945020003, -18.3525712572, -19.1200263418}},
    {{0.799238275755, 0.308651426104, 0.0141072515475},
     {0.341152492856, 0.14134758719, 0.0795177187817},
     {-3.05005966515, -1.22197950733, -0.643807258496},
     {-14.2182115356, -19.9075619633, -23.2499733483}},
    {{0.688693659356, -0.0657243219383, 0.281885418131},
     {-0.992668086211, -1.25076381008, 1.00344119767},
     {-3.23552495003, 3.44403287651, -1.30797322315},
     {-18.0027583463, -15.5720523695, -21.5533910665}},
    {{-0.0587600936343, -0.123178085298, 0.616289331742},
     {-0.211441693689, 0.190914924031, 0.0542994186986},
     {6.67683455537, -5.83437984134, -1.72029468946},
     {-5.98024122263, -32.2465905271, -13.5818157435}},
    {{0.0249634257625, 0.243506887766, 0.0935058581036},
     {0.408301138904, 0.483426982931, -1.50789260988},
     {2.3675534608, -2.13171474482, -1.87196668834},
     {-14.6391867991, -21.5217958663, -21.8517024562}},
    {{0.400752484163, 0.443321962801, -0.567573013643},
     {-0.471251636446, -0.314617141007, 0.100944135153},
     {-12.5767656905, -8.52924663724, 2.94230924998},
     {-34.4561027799, -24.8206788894, -12.0872945871}},
    {{0.0617716061117, -0.322913375118, 0.25773292894},
     {1.31128067827, -0.903862691809, 2.0160227267},
     {6.61136166569, 4.21771323221, -0.829426967698},
     {-6.42807197037, -16.2120155053, -17.960966411}},
    {{0.49449156409, -0.419252349089, 0.666961990316},
     {-0.200342887018, -0.0130807667758, -0.414212961511},
     {-1.65570710546, -0.00326141015088, -3.327713009},
     {-15.0465476422, -22.9945623036, -15.9044739961}},
    {{0.208478768497, -0.269847986538, 0.217573029471},
     {-0.555077752778, 0.786095880181, -0.63191783075},
     {0.582508063341, 2.48424589642, 1.27642113721},
     {-15.885656151, -17.0818126697, -14.2224854248}},
};

TEST(PublishedDelta, HasItsAuthorsTorques) {
  const auto robot = make_robot(published_delta());
  const Eigen::VectorXd p = published_parameters(*robot);
  for (const Row& row : kRows) {
    Eigen::VectorXd tau(3);
    ASSERT_EQ(robot->inverse_dynamics(row.q, row.qd, row.qdd, p, tau), Status::ok);
    EXPECT_THAT(tau, IsNear(row.tau, 1e-9));
  }
}

/// Columns stem1suffix, stem2suffix, ... of a table.
Eigen::MatrixXd channels(const CsvTable& table, const std::string& stem, const std::string& suffix, int count) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(table.rows()), count);
  for (int k = 0; k < count; ++k) out.col(k) = table.numbers(stem + std::to_string(k + 1) + suffix);
  return out;
}

/// Largest difference between model and table, drive by drive.
Eigen::VectorXd largest_error(const Robot& robot, const Eigen::VectorXd& p, const CsvTable& table) {
  const int n = robot.drives();
  const Eigen::MatrixXd q = channels(table, "q", "_rad", n), qd = channels(table, "qd", "_rad_s", n),
                        qdd = channels(table, "qdd", "_rad_s2", n), tau = channels(table, "tau", "_Nm", n);
  Eigen::VectorXd worst = Eigen::VectorXd::Zero(n), model(n);
  for (Eigen::Index k = 0; k < q.rows(); ++k) {
    const Status status =
        robot.inverse_dynamics(q.row(k).transpose(), qd.row(k).transpose(), qdd.row(k).transpose(), p, model);
    EXPECT_EQ(status, Status::ok) << "row " << k;
    worst = worst.cwiseMax((model - tau.row(k).transpose()).cwiseAbs());
  }
  return worst;
}

TEST(PublishedDelta, HasItsAuthorsTorquesInEveryRow) {
  const char* folder = std::getenv("DELTADYN_SHARED_DATA");  // NOLINT(concurrency-mt-unsafe)
  if (folder == nullptr)
    GTEST_SKIP() << "set DELTADYN_SHARED_DATA to the folder that holds delta_rl5/ to test every row";
  const std::filesystem::path data = std::filesystem::path(folder) / "delta_rl5";
  const auto robot = make_robot(published_delta());
  const Eigen::VectorXd p =
      values(read_parameters((data / "params.csv").string()), robot->parameter_names(), robot->parameter_units());
  EXPECT_EQ(p, published_parameters(*robot));
  const CsvTable table = read_csv((data / "trajectory1.csv").string());
  EXPECT_THAT(largest_error(*robot, p, table), IsNear(Eigen::VectorXd::Zero(3).eval(), 1e-9));
}

// MuJoCo closes the loops by slightly soft constraints, which is what the tolerance is for.
TEST(SimulatedDelta4, HasTheTorquesOfMujoco) {
  const std::filesystem::path data = std::filesystem::path(DELTADYN_SOURCE_DIR) / "data/logs/mujoco_delta4";
  const auto robot = make_robot(delta_description("delta4"));
  ParameterTable truth = read_parameters((data / "truth.csv").string());
  for (ParameterEntry& entry : truth.entries) {
    const bool friction =
        entry.name.find(".viscous") != std::string::npos || entry.name.find(".coulomb") != std::string::npos;
    if (friction) entry.value = 0;  // the states were computed without friction
  }
  const Eigen::VectorXd p = values(truth, robot->parameter_names(), robot->parameter_units());
  const CsvTable table = read_csv((data / "rigid_states.csv").string());
  const Eigen::VectorXd largest = channels(table, "tau", "_Nm", 4).cwiseAbs().colwise().maxCoeff();
  const Eigen::VectorXd error = largest_error(*robot, p, table).cwiseQuotient(largest);
  EXPECT_LT(error.maxCoeff(), 2e-4) << "largest error of each drive, relative:\n" << error;
}

}  // namespace
}  // namespace deltadyn
