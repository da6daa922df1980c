#include "../../../src/diagnosis/search/effect_search.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <numbers>

#include "identification/axis_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

/// One drive whose torque holds a slow wave over the position besides: `share` of a wave over its range.
struct Searched {
  std::unique_ptr<Robot> robot = make_robot(axis_description(DriveKind::revolute));
  EffectModel model{*robot};
  std::vector<LogRows> logs;
  GenericBasis basis;
  double range = 0;

  /// \param friction  the wave is one of Coulomb's friction
  explicit Searched(double share, bool friction = false) {
    AxisLog plain;
    Log log = plain.make();
    range = log.q.maxCoeff() - log.q.minCoeff();
    const double n = share * 2 * std::numbers::pi / range;
    Eigen::ArrayXd wave = 0.8 * (n * log.q.col(0).array() + 0.3).cos();
    if (friction)
      wave *= testing_support::MultiSine{plain.base_hz, plain.amplitude}
                  .at(log.t_s, 1, 0.7 * static_cast<double>(plain.seed))
                  .array()
                  .sign();
    log.tau.col(0).array() += wave;
    ProcessingOptions processing;
    processing.cutoff_hz = 40;
    processing.motion_over_pass = 1;
    processing.torque_cutoff_ratio = 0.6;
    processing.periods = Periods::ignore;
    logs.push_back(make_log_rows(*robot, find_base_parameters(*robot), prepare_log(*robot, log, processing), 1));
    Eigen::VectorXd p = Eigen::VectorXd::Zero(robot->parameters());
    p.tail(2) << plain.viscous, plain.coulomb;
    logs.front().signals = model.signals(logs.front().log, p);
    basis = make_generic_basis(logs);
  }
  [[nodiscard]] static std::size_t find(const EffectSearch& search, EffectId id) {
    const auto& all = search.hypotheses();
    return static_cast<std::size_t>(
        std::find_if(all.begin(), all.end(), [&](const Hypothesis& one) { return one.id == id; }) - all.begin());
  }
};

TEST(EffectSearch, DoesNotLookForBristlesThatTheRowsHold) {
  const Searched one(0.5);
  const EffectSearch without(one.model, one.logs, one.basis, {});
  const EffectSearch with(one.model, one.logs, one.basis, {}, Eigen::VectorXd::Constant(1, 2e-3));
  EXPECT_LT(Searched::find(without, effect_id<effects::Presliding>), without.hypotheses().size());
  EXPECT_EQ(Searched::find(with, effect_id<effects::Presliding>), with.hypotheses().size());
  EXPECT_EQ(with.hypotheses().size() + 1, without.hypotheses().size());
}

// Part of a wave is gravity, load or anything.
TEST(EffectSearch, RefinesARippleToNoLessThanOneWaveOverTheRange) {
  const Searched one(0.7);
  const EffectSearch search(one.model, one.logs, one.basis, {});
  const EffectSearch::State state = search.state(search.noise_beside({}).noise, {}, nullptr);
  const Fit& fit = search.refine(state, Searched::find(search, effect_id<effects::TorqueRipple>));
  ASSERT_GT(fit.gain, 100);
  EXPECT_GE(fit.effect.shape(0) * one.range, 0.99 * 2 * std::numbers::pi);
}

// It varies once a turn, of which a drive sees a part.
TEST(EffectSearch, FindsFrictionThatVariesByLessThanOneWaveOverTheRange) {
  const Searched one(0.8, true);
  const EffectSearch search(one.model, one.logs, one.basis, {});
  const EffectSearch::State state = search.state(search.noise_beside({}).noise, {}, nullptr);
  const Fit& fit = search.refine(state, Searched::find(search, effect_id<effects::PositionDependentFriction>));
  ASSERT_GT(fit.gain, 100);
  EXPECT_NEAR(fit.effect.shape(0) * one.range / (2 * std::numbers::pi), 0.8, 0.05);
}

TEST(Hypothesis, OfASaturationTakesOffNoMoreThanWhatIsAboveTheLevel) {
  const Searched one(0.5);
  const EffectSearch search(one.model, one.logs, one.basis, {});
  EXPECT_LE(search.hypotheses()[Searched::find(search, effect_id<effects::Saturation>)].largest(0), 1.0);
}

}  // namespace
}  // namespace deltadyn
