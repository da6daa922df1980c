// A machine with everyday dirt gives a useful model with default flags: damped bristles in every drive, cogging, a
// filtered torque, lengths that are not quite those of the drawing.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "deltadyn/io/extra_rows.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "acceptance/tool_run.hpp"

namespace deltadyn::acceptance {
namespace {

constexpr int kPoses = 500;
// As the plant has them
constexpr double kTorqueNoise = 0.045, kTorqueStep = 0.02, kTorqueNoise4 = 0.0035, kTorqueStep4 = 0.002;
constexpr double kRate_hz = 500;

class DirtyMachine : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* shared = std::getenv("DELTADYN_SHARED_DATA");
    data_ = shared == nullptr ? "" : std::string(shared) + "/mujoco_dirty/";
    if (data_.empty() || !fs::exists(data_ + "nothing_hidden/fast.csv"))
      GTEST_SKIP() << "DELTADYN_SHARED_DATA names no folder with mujoco_dirty";
    succeed({"delta-model", "create", "delta4", "--base-radius", "0.16", "--platform-radius", "0.045", "--upper-arm",
             "0.30", "--strut", "0.72", "--strut-spacing", "0.09", "-o", path("robot.urdf")});
    succeed({"delta-identify", path("robot.urdf"), data_ + "nothing_hidden/fast.csv", data_ + "nothing_hidden/slow.csv",
             "-o", path("params.csv"), "--summary", path("summary.csv")});
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_.path(name); }

  std::string data_;
  testing_support::TemporaryFolder folder_;
};

void check_friction(const ParameterTable& found, const ParameterTable& truth) {
  const auto error = [&](const std::string& name) {
    return 100 * std::abs(found.find(name)->value / truth.find(name)->value - 1);
  };
  double coulomb = 0, viscous = 0;
  for (const std::string joint : {"drive1", "drive2", "drive3", "drive4", "telescope"}) {
    coulomb = std::max(coulomb, error(joint + ".coulomb"));
    viscous = std::max(viscous, error(joint + ".viscous"));
  }
  figure("coulomb_percent", coulomb, 2);
  figure("viscous_percent", viscous, 4);
}

void check_mass_matrix(const Robot& robot, const Eigen::VectorXd& found, const Eigen::VectorXd& truth) {
  WorkspaceSampler poses(robot, 5);
  Eigen::VectorXd q;
  Eigen::MatrixXd M(4, 4), T(4, 4), error = Eigen::MatrixXd::Zero(4, 4), size = error;
  for (int k = 0; k < kPoses; ++k) {
    poses.next(q);
    ASSERT_EQ(robot.mass_matrix(q, found, M), Status::ok);
    ASSERT_EQ(robot.mass_matrix(q, truth, T), Status::ok);
    error += (M - T).cwiseAbs();
    size += T.cwiseAbs();
  }
  figure("mass_matrix_diagonal_percent", 100 * error.diagonal().cwiseQuotient(size.diagonal()).maxCoeff(), 0.5);
  double off = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < i; ++j) off = std::max(off, error(i, j) / size(i, j));
  }
  figure("mass_matrix_off_diagonal_percent", 100 * off, 1);
}

TEST_F(DirtyMachine, GivesAUsefulModel) {
  const auto robot = make_robot(read_robot_file(path("robot.urdf")));
  const ParameterTable table = read_parameters(path("params.csv")), truth = read_parameters(data_ + "truth.csv");
  check_friction(table, truth);
  check_mass_matrix(*robot, values(table, robot->parameter_names()), values(truth, robot->parameter_names()));
  // Cogging of 31 waves a turn in the limbs' drives, 9 in the fourth one.
  const std::vector<Ripple> ripples = ripples_of(table, robot->description());
  for (int drive = 0; drive < 4; ++drive) {
    const auto found =
        std::find_if(ripples.begin(), ripples.end(), [drive](const Ripple& r) { return r.drive == drive; });
    ASSERT_NE(found, ripples.end()) << drive;
    EXPECT_NEAR(found->n, drive < 3 ? 31 : 9, drive < 3 ? 0.6 : 0.05) << drive;
  }
}

/// The low pass of 0.5 ms shows beside the bristles only. Who reads the check's own keys has it, too.
TEST_F(DirtyMachine, TheKeysOfTheCheckHoldTheFineDelay) {
  const auto summary = read_summary(path("summary.csv"));
  EXPECT_NE(number(summary, "check_fine_delay"), 0);
  EXPECT_EQ(number(summary, "check_delay"), number(summary, "check_fine_delay"));
  EXPECT_EQ(number(summary, "check_delay_std"), number(summary, "check_fine_delay_std"));
  EXPECT_EQ(summary.at("check_verdict"), "mended");
}

/// On a motion that took no part, rows near reversals with it, little is left but the noise of the torque behind the
/// low pass.
TEST_F(DirtyMachine, PredictsAnotherMotion) {
  succeed({"delta-validate", path("robot.urdf"), "--params", path("params.csv"), data_ + "nothing_hidden/holdout.csv",
           "--summary", path("validation.csv")});
  const auto summary = read_summary(path("validation.csv"));
  const double pass_hz = 1.25 * number(summary, "cutoff_hz");
  for (int drive = 1; drive <= 4; ++drive) {
    const double noise = drive < 4 ? kTorqueNoise : kTorqueNoise4, step = drive < 4 ? kTorqueStep : kTorqueStep4;
    const double floor = std::sqrt((noise * noise + step * step / 12) * 2 * pass_hz / kRate_hz);
    figure(fmt::format("residual_over_floor_drive{}", drive),
           number(summary, fmt::format("rms_with_reversals_drive{}", drive)) / floor, 1.3);
  }
}

}  // namespace
}  // namespace deltadyn::acceptance
