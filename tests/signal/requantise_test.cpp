#include "deltadyn/signal/requantise.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "signal/multi_sine.hpp"

namespace deltadyn {
namespace {

struct Recording {
  Log log;
  Eigen::MatrixXd motion;
  double step = 2 * 3.14159265358979323846 / 4096;
  Recording() {
    const testing_support::MultiSine sine{0.37, 0.6};
    log.t_s = testing_support::times(1000, 4000);
    motion.resize(4000, 2);
    motion.col(0) = sine.at(log.t_s, 0, 0.3);
    motion.col(1) = sine.at(log.t_s, 0, 1.1);
    log.q = motion;
    log.q.col(0) = testing_support::quantised(motion.col(0), 12);
    log.tau = Eigen::MatrixXd::Zero(4000, 2);
  }
};

TEST(Requantise, FindsTheStepsThatShow) {
  const Recording recording;
  const Eigen::VectorXd step = position_steps(recording.log);
  EXPECT_NEAR(step(0), recording.step, 1e-6 * recording.step);
  EXPECT_EQ(step(1), 0);
}

TEST(Requantise, RoundsTheMotionToStepsOfAnotherPhase) {
  const Recording recording;
  std::mt19937_64 random(3);
  const Eigen::VectorXd step = position_steps(recording.log);
  const Log a = requantised(recording.log, recording.motion, step, random);
  const Log b = requantised(recording.log, recording.motion, step, random);
  const Eigen::VectorXd error = a.q.col(0) - recording.motion.col(0);
  EXPECT_LE(error.cwiseAbs().maxCoeff(), 0.501 * step(0));
  EXPECT_NEAR(std::sqrt(error.squaredNorm() / 4000), step(0) / std::sqrt(12.0), 0.02 * step(0));
  EXPECT_GT((a.q.col(0) - b.q.col(0)).cwiseAbs().maxCoeff(), 0.1 * step(0));
  EXPECT_EQ(a.q.col(1), recording.motion.col(1));
  EXPECT_EQ(a.tau, recording.log.tau);
}

}  // namespace
}  // namespace deltadyn
