#include "deltadyn/report/identification_report.hpp"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deltadyn/report/assessment.hpp"
#include "deltadyn/report/log_report.hpp"
#include "deltadyn/runtime/error.hpp"

#include "report/synthetic_run.hpp"
#include "report/xml_checks.hpp"

namespace deltadyn {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing_support::shipped_robot;
using testing_support::synthetic_run;
using testing_support::SyntheticRun;
using testing_support::texts;

constexpr std::size_t kLargestPage = 2'000'000;

std::string page_of(const SyntheticRun& run) {
  return identification_report(*run.robot, run.identification, run.training, run.survey,
                               {"robot.urdf", {"made_up.csv"}, "prior.csv", "delta-identify robot.urdf made_up.csv"});
}

Assessment assess(const SyntheticRun& run) {
  return assess_identification(*run.robot, run.identification, run.survey,
                               gather_evidence(*run.robot, run.identification, run.training));
}

std::string all_text(const Assessment& assessment) {
  std::string text = assessment.headline;
  for (const std::string& line : assessment.told()) text += "\n" + line;
  return text;
}

Verdict verdict_on(const Assessment& assessment, const std::string& subject) {
  for (const Check& check : assessment.checks) {
    if (check.subject == subject) return check.verdict;
  }
  ADD_FAILURE() << "no check '" << subject << "'";
  return Verdict::bad;
}

/// One run for all tests that only look at it or change a copy.
const SyntheticRun& good_run() {
  static const SyntheticRun run = synthetic_run("delta3");
  return run;
}

SyntheticRun copy_of(const SyntheticRun& run) {
  return {shipped_robot("delta3"), run.truth, run.identification, run.training, run.survey};
}

TEST(IdentificationAssessment, AGoodRunIsTrusted) {
  const Assessment assessment = assess(good_run());
  EXPECT_EQ(assessment.verdict, Verdict::good) << all_text(assessment);
  EXPECT_THAT(all_text(assessment), HasSubstr("looks like measurement noise"));
  EXPECT_THAT(all_text(assessment), HasSubstr("friction of all joints"));
}

TEST(IdentificationAssessment, HiddenFrictionIsSeenAndPlacedAtItsDrive) {
  const auto stribeck = [](int drive, double, double qd) {
    return drive == 1 ? std::copysign(2.0 * std::exp(-qd * qd / 0.5), qd) : 0.0;
  };
  const SyntheticRun run = synthetic_run("delta3", 0.01, stribeck);
  const Assessment assessment = assess(run);
  EXPECT_NE(assessment.verdict, Verdict::good);
  EXPECT_THAT(all_text(assessment), HasSubstr("follows the velocity of drive\u00A02"));
}

TEST(IdentificationAssessment, TheSizeOfTheResidualDecides) {
  SyntheticRun run = copy_of(good_run());
  DriveReport& drive = run.identification.drives[2];
  drive.rms = drive.rms_base = 0.10 * drive.rms_torque;
  EXPECT_EQ(assess(run).verdict, Verdict::caution);
  drive.rms = drive.rms_base = 0.40 * drive.rms_torque;
  const Assessment assessment = assess(run);
  EXPECT_EQ(assessment.verdict, Verdict::bad);
  EXPECT_THAT(assessment.headline, HasSubstr("40 % of the rms torque (drive\u00A03)"));
}

TEST(IdentificationAssessment, AMassMatrixThatIsNotPositiveForbidsUse) {
  SyntheticRun run = copy_of(good_run());
  run.survey.not_positive = 3;
  const Assessment assessment = assess(run);
  EXPECT_EQ(assessment.verdict, Verdict::bad);
  EXPECT_THAT(all_text(assessment), HasSubstr("Not positive definite at 3 of 200 poses"));
}

TEST(IdentificationAssessment, TheSolverMustBeDoneAndProvenRight) {
  SyntheticRun run = copy_of(good_run());
  // The data tell it from the base parameters.
  run.identification.fit.data_cost_free = run.identification.fit.data_cost - 1000;
  run.identification.fit.certificate.passed = false;
  EXPECT_EQ(assess(run).verdict, Verdict::caution);
  run.identification.fit.certificate.available = false;
  EXPECT_EQ(assess(run).verdict, Verdict::good);
  run.identification.fit.converged = false;
  EXPECT_EQ(assess(run).verdict, Verdict::bad);
}

TEST(IdentificationAssessment, AFitAsGoodAsTheBaseParametersNeedsNoProof) {
  SyntheticRun run = copy_of(good_run());
  run.identification.fit.data_cost_free = run.identification.fit.data_cost - 1;
  run.identification.fit.certificate.passed = false;
  run.identification.fit.certificate.gap = 5;
  EXPECT_EQ(assess(run).verdict, Verdict::good);
  EXPECT_THAT(all_text(assess(run)), HasSubstr("can be trusted"));
  run.identification.fit.converged = false;
  EXPECT_EQ(assess(run).verdict, Verdict::good);
}

TEST(IdentificationAssessment, ConsistencyThatCostsMuchIsTold) {
  SyntheticRun run = copy_of(good_run());
  ConsistentFitSummary& fit = run.identification.fit;
  fit.data_cost_free = fit.data_cost - 1e4;
  run.identification.drives[0].rms_base = run.identification.drives[0].rms / 1.05;
  EXPECT_EQ(verdict_on(assess(run), "Price of physical consistency"), Verdict::caution);
  run.identification.drives[0].rms_base = run.identification.drives[0].rms / 1.5;
  EXPECT_EQ(verdict_on(assess(run), "Price of physical consistency"), Verdict::bad);
  // The same rise where chi^2 says that the noise does not tell the two apart.
  fit.data_cost_free = fit.data_cost - 1;
  EXPECT_EQ(verdict_on(assess(run), "Price of physical consistency"), Verdict::good);
  fit.data_cost_free = fit.data_cost - 1e4;
  // The same rise in the rounding of a log without noise.
  run.identification.drives[0].rms = 1e-14;
  run.identification.drives[0].rms_base = run.identification.drives[0].rms / 1.5;
  EXPECT_EQ(verdict_on(assess(run), "Price of physical consistency"), Verdict::good);
}

TEST(IdentificationAssessment, UncertainBaseParametersMakeTheTorqueUncertain) {
  SyntheticRun run = copy_of(good_run());
  EXPECT_EQ(verdict_on(assess(run), "Torque on other motions"), Verdict::good);
  run.identification.base_estimate.covariance *= 1e4;
  EXPECT_NE(verdict_on(assess(run), "Torque on other motions"), Verdict::good);
}

TEST(IdentificationAssessment, ReversalsThatTakeMostOfTheLogAreTold) {
  SyntheticRun run = copy_of(good_run());
  run.identification.drives[0].reversal_ratio = 5;
  EXPECT_EQ(assess(run).verdict, Verdict::good);
  EXPECT_THAT(all_text(assess(run)), HasSubstr("up to 5.0 times that elsewhere (drive\u00A01)"));
  run.identification.drives[0].masked_rows = 4 * run.identification.drives[0].rows;
  EXPECT_EQ(assess(run).verdict, Verdict::caution);
}

// Rows that are used are not said to be left out, and a few about the start of a log are no matter.
TEST(IdentificationAssessment, ReversalsAreSaidAsTheFitTookThem) {
  SyntheticRun run = copy_of(good_run());
  for (DriveReport& drive : run.identification.drives) drive.masked_rows = 0;
  run.identification.presliding.assign(3, PreslidingJoint{});
  for (PreslidingJoint& joint : run.identification.presliding) joint.displacement = 1e-3;
  run.identification.drives[0].masked_rows = 1;
  run.identification.drives[0].reversal_ratio = 12;
  const auto reversals = [&] { return assess(run).checks.back(); };
  EXPECT_EQ(reversals().figure, "rows there are used");
  run.identification.drives[0].masked_rows = run.identification.drives[0].rows / 4;
  EXPECT_THAT(reversals().figure, HasSubstr("up to 12.0 times"));
  EXPECT_THAT(reversals().meaning, HasSubstr("left out of all other figures"));
  run.identification.drives[0].masked_rows = 0;
  EXPECT_THAT(reversals().meaning, HasSubstr("used all the same"));
  for (const Check& check : assess(run).checks) {
    if (check.verdict == Verdict::good) {
      EXPECT_EQ(check.meaning.find("not trust"), std::string::npos) << check.meaning;
    }
  }
}

TEST(IdentificationAssessment, OnlyValuesWithSmallIntervalsAreMeasured) {
  SyntheticRun run = copy_of(good_run());
  ConsistentFitSummary& fit = run.identification.fit;
  const Assessment before = assess(run);
  EXPECT_THAT(before.measured, HasSubstr("friction of all joints"));
  const auto coulomb =
      std::find(fit.parameters.begin(), fit.parameters.end(), parameter_id("drive2.coulomb")) - fit.parameters.begin();
  fit.std(coulomb) = 0.11 * std::abs(fit.p(coulomb));
  const Assessment after = assess(run);
  EXPECT_EQ(after.measured.find("friction of all joints"), std::string::npos) << after.measured;
  EXPECT_EQ(after.measured.find("drive2.coulomb"), std::string::npos) << after.measured;
  // What is not to be trusted has measured nothing, whatever the check that says so.
  Assessment bad = before;
  LogFinding fault;
  fault.level = FindingLevel::fault;
  fault.text = "the torque is of another machine";
  weigh_findings({fault}, bad);
  EXPECT_THAT(all_text(before), HasSubstr("Measured by these logs"));
  EXPECT_EQ(all_text(bad).find("Measured"), std::string::npos) << all_text(bad);
}

TEST(DecidedBy, TellsValuesFromSums) {
  ConsistentFitSummary fit;
  fit.p.resize(5);
  fit.p << 1, 1, 1, 1, 1;
  fit.prior.resize(5);
  fit.prior << 3, 3, 1, 3, 3;
  fit.std.resize(5);
  fit.std << 0.01, 20, 20, 20, 20;
  fit.data_share.resize(5);
  fit.data_share << 0.99, 0.99, 0.1, 0.1, 0.1;
  EXPECT_EQ(decided_by(fit, Visibility::combined, 0), DecidedBy::data);
  EXPECT_TRUE(is_measured(fit, Visibility::combined, 0));
  EXPECT_EQ(decided_by(fit, Visibility::combined, 1), DecidedBy::sums);
  EXPECT_FALSE(is_measured(fit, Visibility::alone, 1));
  EXPECT_EQ(decided_by(fit, Visibility::combined, 2), DecidedBy::prior);
  EXPECT_EQ(decided_by(fit, Visibility::combined, 3), DecidedBy::sums);
  EXPECT_EQ(decided_by(fit, Visibility::hidden, 4), DecidedBy::neither);
}

TEST(IdentificationReport, ShowsBristlesAndWavesThatTheModelHolds) {
  SyntheticRun run = copy_of(good_run());
  EXPECT_EQ(page_of(run).find("builds up after a reversal over"), std::string::npos);
  run.identification.presliding.assign(3, PreslidingJoint{});
  run.identification.presliding[1].displacement = 2.5e-3;
  run.identification.presliding[1].std = 1e-4;
  run.identification.presliding[1].damping_s = 2e-3;
  run.identification.presliding[1].damping_std_s = 1e-4;
  run.identification.processing.ripples = {{0, 31, 0.03, 0.04, 0.4, 0.002}};
  const std::string page = page_of(run);
  for (const char* words : {"0.00250 ± 0.00010 rad", "2.00 ± 0.10 ms", "0.0500 ± 0.0020 N m", "31.00 ± 0.40 a turn"})
    EXPECT_THAT(page, HasSubstr(words));
}

TEST(PriorGaps, SayWhatToMeasure) {
  const BaseParameters base = [] {
    BaseParameters made;  // a alone, b + c together, d not at all
    made.B = Eigen::MatrixXd::Zero(3, 5);
    made.B << 1, 0, 0, 0, 0, 0, 1, 0.5, 0, 0, 0, 0, 0, 0, 1;
    made.independent = {0, 1, 4};
    return made;
  }();
  EXPECT_THAT(parameter_visibility(base),
              ::testing::ElementsAre(Visibility::alone, Visibility::combined, Visibility::combined, Visibility::hidden,
                                     Visibility::alone));
  ConsistentFitSummary fit;
  for (const char* name : {"drive2.viscous", "tool.m", "telescope_lower.mcz", "platform.Ixx", "strut.Ixx"})
    fit.parameters.push_back(parameter_id(name).value());
  fit.fitted.assign(5, true);
  fit.p = fit.prior = fit.std = Eigen::VectorXd::Ones(5);
  fit.data_share = Eigen::VectorXd::Constant(5, 0.08);
  Eigen::VectorXd effect = Eigen::VectorXd::Constant(5, 0.3);
  effect(4) = 1e-5;
  const std::vector<PriorGap> gaps = prior_gaps(fit, base, effect);
  ASSERT_EQ(gaps.size(), 4U) << "platform.Ixx does not act on the drives";
  EXPECT_TRUE(gaps[0].by_motion);
  EXPECT_THAT(gaps[0].advice, HasSubstr("high speed of drive\u00A02"));
  EXPECT_EQ(gaps[1].advice, "weigh the tool");
  EXPECT_THAT(gaps[1].parameters, ::testing::ElementsAre("m (8 %)"));
  EXPECT_FALSE(gaps[1].by_motion);
  EXPECT_THAT(gaps[2].advice, HasSubstr("centre of mass"));
  EXPECT_TRUE(gaps[3].negligible);
  EXPECT_FALSE(gaps[3].by_motion);

  fit.data_share(1) = 0.95;
  EXPECT_EQ(prior_gaps(fit, base, effect).size(), 3U);
  fit.fitted[0] = false;
  EXPECT_EQ(prior_gaps(fit, base, effect).size(), 2U);
}

TEST(PriorGaps, AValueFarFromItsPriorIsNotHeldByIt) {
  ConsistentFitSummary fit;
  fit.p = Eigen::Vector2d(1.0, 1.0);
  fit.prior = Eigen::Vector2d(0.9, 0.5);
  fit.std = Eigen::Vector2d(0.1, 0.1);
  EXPECT_TRUE(held_by_prior(fit, 0));
  EXPECT_FALSE(held_by_prior(fit, 1));
}

class IdentificationReportOf : public ::testing::TestWithParam<const char*> {};

TEST_P(IdentificationReportOf, GivesAWholePage) {
  const SyntheticRun run = synthetic_run(GetParam());
  const std::string page = page_of(run);
  EXPECT_LT(page.size(), kLargestPage);
  EXPECT_THAT(texts(page, "h1"), ::testing::ElementsAre("Identification of " + run.robot->description().name));
  EXPECT_THAT(texts(page, "h2"),
              ::testing::IsSupersetOf({"Checks", "Parameters", "Base parameters", "What to measure next"}));
  const std::vector<std::string> cells = texts(page, "td");
  for (const std::string& name : run.robot->parameter_names())
    EXPECT_THAT(cells, Contains(name)) << "every parameter is in some table";
  for (const std::string& expression : run.identification.base.expressions) EXPECT_THAT(cells, Contains(expression));
  const bool slides = run.robot->description().drive_kind == DriveKind::prismatic;
  EXPECT_THAT(page, HasSubstr(slides ? "force [N]" : "torque [N m]"));
  EXPECT_THAT(page, HasSubstr(slides ? "residual [N]" : "residual [N m]"));
  EXPECT_THAT(page, HasSubstr("delta-identify robot.urdf made_up.csv"));
  const bool axis = run.robot->description().parts.empty();
  EXPECT_THAT(page, axis ? Not(HasSubstr("height of the plate"))
                         : ::testing::Matcher<const std::string&>(HasSubstr("height of the plate")));
}

INSTANTIATE_TEST_SUITE_P(EveryType, IdentificationReportOf,
                         ::testing::Values("delta3", "linear_delta3", "mujoco_delta4", "emps"));

TEST(IdentificationReport, MarksThePriorAndFoldsAwayWhatWasNotFitted) {
  SyntheticRun run = copy_of(good_run());
  ConsistentFitSummary& fit = run.identification.fit;
  const auto index = [&](const std::string& name) {
    return static_cast<Eigen::Index>(std::find(fit.parameters.begin(), fit.parameters.end(), parameter_id(name)) -
                                     fit.parameters.begin());
  };
  const auto row_class = [&](const std::string& name) {
    std::string found = "none";
    testing_support::for_each_element(page_of(run), [&](const tinyxml2::XMLElement& element) {
      if (std::string(element.Name()) != "tr" || element.FirstChildElement("td") == nullptr) return;
      if (testing_support::text_of(*element.FirstChildElement("td")) != name) return;
      found = element.Attribute("class") != nullptr ? element.Attribute("class") : "";
    });
    return found;
  };
  fit.data_share(index("platform.m")) = 0.97;
  EXPECT_EQ(row_class("platform.m"), "");
  fit.data_share(index("platform.m")) = 0.05;
  EXPECT_EQ(row_class("platform.m"), "caution");
  EXPECT_THAT(texts(page_of(run), "summary"), Contains("Parameters that were not fitted"));
}

TEST(IdentificationReport, NotesOfTheLogAndOfTheFitAreShown) {
  SyntheticRun run = copy_of(good_run());
  run.identification.notes = {"made_up.csv, line 7: <repaired>"};
  run.identification.fit.notes = {"the prior was moved"};
  EXPECT_THAT(texts(page_of(run), "li"),
              ::testing::IsSupersetOf({"made_up.csv, line 7: <repaired>", "the prior was moved"}));
}

TEST(IdentificationReport, PartsOfAnotherRobotAreRefused) {
  SyntheticRun run = copy_of(good_run());
  run.robot = shipped_robot("mujoco_delta4");
  EXPECT_THROW((void)page_of(run), Error);
}

}  // namespace
}  // namespace deltadyn
