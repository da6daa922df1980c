// Long studies; ctest runs a seeded sample of them. The whole:
//   DELTADYN_EXCITATION_SEEDS=100 test_excitation --gtest_filter='*Study*'

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gmock/gmock.h>
#include <random>

#include "deltadyn/excitation/optimize.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/trajectory/motion_plan.hpp"

#include "excitation/excitation_setup.hpp"

namespace deltadyn {
namespace {

using testing_support::usual_limits;

int seeds(int usual) {
  const char* text = std::getenv("DELTADYN_EXCITATION_SEEDS");
  return text == nullptr ? usual : std::max(1, std::atoi(text));
}

std::string data(const std::string& name) {
  return std::string(DELTADYN_SOURCE_DIR) + "/data/" + name;
}

/// The limits of the robot file, and usual ones where it has none.
MotionLimits file_limits(const Robot& robot) {
  const RobotDescription& description = robot.description();
  MotionLimits limits = usual_limits(robot);
  for (int i = 0; i < description.drives(); ++i) {
    const DriveLimits& own = description.limits[static_cast<std::size_t>(i)];
    if (std::isfinite(own.lower)) limits.q_lower(i) = own.lower;
    if (std::isfinite(own.upper)) limits.q_upper(i) = own.upper;
    if (std::isfinite(own.velocity)) limits.qd(i) = own.velocity;
    if (std::isfinite(own.acceleration)) limits.qdd(i) = own.acceleration;
  }
  return limits;
}

class LimitStudy : public ::testing::TestWithParam<const char*> {};

// On a grid ten times finer than the output no limit is exceeded by more than 1e-9, run-in and run-out included.
TEST_P(LimitStudy, NoLimitIsExceededBetweenTheSamples) {
  constexpr double kRate = 1000;
  const auto robot = make_robot(read_robot_file(data("robots/") + GetParam()));
  const MotionLimits limits = file_limits(*robot);
  const std::vector<int> base = find_base_parameters(*robot).independent;
  const int n = robot->drives();
  double tightest = 1;
  for (int seed = 1; seed <= seeds(2); ++seed) {
    const DesignSpace space = make_design_space(*robot, limits, base, Eigen::VectorXd::Constant(n, 20), 300,
                                                static_cast<std::uint64_t>(seed));
    ExcitationOptions options;
    options.harmonics = 3;
    options.starts = 1;
    options.seed = static_cast<std::uint64_t>(seed);
    options.time_limit_s = 250;
    const Excitation found = optimize_excitation(space, limits, design_bound(space), options);
    const std::vector<PlanSegment> segments = {{found.segments[0].series, limits, 1}};
    const MotionPlan plan = make_plan(*robot, segments, kRate, false);
    const auto list = limits.list(robot->description());
    LimitedState state;
    state.x.resize(3 * n);
    state.drives.resize(3 * n);
    Eigen::VectorXd q(n), qd(n), qdd(n);
    double load = 0;
    const auto count = static_cast<long>(std::lround(plan.duration_s * kRate * 10));
    for (long i = 0; i <= count; ++i) {
      const TaskState task = plan.at(static_cast<double>(i) / (10 * kRate));
      ASSERT_EQ(robot->to_drives(task, q, qd, qdd), Status::ok);
      state.x << task.z, task.zd, task.zdd;
      state.drives << q, qd, qdd;
      for (const Limit& limit : list) {
        const double at = limit_load(limit, usage_of(limit, limited_value(limit, limits, state)));
        ASSERT_LE(at, 1 + 1e-9) << limit.name << ", seed " << seed << ", sample " << i;
        load = std::max(load, at);
      }
    }
    EXPECT_GT(load, 0.99) << "the limits are used";
    tightest = std::min(tightest, 1 - load);
  }
  RecordProperty("tightest_margin", std::to_string(tightest));
}

INSTANTIATE_TEST_SUITE_P(Robots, LimitStudy,
                         ::testing::Values("mujoco_delta4.urdf", "irb360_6_1600.urdf", "delta3.urdf", "delta_rl5.urdf",
                                           "linear_delta3.urdf", "emps.urdf"),
                         [](const auto& robot) {
                           return std::string(robot.param).substr(0, std::string(robot.param).find('.'));
                         });

/// Least squares on a simulated log of the samples: mean over the base parameters of the standard deviation that the
/// residual gives them, as a share of the true value where that is not zero.
double mean_relative_std(const Robot& robot, const BaseParameters& base, const Eigen::VectorXd& truth,
                         const TrajectorySamples& samples, const Eigen::VectorXd& noise, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  NormalDistribution normal;
  const Eigen::Index n = robot.drives(), p = base.count(), rows = n * samples.samples();
  Eigen::MatrixXd A(rows, p), Y(n, robot.parameters());
  Eigen::VectorXd b(rows), tau(n);
  for (Eigen::Index i = 0; i < samples.samples(); ++i) {
    const Eigen::VectorXd q = samples.q.row(i).transpose(), qd = samples.qd.row(i).transpose(),
                          qdd = samples.qdd.row(i).transpose();
    EXPECT_EQ(robot.regressor(q, qd, qdd, Y), Status::ok);
    EXPECT_EQ(robot.inverse_dynamics(q, qd, qdd, truth, tau), Status::ok);
    for (Eigen::Index drive = 0; drive < n; ++drive) {
      b(n * i + drive) = (tau(drive) + noise(drive) * normal(random)) / noise(drive);
      for (Eigen::Index k = 0; k < p; ++k)
        A(n * i + drive, k) = Y(drive, base.independent[static_cast<std::size_t>(k)]) / noise(drive);
    }
  }
  const Eigen::VectorXd scale = A.colwise().norm();
  A.array().rowwise() /= scale.transpose().array();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A);
  const Eigen::VectorXd beta = qr.solve(b);
  const double variance = (A * beta - b).squaredNorm() / static_cast<double>(rows - p);
  EXPECT_NEAR(variance, 1, 0.1);
  const Eigen::MatrixXd R = qr.matrixQR().topRows(p).triangularView<Eigen::Upper>();
  const Eigen::MatrixXd inverse = R.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(p, p));
  const Eigen::VectorXd std = (variance * inverse.rowwise().squaredNorm()).cwiseSqrt().cwiseQuotient(scale);
  const Eigen::VectorXd values = (base.B * truth).cwiseAbs();
  double sum = 0;
  int count = 0;
  for (Eigen::Index k = 0; k < p; ++k) {
    if (!(values(k) > 1e-9)) continue;  // a value of zero, of a symmetric part, has no relative deviation
    sum += std(k) / values(k);
    ++count;
  }
  EXPECT_GT(count, 20);
  return sum / count;
}

