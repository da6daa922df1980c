// The controller's torques with effects are those of the fit: every effect that can act, at every place, on every
// robot.

#include "deltadyn/firmware/effect_feed_forward.hpp"

#include <limits>
#include <map>

#include "deltadyn/dynamics/inverse_dynamics.hpp"

#include "firmware/effect_bench.hpp"
#include "support/matchers.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;
using Eigen::MatrixXd;

template <class R>
class EffectFeedForwardOf : public ::testing::Test {
 protected:
  using Drives = Vector<double, R::kDrives>;
  EffectBench<R> bench_{17};

  [[nodiscard]] std::string name(const Effect& effect) const {
    return std::string(effect_kind(effect.id).name) + "@" + effect_joint_name(effect.id, effect.joint) + " " +
           effect_shape_text(effect, bench_.robot->description());
  }
  [[nodiscard]] Drives at(const MatrixXd& of, int k) const { return of.row(k).transpose(); }

  /// An effect with a memory, at drive 1.
  [[nodiscard]] static EffectRow bristles(double friction = 1.5, double displacement = 0.01) {
    EffectRow row;
    row.id = effect_id<effects::Presliding>;
    row.joint = 0;
    row.shape = {displacement, 0, 0};
    row.amplitude[0] = friction;
    return row;
  }
};
using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4, Axis, LinearAxis>;
TYPED_TEST_SUITE(EffectFeedForwardOf, Robots);

TYPED_TEST(EffectFeedForwardOf, WithoutEffectsIsTheRigidModel) {
  auto control = this->bench_.template control<double, 0>();
  EXPECT_THAT((this->bench_.template run<double>(control)),
              IsNear(this->bench_.signals.torque, 1e-13 * this->bench_.size()));
}

TYPED_TEST(EffectFeedForwardOf, AgreesWithTheColumnsOfTheFitInDouble) {
  auto& bench = this->bench_;
  const std::vector<Effect> acting = bench.acting_effects();
  EXPECT_GT(acting.size(), 20U);
  double showing = 0;
  for (const Effect& effect : acting) {
    auto control = bench.template control<double>();
    ASSERT_EQ(control.add(bench.row_of(effect)), EffectRefusal::none) << this->name(effect);
    const MatrixXd expected = bench.expected(effect);
    showing += (expected - bench.signals.torque).norm() > 1e-6 * bench.size() ? 1 : 0;
    EXPECT_THAT((bench.template run<double>(control)), IsNear(expected, 1e-12 * bench.size())) << this->name(effect);
  }
  EXPECT_GT(showing, 0.7 * static_cast<double>(acting.size())) << "effects that nobody sees prove nothing";
}

TYPED_TEST(EffectFeedForwardOf, AgreesWithTheColumnsOfTheFitInFloat) {
  auto& bench = this->bench_;
  for (const Effect& effect : bench.acting_effects()) {
    auto control = bench.template control<float>();
    ASSERT_EQ(control.add(bench.row_of(effect)), EffectRefusal::none) << this->name(effect);
    EXPECT_THAT((bench.template run<float>(control)), IsNear(bench.expected(effect), 1e-5 * bench.size()))
        << this->name(effect);
  }
}

// A change of the machine is linear in its amplitude only to first order; at the step of the fit's difference the rest
// is small.
TYPED_TEST(EffectFeedForwardOf, ChangesTheMachineAsTheFitsDifferencesDo) {
  auto& bench = this->bench_;
  for (Effect effect : bench.acting_effects()) {
    if (!bench.changes_machine(effect.id)) continue;
    effect.amplitude *= 0.01;
    auto control = bench.template control<double>();
    ASSERT_EQ(control.add(bench.row_of(effect)), EffectRefusal::none);
    const MatrixXd change = bench.template run<double>(control) - bench.signals.torque,
                   columns = bench.by_columns(effect);
    EXPECT_LT((change - columns).norm(), 1e-3 * columns.norm()) << this->name(effect);
  }
}

TYPED_TEST(EffectFeedForwardOf, AddsUpEffects) {
  auto& bench = this->bench_;
  constexpr int kMost = 400;
  auto control = bench.template control<double, kMost>();
  MatrixXd expected = bench.signals.torque;
  for (const Effect& effect : bench.acting_effects()) {
    if (bench.changes_machine(effect.id)) continue;
    ASSERT_EQ(control.add(bench.row_of(effect)), EffectRefusal::none);
    expected += bench.by_columns(effect);
  }
  EXPECT_THAT((bench.template run<double>(control)), IsNear(expected, 1e-12 * expected.cwiseAbs().maxCoeff()));
}

