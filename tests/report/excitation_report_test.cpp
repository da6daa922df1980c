#include "deltadyn/report/excitation_report.hpp"

#include <gmock/gmock.h>

#include "deltadyn/excitation/predicted_uncertainty.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"

#include "excitation/excitation_setup.hpp"
#include "report/xml_checks.hpp"

namespace deltadyn {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing_support::excitation_setup;
using testing_support::ExcitationSetup;

/// A short search, planned and sampled, as the tool does it.
struct Planned {
  explicit Planned(const std::string& type, std::vector<double> speeds) : setup(excitation_setup(type, 300)) {
    bound = design_bound(setup.space);
    base = find_base_parameters(*setup.robot);
    ExcitationOptions options;
    options.harmonics = 2;
    options.starts = 1;
    options.speeds = std::move(speeds);
    options.time_limit_s = 200;
    excitation = optimize_excitation(setup.space, *setup.limits, bound, options);
    for (const auto& segment : excitation.segments) segments.push_back({segment.series, segment.limits, 2});
    plan = make_plan(*setup.robot, segments, 200, false);
    check = check_plan(*setup.robot, segments, plan);
    samples = sample_plan(*setup.robot, plan, 200);
  }
  [[nodiscard]] ExcitationReportInput input(double noise) const {
    ExcitationReportInput in{*setup.robot, base, excitation, segments, plan, check, samples, bound};
    in.torque_noise = Eigen::VectorXd::Constant(setup.robot->drives(), noise);
    in.predicted_std = predicted_std(*setup.robot, base.independent, samples, in.torque_noise);
    const NominalParameters nominal = nominal_parameters(*setup.robot, PartShapes(setup.robot->description()));
    in.base_values = base.B * nominal.value;
    in.base_scale = in.base_values.cwiseAbs().cwiseMax((base.B.cwiseAbs2() * nominal.std.cwiseAbs2()).cwiseSqrt());
    return in;
  }

  ExcitationSetup setup;
  DesignBound bound;
  BaseParameters base;
  Excitation excitation;
  std::vector<PlanSegment> segments;
  MotionPlan plan;
  LimitCheck check;
  TrajectorySamples samples;
};

TEST(ExcitationReport, ShowsPathLimitsAndWhatWillBeIdentified) {
  const Planned run("delta4", {0.4, 1.0});
  ReportContext context;
  context.robot_file = "robot.urdf";
  context.command_line = "delta-excite robot.urdf -o <t>.csv";
  const std::string page = excitation_report(run.input(0.1), context);
  const auto headings = testing_support::texts(page, "h2");
  for (const char* heading : {"Path", "Limits", "What the motion will identify", "Settings"})
    EXPECT_THAT(headings, ::testing::Contains(HasSubstr(heading)));
  EXPECT_THAT(page, AllOf(HasSubstr("seen at an angle"), HasSubstr("From above"), HasSubstr("segment 2"),
                          HasSubstr("drive 2 velocity"), HasSubstr("D-efficiency"),
                          HasSubstr("lower half ball of radius 0.35 m"), HasSubstr("&lt;t&gt;.csv")));
  // A row for every limit and for every base parameter.
  std::size_t cells = 0;
  for (const std::string& text : testing_support::texts(page, "td")) {
    for (const std::string& expression : run.base.expressions) cells += text == expression ? 1 : 0;
  }
  EXPECT_GE(cells, run.base.expressions.size());
}

TEST(ExcitationReport, NoisierTorqueHidesMore) {
  const Planned run("delta3", {1.0});
  EXPECT_THAT(excitation_report(run.input(1e-6), {}), HasSubstr("Nothing: every combination"));
  EXPECT_THAT(excitation_report(run.input(1e3), {}), ::testing::Not(HasSubstr("Nothing: every combination")));
}

TEST(ExcitationReport, ServesAnAxisAndRefusesForeignParts) {
  const Planned run("axis", {1.0});
  const std::string page = excitation_report(run.input(0.1), {});
  EXPECT_THAT(page, ::testing::Not(HasSubstr("seen at an angle")));
  ExcitationReportInput wrong = run.input(0.1);
  wrong.predicted_std.conservativeResize(1);
  EXPECT_THROW((void)excitation_report(wrong, {}), Error);
}

}  // namespace
}  // namespace deltadyn