// At equal length and noise the optimised motion halves, at least, the mean relative standard deviation of a random
// one.
TEST(IdentificationStudy, OptimisedMotionHalvesTheStandardDeviation) {
  constexpr double kRate = 200, kDuration = 10;
  const auto robot = make_robot(read_robot_file(data("robots/mujoco_delta4.urdf")));
  const Eigen::VectorXd truth = values(read_parameters(data("logs/mujoco_delta4/truth.csv")), robot->parameter_names());
  const BaseParameters base = find_base_parameters(*robot);
  const MotionLimits limits = usual_limits(*robot);
  const Eigen::Vector4d scale(60, 60, 60, 4), noise(0.10, 0.10, 0.10, 0.012);
  const DesignSpace space = make_design_space(*robot, limits, base.independent, scale, 1000, 1);
  ExcitationOptions options;
  options.starts = std::min(20, seeds(3));
  options.time_limit_s = 250;
  const auto samples_of = [&](const FourierSeries& series) {
    TrajectorySamples samples;
    const auto count = static_cast<Eigen::Index>(kRate * kDuration);
    samples.t_s = Eigen::VectorXd::LinSpaced(count, 0, kDuration - 1 / kRate);
    const Eigen::VectorXd phases = series.omega() * samples.t_s;
    samples.z = series.at_phases(phases, 0);
    samples.zd = series.at_phases(phases, 1);
    samples.zdd = series.at_phases(phases, 2);
    complete_drives(*robot, samples);
    return samples;
  };
  const Excitation found = optimize_excitation(space, limits, design_bound(space), options);
  const double optimised = mean_relative_std(*robot, base, truth, samples_of(found.segments[0].series), noise, 1);
  std::vector<double> random;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const FourierSeries series = random_feasible_series(space, limits, options, seed);
    random.push_back(mean_relative_std(*robot, base, truth, samples_of(series), noise, seed));
  }
  std::nth_element(random.begin(), random.begin() + 10, random.end());
  RecordProperty("ratio_to_median", std::to_string(optimised / random[10]));
  EXPECT_LT(optimised, 0.5 * random[10]);
}

}  // namespace
}  // namespace deltadyn