TYPED_TEST(EffectFeedForwardOf, TakesATableOfRows) {
  auto& bench = this->bench_;
  auto one_by_one = bench.template control<double, 3>();
  const EffectRow wrong = {EffectId{-1}, 0, {}, {}}, rows[] = {this->bristles(), wrong, this->bristles(0.5, 0.02)};
  for (const EffectRow& row : rows) (void)one_by_one.add(row);
  typename EffectBench<TypeParam>::template Control<double, 3> at_once(bench.geometry, bench.p, rows);
  EXPECT_EQ(at_once.effects(), 2);
  EXPECT_EQ((bench.template run<double>(at_once)), (bench.template run<double>(one_by_one)));
}

TYPED_TEST(EffectFeedForwardOf, SaysWhyAnEffectCannotAct) {
  auto& bench = this->bench_;
  std::map<std::string, EffectRefusal> refused;
  for (const EffectKind& kind : effect_catalogue()) {
    const EffectRefusal refusal = refusal_of(kind.id, Shape<double>{});
    if (refusal != EffectRefusal::none) refused[std::string(kind.name)] = refusal;
  }
  const std::map<std::string, EffectRefusal> expected = {
      {"backlash", EffectRefusal::spring},         {"joint_elasticity", EffectRefusal::spring},
      {"payload", EffectRefusal::of_one_log},      {"torque_constant_error", EffectRefusal::of_the_record},
      {"time_skew", EffectRefusal::of_the_record}, {"current_lag", EffectRefusal::of_the_record},
      {"saturation", EffectRefusal::of_the_record}};
  EXPECT_EQ(refused, expected);

  auto control = bench.template control<double>();
  const auto with = [](auto change) {
    EffectRow row = TestFixture::bristles();
    change(row);
    return row;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(control.add(with([](EffectRow& row) { row.joint = TypeParam::kDrives; })), EffectRefusal::no_such_place);
  EXPECT_EQ(control.add(with([](EffectRow& row) { row.joint = -1; })), EffectRefusal::no_such_place);
  EXPECT_EQ(control.add(with([](EffectRow& row) { row.shape[0] = 0; })), EffectRefusal::bad_number);
  EXPECT_EQ(control.add(with([nan](EffectRow& row) { row.amplitude[0] = nan; })), EffectRefusal::bad_number);
  EXPECT_EQ(control.add(with([](EffectRow& row) { row.id = EffectId{-1}; })), EffectRefusal::not_in_list);
  EXPECT_THAT((bench.template run<double>(control)), IsNear(bench.signals.torque, 1e-13 * bench.size()))
      << "nothing was added";
  EXPECT_EQ(control.add(this->bristles()), EffectRefusal::none);
  EXPECT_EQ(control.add(this->bristles()), EffectRefusal::no_room);
  EffectFeedForward<double, TypeParam, Limbs::individual, 1, SomeEffects<effect_named("stribeck")>> few(bench.geometry,
                                                                                                        bench.p);
  EXPECT_EQ(few.add(this->bristles()), EffectRefusal::not_in_list);
}

TYPED_TEST(EffectFeedForwardOf, RefusesAmplitudesAndShapesBeyondTheirRange) {
  auto& bench = this->bench_;
  auto control = bench.template control<double, 1>();
  for (const Effect& effect : bench.acting_effects()) {
    const EffectKind& kind = effect_kind(effect.id);
    for (std::size_t k = 0; k < kind.amplitudes.size(); ++k) {
      EffectRow row = bench.row_of(effect);
      row.amplitude[k] = kind.amplitudes[k].positive() ? -row.amplitude[k] : 1.01 * kind.amplitudes[k].largest;
      EXPECT_EQ(control.add(row), EffectRefusal::bad_number) << this->name(effect);
    }
    for (std::size_t k = 0; k < kind.shapes.size(); ++k) {
      if (!std::isfinite(kind.shapes[k].range.highest)) continue;
      EffectRow row = bench.row_of(effect);
      row.shape[k] = 1.01 * kind.shapes[k].range.highest;
      EXPECT_EQ(control.add(row), EffectRefusal::bad_number) << this->name(effect);
    }
  }
}

TYPED_TEST(EffectFeedForwardOf, GivesTheEncodersPositionForATask) {
  auto& bench = this->bench_;
  if (!kHasPlate<TypeParam>) return;
  auto control = bench.template control<double>();
  EffectRow row;
  row.id = effect_id<effects::KinematicOffset>;
  row.joint = 1;
  row.amplitude[0] = 0.01;
  ASSERT_EQ(control.add(row), EffectRefusal::none);
  const RandomTask<TypeParam> task = random_task<TypeParam>(bench.random);
  Motion<double, TypeParam> motion;
  ASSERT_EQ(motion_from_task(bench.geometry, task.z, task.zd, task.zdd, motion), Status::ok);
  typename TestFixture::Drives q, qd, tau, again;
  ASSERT_EQ(control.from_task(task.z, task.zd, task.zdd, q, qd, tau), Status::ok);
  EXPECT_NEAR(q(1), motion.posture.q(1) - 0.01, 1e-14);
  EXPECT_EQ(q(0), motion.posture.q(0));
  EXPECT_EQ(qd, motion.qd);
  EXPECT_THAT(tau, IsNear(inverse_dynamics<typename EffectBench<TypeParam>::Layout>(bench.geometry, motion, bench.p),
                          1e-12 * bench.size()));
  ASSERT_EQ(control.from_drives(q, qd, motion.qdd, again), Status::ok);
  EXPECT_THAT(again, IsNear(tau, 1e-10 * bench.size()));
}

TYPED_TEST(EffectFeedForwardOf, KeepsOutputsAndMemoryOnABadSetPoint) {
  auto& bench = this->bench_;
  auto disturbed = bench.template control<double>(), left_alone = disturbed;
  ASSERT_EQ(disturbed.add(this->bristles()), EffectRefusal::none);
  ASSERT_EQ(left_alone.add(this->bristles()), EffectRefusal::none);
  using V = typename TestFixture::Drives;
  const V old = V::Constant(42);
  for (int k = 0; k < bench.kSamples; ++k) {
    V q = this->at(bench.log.q, k), qd = this->at(bench.log.qd, k), qdd = this->at(bench.log.qdd, k), one, other;
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      V tau = old, q_out = old, qd_out = old, wrong = q;
      wrong(0) = bad;
      EXPECT_EQ(disturbed.from_drives(wrong, qd, qdd, tau), Status::out_of_range);
      EXPECT_EQ(disturbed.from_drives(q, wrong, qdd, tau), Status::out_of_range);
      EXPECT_EQ(disturbed.from_drives(q, qd, wrong, tau), Status::out_of_range);
      EXPECT_EQ(disturbed.from_task(wrong, qd, qdd, q_out, qd_out, tau), Status::out_of_range);
      EXPECT_EQ(disturbed.reset(wrong, qd), Status::out_of_range);
      EXPECT_EQ(disturbed.set_time(bad), Status::out_of_range);
      EXPECT_EQ(disturbed.set_reversal_width(0, bad), Status::out_of_range);
      EXPECT_EQ(disturbed.set_payload(bad, Vector3<double>::Zero()), Status::out_of_range);
      EXPECT_EQ(disturbed.set_friction(0, 1, bad), Status::out_of_range);
      // A torque beyond all numbers must not reach the drives either; the inertia of an axis is too small for one.
      if (kHasPlate<TypeParam>) {
        EXPECT_EQ(disturbed.from_drives(q, qd, V::Constant(1e308), tau), Status::out_of_range);
      }
      EXPECT_EQ(tau, old);
      EXPECT_EQ(q_out, old);
      EXPECT_EQ(qd_out, old);
    }
    ASSERT_EQ(disturbed.from_drives(q, qd, qdd, one), Status::ok);
    ASSERT_EQ(left_alone.from_drives(q, qd, qdd, other), Status::ok);
    ASSERT_EQ(one, other) << "sample " << k;
  }
}

