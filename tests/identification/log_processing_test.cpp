#include "deltadyn/identification/log_processing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deltadyn/runtime/error.hpp"

#include "../../src/identification/data_fold.hpp"
#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;
using ::testing::HasSubstr;

class LogProcessing : public ::testing::Test {
 protected:
  Log log(double duration_s, bool with_derivatives = true) const {
    SyntheticOptions options;
    options.duration_s = duration_s;
    options.with_derivatives = with_derivatives;
    return synthetic_log(*robot_, delta_truth(*robot_), options);
  }
  std::string error_of(const Log& log, const ProcessingOptions& options) const {
    try {
      (void)prepare_log(*robot_, log, options);
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  }
  std::unique_ptr<Robot> robot_ = make_robot(delta_description("delta4"));
};

TEST_F(LogProcessing, FilteringTorqueAndRegressorAlikeLeavesTheModelExact) {
  ProcessingOptions options;
  options.periods = Periods::ignore;
  options.cutoff_hz = 60;
  const PreparedLog prepared = prepare_log(*robot_, log(4.0), options);
  const DataFold fold = fold_log(*robot_, prepared);
  for (int j = 0; j < robot_->drives(); ++j) {
    const DriveFold& drive = fold.regular[static_cast<std::size_t>(j)];
    ASSERT_GT(drive.rows, 100);
    EXPECT_LT(drive.rms(delta_truth(*robot_)), 2e-4 * drive.tau_max) << "drive " << j + 1;
  }
}

TEST_F(LogProcessing, RowsNearReversalsAreMarked) {
  const PreparedLog prepared = prepare_log(*robot_, log(4.0), ProcessingOptions{});
  RowBlock block;
  read_rows(*robot_, prepared, 0, prepared.rows, block);
  const Eigen::Index reach = prepared.low_pass->half_width();
  for (Eigen::Index k = 0; k < block.rows(); ++k) {
    const Eigen::Index at = sample_of_row(prepared, k);
    const auto v = prepared.qd.col(3).segment(at - reach, 2 * reach + 1);
    const bool turns = v.minCoeff() < 0 && v.maxCoeff() > 0;
    EXPECT_TRUE(!turns || block.use(k, 3) == RowUse::reversal) << "row " << k;
  }
  EXPECT_GT((block.use == RowUse::regular).count(), block.use.size() / 4);
}

TEST_F(LogProcessing, RepairedSamplesAreNotUsed) {
  Log repaired = log(4.0);
  repaired.filled.assign(static_cast<std::size_t>(repaired.samples()), 0);
  repaired.filled[2000] = 1;
  ProcessingOptions options;
  options.periods = Periods::ignore;
  const PreparedLog prepared = prepare_log(*robot_, repaired, options);
  RowBlock block;
  read_rows(*robot_, prepared, 0, prepared.rows, block);
  const Eigen::Index reach = prepared.low_pass->half_width();
  for (Eigen::Index k = 0; k < block.rows(); ++k) {
    const bool near = std::abs(sample_of_row(prepared, k) - 2000) <= reach;
    EXPECT_EQ(block.use(k, 0) == RowUse::unusable, near) << "row " << k;
  }
}

TEST_F(LogProcessing, ALowCutoffLeavesThePositionsTheirBand) {
  ProcessingOptions options;
  const double usual = options.motion_over_pass;
  options.cutoff_hz = 4;
  options.keep_motion(12);
  EXPECT_DOUBLE_EQ(options.motion_over_pass * options.cutoff_hz, 12);
  options.cutoff_hz = 20;
  options.motion_over_pass = usual;
  options.keep_motion(12);
  EXPECT_DOUBLE_EQ(options.motion_over_pass, usual);
  options.cutoff_hz = 0.5;
  options.keep_motion(100);
  EXPECT_NO_THROW(options.validate());
}

TEST_F(LogProcessing, PeriodsAreAveragedWithoutLosingTheEnds) {
  const Log two_periods = log(8.0);  // the motion repeats every 4 s
  ProcessingOptions options;
  options.cutoff_hz = 30;
  const PreparedLog prepared = prepare_log(*robot_, two_periods, options);
  ASSERT_TRUE(prepared.period_s.has_value());
  EXPECT_NEAR(*prepared.period_s, 4.0, 1e-9);
  EXPECT_EQ(prepared.rows, 4000 / prepared.stride);
  const DataFold fold = fold_log(*robot_, prepared);
  for (const DriveFold& drive : fold.regular) EXPECT_LT(drive.rms(delta_truth(*robot_)), 2e-4 * drive.tau_max);

  options.periods = Periods::ignore;
  EXPECT_FALSE(prepare_log(*robot_, two_periods, options).period_s.has_value());
  options.periods = Periods::detect;
  EXPECT_FALSE(prepare_log(*robot_, log(6.0), options).period_s.has_value())
      << "averaging would lose a third of the log";
}

TEST_F(LogProcessing, SaysWhatIsWrong) {
  ProcessingOptions options;
  options.filter = false;
  EXPECT_THAT(error_of(log(1.0, false), options), HasSubstr("velocities and accelerations"));
  Log far = log(1.0);
  far.q(500, 0) = 2.9;
  far.line.assign(static_cast<std::size_t>(far.samples()), 0);
  far.line[500] = 777;
  EXPECT_THAT(error_of(far, options), HasSubstr("line 777"));
  options.filter = true;
  options.cutoff_hz = 5;
  EXPECT_THAT(error_of(log(0.5), options), HasSubstr("too short"));
  options.cutoff_hz = -1;
  EXPECT_THAT(error_of(log(1.0), options), HasSubstr("cutoff_hz"));
}

}  // namespace
}  // namespace deltadyn
