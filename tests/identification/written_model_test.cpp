#include "deltadyn/identification/written_model.hpp"

#include <gtest/gtest.h>

#include "deltadyn/identification/identify.hpp"

#include "identification/axis_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

Effect effect(EffectId id, std::initializer_list<double> shape, double amplitude) {
  Effect out;
  out.id = id;
  out.joint = 0;
  out.shape = Eigen::Map<const Eigen::VectorXd>(shape.begin(), static_cast<Eigen::Index>(shape.size()));
  out.amplitude = Eigen::VectorXd::Constant(1, amplitude);
  return out;
}

struct Fitted {
  std::unique_ptr<Robot> robot = make_robot(axis_description(DriveKind::revolute));
  WrittenModel model;

  Fitted() {
    std::vector<Log> logs;
    for (const std::uint64_t seed : {1U, 2U}) logs.push_back(log(seed));
    Eigen::VectorXd prior = Eigen::VectorXd::Zero(robot->parameters());
    prior.head(10) << 2, 0, 0, 0, 0.4, 0.4, 0.4, 0, 0, 0;
    prior.tail(2) << 1, 1;
    const Identification found = identify(*robot, logs, prior, {}, IdentificationOptions{});
    model = {
        found.fit.p, {}, found.processing.presliding, found.processing.presliding_damping_s, found.processing.ripples};
  }
  static Log log(std::uint64_t seed) {
    AxisLog dirty;
    dirty.presliding = 4e-3;
    dirty.seed = seed;
    return dirty.make();
  }
};

TEST(ValidateWritten, HoldsTheBristlesOfTheModel) {
  const Fitted fitted;
  const Log fresh = Fitted::log(7);
  const auto whole = validate_written(*fitted.robot, {fresh}, fitted.model, {}, true, false).validation;
  WrittenModel rigid = fitted.model;
  rigid.presliding.resize(0);
  const auto without = validate_written(*fitted.robot, {fresh}, rigid, {}, true, false).validation;
  EXPECT_EQ(whole.processing.cutoff_hz, without.processing.cutoff_hz);
  EXPECT_LT(whole.drives[0].reversal_rows, without.drives[0].reversal_rows / 5);
  EXPECT_LT(whole.drives[0].rms_with_reversals, 0.5 * without.drives[0].rms_with_reversals);
}

TEST(ValidateWritten, TakesASmallDelayOutUnlessItIsToStayOrEffectsAreKnown) {
  const Fitted fitted;
  const Log late = without_delay({Fitted::log(7)}, -0.8e-3).front();
  const WrittenValidation mended = validate_written(*fitted.robot, {late}, fitted.model, {}, true, false);
  ASSERT_TRUE(mended.fine_delay.has_value());
  EXPECT_NEAR(mended.fine_delay->delay_s, 0.8e-3, 0.1e-3);
  EXPECT_FALSE(validate_written(*fitted.robot, {late}, fitted.model, {}, true, true).fine_delay.has_value());
  WrittenModel timed = fitted.model;
  timed.effects = {effect(effect_id<effects::TimeSkew>, {-0.8e-3}, -0.8e-3)};
  const WrittenValidation with = validate_written(*fitted.robot, {late}, timed, {}, true, false);
  EXPECT_FALSE(with.fine_delay.has_value());
}

TEST(HoldsTiming, OfEffectsThatShiftTheTorqueInTime) {
  EXPECT_FALSE(holds_timing({}));
  EXPECT_FALSE(holds_timing({effect(effect_id<effects::Stribeck>, {0.1, 2}, 0.5)}));
  EXPECT_TRUE(holds_timing(
      {effect(effect_id<effects::Stribeck>, {0.1, 2}, 0.5), effect(effect_id<effects::TimeSkew>, {1e-3}, 1e-3)}));
  EXPECT_TRUE(holds_timing({effect(effect_id<effects::CurrentLag>, {1e-3, 1}, 1e-3)}));
}

// "Of the torque" means what the drives gave, whatever part of it is that of effects.
TEST(ValidateWritten, CountsTheTorqueOfEffects) {
  const Fitted fitted;
  const Log fresh = Fitted::log(7);
  const auto without = validate_written(*fitted.robot, {fresh}, fitted.model, {}, true, true).validation.drives[0];
  WrittenModel model = fitted.model;
  model.effects = {effect(effect_id<effects::AsymmetricCoulomb>, {}, 6)};
  Log shifted = fresh;
  shifted.tau.array() += 6;
  const auto with = validate_written(*fitted.robot, {shifted}, model, {}, true, true).validation;
  EXPECT_NEAR(with.drives[0].rms_residual, without.rms_residual, 0.02 * without.rms_residual);
  const auto given = validate_written(*fitted.robot, {shifted}, fitted.model, {}, true, true).validation.drives[0];
  EXPECT_NEAR(with.drives[0].rms_torque, given.rms_torque, 0.01 * given.rms_torque);
  EXPECT_GT(std::abs(given.rms_torque - without.rms_torque), 0.03 * given.rms_torque);
  EXPECT_NEAR(with.drives[0].relative_residual, with.drives[0].rms_residual / with.drives[0].rms_torque, 1e-12);
  const Prediction& rows = with.logs.front().prediction;
  EXPECT_NEAR(rows.rms_torque(0, false), with.drives[0].rms_torque, 1e-9);
}

}  // namespace
}  // namespace deltadyn