TYPED_TEST(EffectFeedForwardOf, RemembersTheWayAndForgetsAtAReset) {
  auto& bench = this->bench_;
  const double friction = 1.5, displacement = 0.01;
  auto control = bench.template control<double>();
  ASSERT_EQ(control.add(this->bristles(friction, displacement)), EffectRefusal::none);
  using V = typename TestFixture::Drives;
  const V q0 = this->at(bench.log.q, 0), rest = V::Zero();
  const auto torque = [&](double step) {
    V tau;
    V q = q0;
    q(0) += step;
    EXPECT_EQ(control.from_drives(q, rest, rest, tau), Status::ok);
    auto rigid = bench.template control<double, 0>();
    V plain;
    EXPECT_EQ(rigid.from_drives(q, rest, rest, plain), Status::ok);
    return tau(0) - plain(0);
  };
  EXPECT_NEAR(torque(0), 0, 1e-12) << "at rest, unloaded";
  const double loaded = friction * (1 - std::exp(-1.0));
  EXPECT_NEAR(torque(displacement), loaded, 1e-12);
  EXPECT_NEAR(torque(displacement), loaded, 1e-12) << "no way, no change";
  V up = rest;
  up(0) = 1;
  ASSERT_EQ(control.reset(q0, up), Status::ok);
  EXPECT_NEAR(torque(0), friction, 1e-12) << "has slid long";
  ASSERT_EQ(control.reset(q0, rest), Status::ok);
  EXPECT_NEAR(torque(0), 0, 1e-12);
}

