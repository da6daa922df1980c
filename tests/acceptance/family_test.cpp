// Robots with four limbs through the installed tools: from lengths to an identified model and its exports.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/io/trajectory_file.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "acceptance/tool_run.hpp"
#include "identification/synthetic_log.hpp"

namespace deltadyn::acceptance {
namespace {

using ::testing::HasSubstr;

/// Over the workspace, as figures with their targets.
void compare_mass_matrices(const Robot& robot, const Eigen::VectorXd& found, const Eigen::VectorXd& truth) {
  const int n = robot.drives();
  WorkspaceSampler sampler(robot);
  Eigen::VectorXd q(n);
  Eigen::MatrixXd M(n, n), T(n, n);
  double diagonal = 0, beside = 0;
  for (int pose = 0; pose < 2000; ++pose) {
    sampler.next(q);
    ASSERT_EQ(robot.mass_matrix(q, found, M), Status::ok);
    ASSERT_EQ(robot.mass_matrix(q, truth, T), Status::ok);
    ASSERT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(M).eigenvalues()(0), 0);
    const Eigen::MatrixXd error = (M - T).cwiseAbs();
    diagonal = std::max(diagonal, (error.diagonal().array() / T.diagonal().array()).maxCoeff());
    beside = std::max(beside, error.maxCoeff() / T.diagonal().mean());
  }
  figure("mass_matrix_diagonal_percent", 100 * diagonal, 0.2);
  figure("mass_matrix_rest_percent_of_mean", 100 * beside, 0.5);
}

struct Member {
  const char* name;
  Words create;  ///< behind `delta-model create`
};
std::ostream& operator<<(std::ostream& out, const Member& member) {
  return out << member.name;
}

/// A member of the family in a folder of its own: robot file, prior, and a truth that differs from it.
class FamilyMember : public ::testing::TestWithParam<Member> {
 protected:
  void SetUp() override {
    succeed(Words{"delta-model", "create"} + GetParam().create + Words{"-o", path("robot.urdf")});
    succeed({"delta-model", "prior", path("robot.urdf"), "-o", path("prior.csv")});
    robot_ = make_robot(read_robot_file(path("robot.urdf")));
    truth_ = testing_support::delta_truth(*robot_);
    ParameterTable table;
    for (int k = 0; k < robot_->parameters(); ++k) {
      const auto i = static_cast<std::size_t>(k);
      const bool rails = robot_->description().drive_kind == DriveKind::prismatic;
      if (rails && robot_->parameter_names()[i].rfind("drive", 0) == 0) truth_(k) *= 3;  // N, not N m
      table.entries.push_back({robot_->parameter_names()[i], truth_(k), robot_->parameter_units()[i]});
    }
    write_parameters(path("truth.csv"), table);
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_.path(name); }

  /// A motion, and the log that the robot makes of it.
  void record(const std::string& log, double frequency_hz, std::uint64_t seed, const Words& flags = {}) const {
    testing_support::SyntheticOptions options;
    options.duration_s = 10;
    options.base_frequency_hz = frequency_hz;
    options.seed = seed;
    const Log motion = testing_support::synthetic_log(*robot_, truth_, options);
    TrajectorySamples samples;
    samples.t_s = motion.t_s;
    samples.q = motion.q;
    samples.qd = motion.qd;
    samples.qdd = motion.qdd;
    complete_task(*robot_, samples);
    write_trajectory(path("motion.csv"), samples, robot_->description());
    succeed(Words{"delta-simulate", path("robot.urdf"), "--params", path("truth.csv"), "--trajectory",
                  path("motion.csv"), "-o", path(log), "--seed", std::to_string(seed)} +
            noise() + flags);
  }
  [[nodiscard]] Words noise() const {
    if (robot_->description().drive_kind == DriveKind::prismatic)
      return {"--torque-noise-n-m", "0.04", "--encoder-step-m", "1e-7"};
    return {"--torque-noise-n-m", "0.02", "--encoder-bits", "22"};
  }

  [[nodiscard]] Words identify() const {
    return {
        "delta-identify",   path("robot.urdf"), path("slow.csv"), path("fast.csv"), "--prior", path("prior.csv"), "-o",
        path("params.csv"), "--summary",        path("id.csv")};
  }

