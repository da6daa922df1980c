// The diagnosis of one drive with everyday dirt: a bristle and a ripple that the model knows, with and without an
// effect beside them.

#include "deltadyn/diagnosis/diagnose.hpp"

#include <gtest/gtest.h>

#include "deltadyn/identification/written_model.hpp"

#include "identification/axis_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

constexpr double kStribeck = 0.6, kStribeckRate = 0.8;  // [N m], [rad/s]

/// Fast for odd seeds, slow for even ones.
Log dirty_log(std::uint64_t seed, double stribeck) {
  AxisLog dirty;
  dirty.presliding = 2e-3;
  dirty.ripple = 0.1;
  dirty.waves = 15;
  dirty.seed = seed;
  dirty.base_hz = seed % 2 == 1 ? 0.37 : 0.13;
  Log log = dirty.make();
  log.file = "axis" + std::to_string(seed);
  const testing_support::MultiSine motion{dirty.base_hz, dirty.amplitude};
  const Eigen::VectorXd v = motion.at(log.t_s, 1, 0.7 * static_cast<double>(seed));
  for (Eigen::Index k = 0; k < v.size(); ++k)
    log.tau(k, 0) += stribeck * std::exp(-std::pow(v(k) / kStribeckRate, 2)) * (v(k) > 0 ? 1 : -1);
  return log;
}

/// The model as delta-identify gives it, and its diagnosis.
class DirtyAxis : public ::testing::Test {
 protected:
  /// \param in_training, in_holdout  size of a Stribeck effect [N m]
  void diagnose_logs(double in_training, double in_holdout) {
    logs_ = {dirty_log(1, in_training), dirty_log(2, in_training)};
    holdout_ = dirty_log(3, in_holdout);
    Eigen::VectorXd prior = Eigen::VectorXd::Zero(robot_->parameters());
    prior.head(10) << 2, 0, 0, 0, 0.4, 0.4, 0.4, 0, 0, 0;
    prior.tail(2) << 1, 1;
    // As it comes from a machine that was in order: the effect came later.
    const Identification given =
        identify(*robot_, {dirty_log(11, 0), dirty_log(12, 0)}, prior, {}, IdentificationOptions{});
    given_ = {
        given.fit.p, {}, given.processing.presliding, given.processing.presliding_damping_s, given.processing.ripples};
    options_.null_runs = 40;
    options_.processing.presliding = given_.presliding;
    options_.processing.presliding_damping_s = given_.presliding_damping_s;
    options_.processing.ripples = given_.ripples;
    result_ = diagnose(*robot_, logs_, &holdout_, given_.p, {}, {}, options_);
  }

  std::unique_ptr<Robot> robot_ = make_robot(axis_description(DriveKind::revolute));
  std::vector<Log> logs_;
  Log holdout_;
  WrittenModel given_;
  DiagnosisOptions options_;
  Diagnosis result_;
};

TEST_F(DirtyAxis, MissesNothingThatTheModelKnows) {
  diagnose_logs(0, 0);
  ASSERT_GT(given_.presliding(0), 0);
  ASSERT_EQ(given_.ripples.size(), 1U);
  EXPECT_EQ(result_.verdict, DiagnosisVerdict::nothing_missing) << verdict_name(result_.verdict);
  EXPECT_TRUE(result_.named.empty());
  // Rows near reversals take part.
  ASSERT_EQ(result_.drives.size(), 1U);
  ASSERT_EQ(result_.drives[0].rows.size(), 3U);
  for (const RowCount& rows : result_.drives[0].rows) EXPECT_GT(rows.whole, 0.9 * static_cast<double>(rows.all));
  EXPECT_LT(result_.drives[0].rms, 1.1 * result_.drives[0].floor);
}

TEST_F(DirtyAxis, NamesWhatCameBesideItAndProvesWhatIsWritten) {
  diagnose_logs(kStribeck, kStribeck);
  ASSERT_FALSE(result_.named.empty()) << verdict_name(result_.verdict);
  const NamedEffect& first = result_.named.front();
  EXPECT_EQ(first.name, "stribeck") << verdict_name(result_.verdict);
  // The improved model keeps what it knew.
  ASSERT_TRUE(result_.improved.has_value());
  const ProcessingOptions& own = result_.improved->processing;
  ASSERT_EQ(own.presliding.size(), 1);
  EXPECT_GT(own.presliding(0), 0);
  EXPECT_FALSE(own.ripples.empty());
  const WrittenModel written{result_.improved->fit.p, result_.effects, own.presliding, own.presliding_damping_s,
                             own.ripples};
  const auto rms = [&](const WrittenModel& model) {
    return validate_written(*robot_, {holdout_}, model, {}, true, false).validation.drives[0].rms_residual;
  };
  ASSERT_EQ(result_.holdout_figures.size(), 1U);
  EXPECT_NEAR(result_.holdout_figures[0].rms_written, rms(written), 1e-9);
  EXPECT_NEAR(result_.holdout_figures[0].rms_given, rms(given_), 1e-9);
  EXPECT_LT(result_.holdout_figures[0].rms_written, 0.7 * result_.holdout_figures[0].rms_given);
  EXPECT_NEAR(first.rms_after, result_.holdout_figures[0].rms_written, 1e-12);
}

// The training logs show it, the hold-out log does not: what would be written is worse there than what was given.
TEST_F(DirtyAxis, NamesAndWritesNothingThatTheHoldOutLogDoesNotBearOut) {
  diagnose_logs(kStribeck, 0);
  EXPECT_NE(result_.verdict, DiagnosisVerdict::named);
  EXPECT_NE(result_.verdict, DiagnosisVerdict::confusable);
  EXPECT_TRUE(result_.effects.empty());
  EXPECT_FALSE(result_.improved.has_value());
  EXPECT_TRUE(result_.holdout_figures.empty());
}

}  // namespace
}  // namespace deltadyn