TYPED_TEST(EffectFeedForwardOf, ReversesSmoothlyOverTheWidth) {
  auto& bench = this->bench_;
  auto control = bench.template control<double>();
  EffectRow stribeck;
  stribeck.id = effect_named("stribeck");
  stribeck.joint = 0;
  stribeck.shape = {0.5, 2, 0};
  stribeck.amplitude[0] = 2;
  ASSERT_EQ(control.add(stribeck), EffectRefusal::none);
  using V = typename TestFixture::Drives;
  const V q = this->at(bench.log.q, 0), rest = V::Zero();
  const int coulomb = EffectBench<TypeParam>::Layout::coulomb(0), viscous = EffectBench<TypeParam>::Layout::viscous(0);
  // Friction of drive 1: what changes with the direction.
  const auto friction = [&](double rate) {
    V up = rest, down = rest, tau_up, tau_down;
    up(0) = rate;
    down(0) = -rate;
    EXPECT_EQ(control.from_drives(q, up, rest, tau_up), Status::ok);
    EXPECT_EQ(control.from_drives(q, down, rest, tau_down), Status::ok);
    return 0.5 * (tau_up(0) - tau_down(0));
  };
  const auto expected = [&](double rate, double sign) {
    return bench.p(viscous) * rate + (bench.p(coulomb) + 2 * std::exp(-rate * rate / 0.25)) * sign;
  };
  if (TypeParam::kTelescope) {
    ASSERT_EQ(control.set_friction(control.kInnerJoint, 0, 0), Status::ok);
  }
  EXPECT_NEAR(friction(0.1), expected(0.1, 1), 1e-12);
  EXPECT_EQ(friction(0), 0);
  for (int joint = 0; joint <= control.kInnerJoint; ++joint)
    ASSERT_EQ(control.set_reversal_width(joint, 0.1), Status::ok);
  EXPECT_EQ(friction(0), 0);
  EXPECT_NEAR(friction(0.1), expected(0.1, std::sqrt(0.5)), 1e-12);
  EXPECT_NEAR(friction(1e-9), 0, 1e-6);
  EXPECT_NEAR(friction(1000), expected(1000, 1), 1e-6);
  EXPECT_EQ(control.set_reversal_width(-1, 0.1), Status::out_of_range);
  EXPECT_EQ(control.set_reversal_width(control.kPassiveJoints + 1, 0.1), Status::out_of_range);
  EXPECT_EQ(control.set_reversal_width(0, -0.1), Status::out_of_range);
}

TYPED_TEST(EffectFeedForwardOf, BristlesFollowTheCoulombFrictionThatIsSet) {
  auto& bench = this->bench_;
  const int coulomb = EffectBench<TypeParam>::Layout::coulomb(0), viscous = EffectBench<TypeParam>::Layout::viscous(0);
  auto set = bench.template control<double>();
  ASSERT_EQ(set.add(this->bristles(bench.p(coulomb))), EffectRefusal::none);
  ASSERT_EQ(set.set_friction(0, 0.7, 0), Status::ok);
  ASSERT_EQ(set.set_friction(0, 0.7, 2.5), Status::ok);
  auto changed = bench.p;
  changed(viscous) = 0.7;
  changed(coulomb) = 2.5;
  typename EffectBench<TypeParam>::template Control<double> made(bench.geometry, changed);
  ASSERT_EQ(made.add(this->bristles(2.5)), EffectRefusal::none);
  EXPECT_THAT((bench.template run<double>(set)), IsNear((bench.template run<double>(made)), 1e-12 * bench.size()));
}

}  // namespace
}  // namespace deltadyn
