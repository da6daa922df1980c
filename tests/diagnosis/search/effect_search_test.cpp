#include "../../../src/diagnosis/search/effect_search.hpp"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>

#include "identification/axis_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

using Torque = std::function<Eigen::ArrayXd(const Eigen::ArrayXd& position, const Eigen::ArrayXd& rate)>;

/// One drive whose torque holds something besides.
struct Searched {
  std::unique_ptr<Robot> robot = make_robot(axis_description(DriveKind::revolute));
  EffectModel model{*robot};
  std::vector<LogRows> logs;
  GenericBasis basis;

  explicit Searched(const Torque& besides) {
    AxisLog plain;
    Log log = plain.make();
    const Eigen::VectorXd rate = testing_support::MultiSine{plain.base_hz, plain.amplitude}.at(
        log.t_s, 1, 0.7 * static_cast<double>(plain.seed));
    log.tau.col(0).array() += besides(log.q.col(0).array(), rate.array());
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

double range_of(const Eigen::ArrayXd& position) {
  return position.maxCoeff() - position.minCoeff();
}

/// A slow wave over the position: `share` of a wave over its range.
Torque wave(double share) {
  return [share](const Eigen::ArrayXd& position, const Eigen::ArrayXd& /*rate*/) -> Eigen::ArrayXd {
    return 0.8 * (share * 2 * std::numbers::pi / range_of(position) * position + 0.3).cos();
  };
}

/// The wave as one of Coulomb's friction.
Torque friction_wave(double share) {
  return [share](const Eigen::ArrayXd& position, const Eigen::ArrayXd& rate) -> Eigen::ArrayXd {
    return wave(share)(position, rate) * rate.sign();
  };
}

TEST(EffectSearch, DoesNotLookForBristlesThatTheRowsHold) {
  const Searched one(wave(0.5));
  const EffectSearch without(one.model, one.logs, one.basis, {});
  const EffectSearch with(one.model, one.logs, one.basis, {}, Eigen::VectorXd::Constant(1, 2e-3));
  EXPECT_LT(Searched::find(without, effect_id<effects::Presliding>), without.hypotheses().size());
  EXPECT_EQ(Searched::find(with, effect_id<effects::Presliding>), with.hypotheses().size());
  EXPECT_EQ(with.hypotheses().size() + 1, without.hypotheses().size());
}

// Part of a wave is gravity, load or anything.
TEST(EffectSearch, RefinesARippleToNoLessThanOneWaveOverTheRange) {
  const Searched one(wave(0.7));
  const EffectSearch search(one.model, one.logs, one.basis, {});
  const EffectSearch::State state = search.state(search.noise_beside({}).noise, {}, nullptr);
  const Fit& fit = search.refine(state, Searched::find(search, effect_id<effects::TorqueRipple>));
  ASSERT_GT(fit.gain, 100);
  EXPECT_GE(fit.effect.shape(0) * range_of(one.logs.front().log.q.col(0)), 0.99 * 2 * std::numbers::pi);
}

// It varies once a turn, of which a drive sees a part.
TEST(EffectSearch, FindsFrictionThatVariesByLessThanOneWaveOverTheRange) {
  const Searched one(friction_wave(0.8));
  const EffectSearch search(one.model, one.logs, one.basis, {});
  const EffectSearch::State state = search.state(search.noise_beside({}).noise, {}, nullptr);
  const Fit& fit = search.refine(state, Searched::find(search, effect_id<effects::PositionDependentFriction>));
  ASSERT_GT(fit.gain, 100);
  EXPECT_NEAR(fit.effect.shape(0) * range_of(one.logs.front().log.q.col(0)) / (2 * std::numbers::pi), 0.8, 0.05);
}

// What fits the coarse start values best need not fit best in the end.
TEST(EffectSearch, RefinesEveryExponentOfStribecksLaw) {
  for (const double share : {0.06, 0.08, 0.1, 0.13, 0.17}) {
    for (const double exponent : {1.0, 2.0}) {
      const Searched one([&](const Eigen::ArrayXd& /*position*/, const Eigen::ArrayXd& rate) -> Eigen::ArrayXd {
        const double bend = share * rate.abs().maxCoeff();
        return 0.8 * rate.sign() * (-(rate.abs() / bend).pow(exponent)).exp();
      });
      const EffectSearch search(one.model, one.logs, one.basis, {});
      const EffectSearch::State state = search.state(search.noise_beside({}).noise, {}, nullptr);
      const Fit& fit = search.refine(state, Searched::find(search, effect_id<effects::Stribeck>));
      ASSERT_GT(fit.gain, 100);
      EXPECT_EQ(fit.effect.shape(1), exponent) << "bend at " << share << " of the largest rate";
      EXPECT_NEAR(fit.effect.amplitude(0), 0.8, 0.16) << "bend at " << share << " of the largest rate";
    }
  }
}

TEST(Hypothesis, OfASaturationTakesOffNoMoreThanWhatIsAboveTheLevel) {
  const Searched one(wave(0.5));
  const EffectSearch search(one.model, one.logs, one.basis, {});
  EXPECT_LE(search.hypotheses()[Searched::find(search, effect_id<effects::Saturation>)].largest(0), 1.0);
}

}  // namespace
}  // namespace deltadyn
