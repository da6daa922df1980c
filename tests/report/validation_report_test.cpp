#include "deltadyn/report/validation_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deltadyn/report/assessment.hpp"
#include "deltadyn/runtime/error.hpp"

#include "report/synthetic_run.hpp"
#include "report/xml_checks.hpp"

namespace deltadyn {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing_support::HiddenTorque;
using testing_support::shipped_robot;
using testing_support::synthetic_log;
using testing_support::texts;

struct Case {
  std::unique_ptr<Robot> robot;
  Eigen::VectorXd p;
  Validation validation;

  [[nodiscard]] Assessment assess() const { return assess_validation(*robot, validation); }
  [[nodiscard]] std::string page() const {
    return validation_report(*robot, validation, p,
                             {"robot.urdf", {"made_up.csv"}, "params.csv", "delta-validate robot.urdf"});
  }
};

/// Predicts logs of a machine with the nominal parameters by those times `scale`.
Case make_case(const std::string& robot_name, double noise, double scale = 1.0, const HiddenTorque& hidden = {},
               int logs = 1) {
  Case out;
  out.robot = shipped_robot(robot_name);
  const Eigen::VectorXd truth = nominal_parameters(*out.robot, PartShapes(out.robot->description())).value;
  out.p = scale * truth;
  std::vector<Log> recorded;
  for (int k = 0; k < logs; ++k) {
    recorded.push_back(synthetic_log(*out.robot, truth, noise, hidden, static_cast<std::uint64_t>(k + 1)));
    recorded.back().file = "folder/log" + std::to_string(k + 1) + ".csv";
  }
  ProcessingOptions processing;
  processing.filter = false;
  out.validation = validate(*out.robot, recorded, out.p, processing, 1);
  return out;
}

TEST(ValidationAssessment, TheTrueModelPredicts) {
  const Assessment assessment = make_case("delta3", 0.01).assess();
  EXPECT_EQ(assessment.verdict, Verdict::good) << assessment.headline;
  EXPECT_THAT(assessment.lines, Contains(HasSubstr("looks like measurement noise")));
}

// The terminal's line and the report's say the same of a structure that is small.
TEST(StructureInWords, SaysWhetherItIsWorthActingOn) {
  StructureLeft left;
  left.file = "folder/slow.csv";
  left.drive = 1;
  left.coordinate = "velocity";
  left.of_torque = 0.034;
  EXPECT_EQ(structure_in_words(left),
            "structure is left in the residual of drive\u00A02 (slow.csv), following its velocity: 3.4 % of the torque "
            "in this log");
  left.of_torque = 0.0047;
  left.coordinate = "time";
  EXPECT_THAT(structure_in_words(left),
              HasSubstr("slow waves that follow none of its coordinates: 0.47 % of the torque"));
  EXPECT_THAT(structure_in_words(left), HasSubstr("small: delta-diagnose may name it"));
}

TEST(ValidationAssessment, WrongParametersArePutInTheHeadline) {
  const Case wrong = make_case("delta3", 0.01, 0.5);
  EXPECT_EQ(wrong.assess().verdict, Verdict::bad);
  EXPECT_THAT(wrong.assess().headline, HasSubstr("does not predict"));
  EXPECT_EQ(make_case("delta3", 0.01, 0.91).assess().verdict, Verdict::caution);
}

TEST(ValidationAssessment, ASpringIsSeenInThePosition) {
  const HiddenTorque spring = [](int drive, double q, double) { return drive == 2 ? 4.0 * q : 0.0; };
  const Assessment assessment = make_case("delta3", 0.01, 1.0, spring).assess();
  EXPECT_NE(assessment.verdict, Verdict::good);
  EXPECT_THAT(assessment.lines, Contains(HasSubstr("follows the position of drive\u00A03")));
}

TEST(ValidationAssessment, NoiseOfAnySizeIsNotTakenForStructure) {
  for (const double noise : {0.001, 0.03, 0.12}) {
    for (const Check& check : make_case("delta3", noise).assess().checks) {
      if (check.subject == "Shape of the residual") {
        EXPECT_EQ(check.figure, "like noise") << noise;
      }
    }
  }
}

TEST(ValidationAssessment, ADriveWithoutRowsIsNoProof) {
  Case made = make_case("delta3", 0.01);
  made.validation.drives[1] = {};
  EXPECT_EQ(made.assess().verdict, Verdict::bad);
}

class ValidationReportOf : public ::testing::TestWithParam<const char*> {};

TEST_P(ValidationReportOf, GivesAWholePage) {
  const Case made = make_case(GetParam(), 0.02, 1.0, {}, 2);
  const std::string page = made.page();
  EXPECT_LT(page.size(), 2'000'000U);
  EXPECT_THAT(texts(page, "h1"), ::testing::ElementsAre("Validation of " + made.robot->description().name));
  EXPECT_THAT(texts(page, "td"), Contains("log1.csv"));
  EXPECT_THAT(texts(page, "td"), Contains("log2.csv"));
  const bool slides = made.robot->description().drive_kind == DriveKind::prismatic;
  EXPECT_THAT(page, HasSubstr(slides ? "velocity [m/s]" : "velocity [rad/s]"));
  EXPECT_THAT(page, HasSubstr(slides ? "position [m]" : "position [rad]"));
  EXPECT_THAT(page, HasSubstr("delta-validate robot.urdf"));
}

INSTANTIATE_TEST_SUITE_P(EveryType, ValidationReportOf,
                         ::testing::Values("delta3", "linear_delta3", "mujoco_delta4", "emps"));

TEST(ValidationReport, ParametersOfAnotherRobotAreRefused) {
  Case made = make_case("delta3", 0.01);
  made.p.conservativeResize(7);
  EXPECT_THROW((void)made.page(), Error);
}

TEST(ValidationReport, ManyLogsStaySmall) {
  Case made = make_case("delta3", 0.01);
  for (int k = 0; k < 11; ++k) made.validation.logs.push_back(made.validation.logs.front());
  const std::string page = made.page();
  EXPECT_LT(page.size(), 2'000'000U);
  EXPECT_THAT(page, HasSubstr("The first 3 of 12 logs are drawn"));
}

}  // namespace
}  // namespace deltadyn