  const testing_support::TemporaryFolder folder_;
  std::unique_ptr<Robot> robot_;
  Eigen::VectorXd truth_;
};

TEST_P(FamilyMember, IsIdentifiedAndPredictsAnotherMotion) {
  record("slow.csv", 0.12, 3);
  record("fast.csv", 0.5, 4);
  record("holdout.csv", 0.4, 5);
  succeed(identify());
  succeed({"delta-validate", path("robot.urdf"), "--params", path("params.csv"), path("holdout.csv"), "-o",
           path("residuals.csv"), "--summary", path("val.csv")});

  const Eigen::VectorXd found =
      values(read_parameters(path("params.csv")), robot_->parameter_names(), robot_->parameter_units());
  double friction = 0;
  for (int k = 0; k < robot_->parameters(); ++k) {
    const ParameterId& id = robot_->parameter_ids()[static_cast<std::size_t>(k)];
    if (id.is_friction() && id.number > 0) friction = std::max(friction, std::abs(found(k) / truth_(k) - 1));
  }
  figure("drive_friction_percent", 100 * friction, 0.5);
  compare_mass_matrices(*robot_, found, truth_);

  for (const char* target : {"urdf", "mjcf", "header"})
    succeed({"delta-model", "convert", path("robot.urdf"), "--params", path("params.csv"), "--to", target, "-o",
             path(std::string("model.") + target)});
}

INSTANTIATE_TEST_SUITE_P(
    Types, FamilyMember,
    ::testing::Values(
        Member{"H4",
               {"h4", "--base-radius", "0.2", "--platform-radius", "0.08", "--upper-arm", "0.3", "--strut", "0.65",
                "--plate-spacing", "0.12"}},
        Member{"I4",
               {"i4", "--base-radius", "0.2", "--platform-radius", "0.08", "--upper-arm", "0.3", "--strut", "0.65",
                "--pinion-radius", "0.03"}},
        Member{"Par4",
               {"par4", "--base-radius", "0.2", "--platform-radius", "0.09", "--upper-arm", "0.3", "--strut", "0.65",
                "--plate-spacing", "0.127", "--plate-bar-spacing", "0.06", "--tool-on", "half_plate"}},
        Member{"LinearH4",
               {"h4", "--drive-kind", "prismatic", "--base-radius", "0.4", "--platform-radius", "0.08", "--strut",
                "0.65", "--plate-spacing", "0.12"}},
        Member{"LinearPar4",
               {"par4", "--drive-kind", "prismatic", "--base-radius", "0.4", "--platform-radius", "0.08", "--strut",
                "0.65", "--plate-spacing", "0.12", "--plate-bar-spacing", "0.06"}},
        Member{"TiltedDelta3",
               {"delta3", "--base-radius", "0.2", "--platform-radius", "0.06", "--upper-arm", "0.3", "--strut", "0.65",
                "--limb-azimuth-rad", "0.2,2.0,4.5", "--limb-tilt-rad", "0.4,-0.3,0.2"}},
        Member{"InclinedRails",
               {"linear-delta3", "--base-radius", "0.45", "--platform-radius", "0.04", "--strut", "0.35",
                "--rail-axis-limb=-0.7071067811865476,0,-0.7071067811865476", "--drive-range-m", "0.1,0.5"}}),
    [](const auto& one) { return std::string(one.param.name); });

// Of a light plate that turns fast the encoders' noise reaches every acceleration of a wide band: where the instruments
// let through as much of it as the rows, the inertia that turns comes out several per cent too small.
TEST(LightPar4, IsIdentifiedFromThePlannedMotion) {
  const testing_support::TemporaryFolder folder;
  const std::string robot_file = installed("robots/par4_quattro_like.urdf"), prior = folder.path("prior.csv");
  succeed({"delta-model", "prior", robot_file, "-o", prior});
  succeed({"delta-excite", robot_file, "--params", prior, "--segments", "2", "--segment-speeds", "0.3,1",
           "--segment-files", "--yaw-velocity-rad-s", "12", "--yaw-acceleration-rad-s2", "120", "--time-limit-s", "6",
           "-o", folder.path("plan.csv")});
  ParameterTable table = read_parameters(prior);
  for (ParameterEntry& entry : table.entries) entry.value *= entry.name.rfind("strut", 0) == 0 ? 0.8 : 1.2;
  write_parameters(folder.path("truth.csv"), table);
  Words identify = {"delta-identify", robot_file, "--prior", prior, "-o", folder.path("params.csv")};
  for (const char* segment : {"1", "2"}) {
    const std::string log = folder.path(std::string("log") + segment + ".csv");
    succeed({"delta-simulate", robot_file, "--params", folder.path("truth.csv"), "--trajectory",
             folder.path(std::string("plan_") + segment + ".csv"), "-o", log, "--seed", segment, "--torque-noise-n-m",
             "0.02", "--encoder-bits", "21"});
    identify.push_back(log);
  }
  succeed(identify);
  const auto robot = make_robot(read_robot_file(robot_file));
  compare_mass_matrices(*robot, values(read_parameters(folder.path("params.csv")), robot->parameter_names()),
                        values(table, robot->parameter_names()));
}

// --- what is refused ----------------------------------------------------------------------------

struct Wrong {
  const char* name;
  Words create;
  const char* says;
};
std::ostream& operator<<(std::ostream& out, const Wrong& wrong) {
  return out << wrong.name;
}

class WrongFamily : public ::testing::TestWithParam<Wrong> {};

TEST_P(WrongFamily, IsRefusedWithTheRule) {
  const testing_support::TemporaryFolder folder;
  const ToolResult result =
      run(Words{"delta-model", "create"} + GetParam().create + Words{"-o", folder.path("robot.urdf")});
  EXPECT_EQ(result.code, 2) << result.out;
  EXPECT_THAT(result.err, HasSubstr(GetParam().says));
  EXPECT_THAT(result.err, HasSubstr("mend:"));
  EXPECT_FALSE(fs::exists(folder.path("robot.urdf")));
}

const Words kH4{"h4",  "--base-radius", "0.2",  "--platform-radius", "0.08", "--upper-arm",
                "0.3", "--strut",       "0.65", "--plate-spacing"};
const Words kPar4{"par4", "--base-radius", "0.2",  "--platform-radius", "0.08", "--upper-arm",
                  "0.3",  "--strut",       "0.65", "--plate-spacing",   "0.12", "--plate-bar-spacing"};

INSTANTIATE_TEST_SUITE_P(
    Flags, WrongFamily,
    ::testing::Values(
        Wrong{"NoSpacing",
              {"h4", "--base-radius", "0.2", "--platform-radius", "0.08", "--upper-arm", "0.3", "--strut", "0.65"},
              "--plate-spacing is needed"},
        Wrong{"SpacingOfZero", kH4 + Words{"0"}, "must be positive"},
        Wrong{"SpacingInMillimetres", kH4 + Words{"120"}, "120"},
        Wrong{"PinionOfAnH4", kH4 + Words{"0.12", "--pinion-radius", "0.03"},
              "--pinion-radius does not belong to an h4"},
        Wrong{"RatioOfZero", kPar4 + Words{"0.06", "--tool-ratio", "0"}, "ratio of the tool's gear is 0"},
        Wrong{"RangeThatCollides", kPar4 + Words{"0.06", "--plate-range-rad", "1.57"},
              "the parts of the plate collide"},
        Wrong{"PlateTurnedAside", kH4 + Words{"0.12", "--plate-azimuth-rad", "0"}, "do not hold the plate's turn"},
        Wrong{"AllLimbsOneWay", kH4 + Words{"0.12", "--limb-azimuth-rad", "1,1,2,4"}, "could turn"},
        Wrong{"LimbsOnOneSide", kPar4 + Words{"0.06", "--limb-azimuth-rad", "0.2,0.6,1,1.4"},
              "all limbs stand on one side"},
        Wrong{"OneAzimuth", kH4 + Words{"0.12", "--limb-azimuth-rad", "0.7"}, "give 4, one a limb"},
        Wrong{"RangeOfNothing", kH4 + Words{"0.12", "--plate-range-rad", "1e-9"}, "by a milliradian at least"},
        Wrong{"FiveLimbs", kH4 + Words{"0.12", "--limb-azimuth-rad", "0,1,2,3,4"}, "--limb-azimuth-rad has 5"},
        Wrong{"ToolOnTheLeft", kPar4 + Words{"0.06", "--tool-on", "left"}, "--tool-on left is not known"},
        Wrong{"AttachmentsOfTheOtherHalf",
              {"i4", "--base-radius", "0.2", "--upper-arm", "0.3", "--strut", "0.65", "--pinion-radius", "0.03",
               "--attachments-m", "0.05,-0.05,0;-0.05,-0.05,0;-0.05,0.05,0;0.05,0.05,0"},
              "attachments on half plate 1 lie on the side of the other half"},
        Wrong{"RailsOutwards",
              {"linear-delta3", "--base-radius", "0.3", "--platform-radius", "0.06", "--strut", "0.8",
               "--rail-axis-limb", "1,0,0", "--drive-range-m=-0.2,0.2"},
              "give --elbow below"},
        Wrong{"RangeWithoutAPose",
              {"delta3", "--base-radius", "0.2", "--platform-radius", "0.08", "--upper-arm", "0.25", "--strut", "0.6",
               "--drive-range-rad=-1.6,-1.5"},
              "widen --drive-range-rad"},
        Wrong{"ArmOfACarriage", kH4 + Words{"0.12", "--drive-kind", "prismatic"},
              "--upper-arm belongs to revolute drives"}),
    [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace deltadyn::acceptance
