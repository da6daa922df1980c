#include "deltadyn/identification/effect_torque.hpp"

#include <gtest/gtest.h>

#include "deltadyn/runtime/robot.hpp"

#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::VectorXd;

Effect effect(EffectId id, int joint, const VectorXd& shape, double amplitude) {
  Effect out;
  out.id = id;
  out.joint = joint;
  out.shape = shape;
  out.amplitude = VectorXd::Constant(1, amplitude);
  return out;
}

/// Logs with more friction at low speed on drive 2, or less, and a ripple on drive 1.
class EstimatedAmplitudes : public testing::Test {
 protected:
  EstimatedAmplitudes()
      : robot_(make_robot(testing_support::delta_description("delta3"))), p_(testing_support::delta_truth(*robot_)) {
    used_.processing.cutoff_hz = 30;
    used_.keep_reversals.assign(static_cast<std::size_t>(robot_->drives()), false);
  }

  [[nodiscard]] static Effect stribeck(double amplitude) {
    return effect(effect_id<effects::Stribeck>, 1, Vector2d(0.25, 2), amplitude);
  }
  [[nodiscard]] static Effect ripple(double amplitude) {
    Effect out = effect(effect_id<effects::TorqueRipple>, 0, VectorXd::Constant(1, 9), amplitude);
    out.amplitude = Vector2d(amplitude, 0.5 * amplitude);
    return out;
  }

  [[nodiscard]] Log log_with(const std::vector<Effect>& effects) const {
    testing_support::SyntheticOptions options;
    options.duration_s = 6;
    options.torque_noise = 0.05;
    Log log = testing_support::synthetic_log(*robot_, p_, options);
    const EffectModel model(*robot_);
    ProcessingOptions processing;
    processing.filter = false;
    processing.periods = Periods::ignore;
    log.tau += effect_torque(model, model.signals(prepare_log(*robot_, log, processing), p_, false), effects, 1);
    return log;
  }

  [[nodiscard]] std::vector<Effect> estimated(const Log& log, const std::vector<Effect>& effects) const {
    return estimate_amplitudes(*robot_, {log}, p_, effects, used_);
  }

  std::unique_ptr<Robot> robot_;
  VectorXd p_;
  Identification used_;
};

TEST_F(EstimatedAmplitudes, AreThoseOfTheLog) {
  const auto found = estimated(log_with({stribeck(1.5), ripple(0.4)}), {stribeck(1), ripple(1)});
  EXPECT_NEAR(found[0].amplitude(0), 1.5, 4 * found[0].amplitude_std(0));
  EXPECT_LT(found[0].amplitude_std(0), 0.1);
  EXPECT_NEAR(found[1].amplitude(0), 0.4, 4 * found[1].amplitude_std(0));
  EXPECT_NEAR(found[1].amplitude(1), 0.2, 4 * found[1].amplitude_std(1));
}

TEST_F(EstimatedAmplitudes, WithAFreeSignMayBecomeNegative) {
  const auto found = estimated(log_with({ripple(-0.4)}), {ripple(1)});
  EXPECT_NEAR(found[0].amplitude(0), -0.4, 4 * found[0].amplitude_std(0));
}

TEST_F(EstimatedAmplitudes, ThatWouldBecomeNegativeAgainstPhysicsAreZeroAndTheOthersFittedWithout) {
  const Log log = log_with({stribeck(-1.5), ripple(0.4)});
  const auto found = estimated(log, {stribeck(1), ripple(1)}), without = estimated(log, {ripple(1)});
  EXPECT_EQ(found[0].amplitude(0), 0);
  EXPECT_GT(found[0].amplitude_std(0), 0);
  for (Index c = 0; c < 2; ++c) {
    EXPECT_NEAR(found[1].amplitude(c), without[0].amplitude(c), 1e-9);
    EXPECT_NEAR(found[1].amplitude_std(c), without[0].amplitude_std(c), 1e-9);
  }
}

}  // namespace
}  // namespace deltadyn
