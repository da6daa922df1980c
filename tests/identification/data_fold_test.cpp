#include "../../src/identification/data_fold.hpp"

#include <gtest/gtest.h>

#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

PreparedLog noisy(const Robot& robot, bool filter) {
  SyntheticOptions synthetic;
  synthetic.torque_noise = 0.3;
  ProcessingOptions options;
  options.filter = filter;
  options.periods = Periods::ignore;
  return prepare_log(robot, synthetic_log(robot, delta_truth(robot), synthetic), options);
}

/// Sum of squares over the rows themselves, without any factor.
double direct_square_error(const Robot& robot, const PreparedLog& log, int drive, RowUse use,
                           const Eigen::VectorXd& p) {
  RowBlock block;
  read_rows(robot, log, 0, log.rows, block);
  double sum = 0;
  for (Eigen::Index k = 0; k < block.rows(); ++k) {
    if (block.use(k, drive) != use) continue;
    const double e = block.tau(k, drive) - block.Y[static_cast<std::size_t>(drive)].row(k).dot(p);
    sum += e * e;
  }
  return sum;
}

TEST(DataFold, HoldsTheSquareErrorOfEveryParameterVector) {
  const auto robot = make_robot(delta_description("delta4"));
  for (const bool filter : {false, true}) {
    const PreparedLog log = noisy(*robot, filter);
    const DataFold fold = fold_log(*robot, log);
    std::srand(3);
    for (const Eigen::VectorXd& p :
         {delta_truth(*robot), Eigen::VectorXd(Eigen::VectorXd::Random(robot->parameters()))}) {
      for (int j = 0; j < robot->drives(); ++j) {
        const DriveFold& regular = fold.regular[static_cast<std::size_t>(j)];
        const double expected = direct_square_error(*robot, log, j, RowUse::regular, p);
        EXPECT_NEAR(regular.square_error(p), expected, 1e-9 * (expected + regular.tau_square));
        const double at_reversals = direct_square_error(*robot, log, j, RowUse::reversal, p);
        EXPECT_NEAR(fold.reversal[static_cast<std::size_t>(j)].square_error(p), at_reversals,
                    1e-9 * (at_reversals + regular.tau_square));
      }
    }
  }
}

TEST(DataFold, DoesNotDependOnTheNumberOfThreads) {
  const auto robot = make_robot(delta_description("delta4"));
  const PreparedLog log = noisy(*robot, true);
  const DataFold one = fold_log(*robot, log, 1);
  const DataFold two = fold_log(*robot, log, 2);
  for (std::size_t j = 0; j < one.regular.size(); ++j) {
    EXPECT_EQ(one.regular[j].R, two.regular[j].R);
    EXPECT_EQ(one.regular[j].d, two.regular[j].d);
    EXPECT_EQ(one.regular[j].remainder, two.regular[j].remainder);
  }
}

TEST(DataFold, WeightsScaleRows) {
  const auto robot = make_robot(delta_description("delta3"));
  const PreparedLog log = noisy(*robot, false);
  const Eigen::VectorXd p = delta_truth(*robot);
  const DataFold plain = fold_log(*robot, log);
  const DataFold quarter = fold_log(*robot, log, 0, &p, [](int, double) { return 0.25; });
  EXPECT_NEAR(quarter.regular[1].square_error(p), 0.25 * plain.regular[1].square_error(p),
              1e-9 * plain.regular[1].tau_square);
}

}  // namespace
}  // namespace deltadyn
