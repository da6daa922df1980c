#include "deltadyn/identification/validate.hpp"

#include <gtest/gtest.h>

#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

TEST(Validate, FiguresAreThoseOfTheRows) {
  const auto robot = make_robot(delta_description("delta3"));
  std::vector<Log> logs;
  for (const std::uint64_t seed : {1U, 2U}) {
    SyntheticOptions synthetic;
    synthetic.seed = seed;
    synthetic.torque_noise = 0.2;
    logs.push_back(synthetic_log(*robot, delta_truth(*robot), synthetic));
  }
  const Validation result = validate(*robot, logs, 0.9 * delta_truth(*robot), ProcessingOptions{});
  ASSERT_EQ(result.logs.size(), 2U);
  for (int j = 0; j < 3; ++j) {
    double square = 0, tau_square = 0, largest = 0;
    Eigen::Index rows = 0;
    for (const ValidatedLog& log : result.logs) {
      const auto usable = log.prediction.usable(j, false);
      for (Eigen::Index k = 0; k < log.prediction.rows(); ++k) {
        if (!usable(k)) continue;
        const double e = log.prediction.tau(k, j) - log.prediction.model(k, j);
        square += e * e;
        tau_square += log.prediction.tau(k, j) * log.prediction.tau(k, j);
        largest = std::max(largest, std::abs(e));
        ++rows;
      }
    }
    const ValidatedDrive& drive = result.drives[static_cast<std::size_t>(j)];
    EXPECT_EQ(drive.rows, rows);
    EXPECT_GT(drive.reversal_rows, 0);
    EXPECT_NEAR(drive.rms_residual, std::sqrt(square / static_cast<double>(rows)), 1e-12);
    EXPECT_NEAR(drive.relative_residual, std::sqrt(square / tau_square), 1e-12);
    EXPECT_EQ(drive.max_residual, largest);
  }
}

// With bristles in the model of a drive, the rows near reversals of the telescope and of the drive itself are rows to
// judge by, as they are in the fit. Where the model does not predict them, and for drives without bristles, they stay
// out.
TEST(Validate, RowsNearReversalsCountWhereTheModelHoldsThem) {
  const auto robot = make_robot(delta_description("delta4"));
  SyntheticOptions synthetic;
  synthetic.torque_noise = 0.2;
  const std::vector<Log> logs = {synthetic_log(*robot, delta_truth(*robot), synthetic)};
  const ValidatedDrive plain = validate(*robot, logs, delta_truth(*robot), {}).drives[0];
  EXPECT_GT(plain.reversal_rows, 0);
  EXPECT_FALSE(plain.bristles);
  ProcessingOptions bristles;
  bristles.presliding = Eigen::VectorXd::Zero(5);
  bristles.presliding(0) = 1e-6;  // so stiff that it is Coulomb's law, which made the log
  const Validation used = validate(*robot, logs, delta_truth(*robot), bristles);
  EXPECT_TRUE(used.drives[0].bristles);
  EXPECT_EQ(used.drives[0].reversal_rows, 0);
  EXPECT_EQ(used.drives[0].rows, plain.rows + plain.reversal_rows);
  EXPECT_FALSE(used.drives[1].bristles);
  EXPECT_GT(used.drives[1].reversal_rows, 0);
  // Friction of another law there: the middle of each stretch near a reversal has more torque.
  std::vector<Log> other_law = logs;
  const Prediction rows = predict(*robot, prepare_log(*robot, logs[0], bristles), delta_truth(*robot));
  for (Eigen::Index k = 3; k + 3 < rows.rows(); ++k) {
    if (!(rows.use.col(0).segment(k - 3, 7) == RowUse::reversal).all()) continue;
    for (Eigen::Index at = 0; at < other_law[0].samples(); ++at) {
      const double t = other_law[0].t_s(at);
      if (t >= rows.t_s(k) && t < rows.t_s(k + 1)) other_law[0].tau(at, 0) += 20;
    }
  }
  EXPECT_GT(validate(*robot, other_law, delta_truth(*robot), bristles).drives[0].reversal_rows, 0);
}

TEST(Validate, TheTruthPredictsBestAndWithoutNoiseExactly) {
  const auto robot = make_robot(delta_description("delta3"));
  const Log log = synthetic_log(*robot, delta_truth(*robot), SyntheticOptions{});
  ProcessingOptions options;
  options.filter = false;
  const Validation truth = validate(*robot, {log}, delta_truth(*robot), options);
  const Validation wrong = validate(*robot, {log}, 1.1 * delta_truth(*robot), options);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_LT(truth.drives[j].max_residual, 1e-10);
    EXPECT_NEAR(wrong.drives[j].relative_residual, 0.1, 1e-6);
  }
}

}  // namespace
}  // namespace deltadyn
