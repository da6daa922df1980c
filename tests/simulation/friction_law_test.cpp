#include "deltadyn/simulation/friction_law.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "deltadyn/runtime/error.hpp"

#include "simulation/effect_of.hpp"

namespace deltadyn {
namespace {

using testing_support::effect_of;

JointMotion sliding(double rate) {
  JointMotion motion;
  motion.rate = rate;
  motion.direction = rate < 0 ? -1 : 1;
  motion.position = 0.7;
  motion.time = 2;
  return motion;
}

TEST(FrictionLaw, ViscousAndCoulombAreThoseOfTheModel) {
  const FrictionLaw law(1.5, 4);
  EXPECT_DOUBLE_EQ(law.required(10, sliding(2)), 10 + 3 + 4);
  EXPECT_DOUBLE_EQ(law.required(10, sliding(-2)), 10 - 3 - 4);
  EXPECT_TRUE(law.minds_reversals());
  EXPECT_FALSE(FrictionLaw(1.5, 0).minds_reversals());
}

TEST(FrictionLaw, DampedBristlesAreAheadWhileTheyBuildUp) {
  FrictionLaw plain(1.5, 4), damped(1.5, 4);
  plain.add(effect_of(effect_id<effects::Presliding>, 0, {4}, {0.01, 0}));
  damped.add(effect_of(effect_id<effects::Presliding>, 0, {4}, {0.01, 2e-3}));
  JointMotion motion = sliding(0.5);
  motion.memory[0] = -0.4;
  EXPECT_DOUBLE_EQ(plain.required(0, motion), 0.75 - 1.6);
  EXPECT_DOUBLE_EQ(damped.required(0, motion), 0.75 - 1.6 + 4 * 2e-3 * (0.5 + 0.5 * 0.4) / 0.01);
  motion.memory[0] = 1;
  EXPECT_DOUBLE_EQ(damped.required(0, motion), plain.required(0, motion));
}

TEST(FrictionLaw, TransmittedIsTheInverseOfRequiredForEveryEffect) {
  FrictionLaw law(1.5, 4);
  law.add(effect_of(effect_id<effects::Stribeck>, 0, {2}, {0.3, 1}));
  law.add(effect_of(effect_id<effects::ConvexViscous>, 0, {0.2}, {2}));
  law.add(effect_of(effect_id<effects::AsymmetricCoulomb>, 0, {0.5}, {}));
  law.add(effect_of(effect_id<effects::AsymmetricViscous>, 0, {0.1}, {}));
  law.add(effect_of(effect_id<effects::TorqueRipple>, 0, {0.3, 0.2}, {7}));
  law.add(effect_of(effect_id<effects::PositionDependentFriction>, 0, {0.3, 0.2}, {3}));
  law.add(effect_of(effect_id<effects::ThermalDrift>, 0, {0.3}, {5}));
  law.add(effect_of(effect_id<effects::LoadDependentFriction>, 0, {0.1}, {}));
  law.add(effect_of(effect_id<effects::DirectionalEfficiency>, 0, {0.1, 0.2}, {}));
  for (const double rate : {-3.0, -0.1, 0.2, 4.0}) {
    for (const double load : {-20.0, -1.0, 0.5, 30.0}) {
      const double tau = law.required(load, sliding(rate));
      EXPECT_NEAR(law.transmitted(tau, sliding(rate)), load, 1e-12) << rate << " " << load;
    }
  }
}

TEST(FrictionLaw, BeyondItsReversalTheRateCountsAsZero) {
  FrictionLaw law(1.5, 4);
  law.add(effect_of(effect_id<effects::Stribeck>, 0, {2}, {0.3, 2}));
  JointMotion motion = sliding(-0.1);
  motion.direction = 1;  // an integration step a little too long
  EXPECT_NEAR(law.required(0, motion), 6, 1e-12);
}

TEST(FrictionLaw, RefusesFrictionThatWouldPushAtRest) {
  FrictionLaw law(0, 1);
  EXPECT_THROW(law.add(effect_of(effect_id<effects::ShearThinning>, 0, {1.5}, {2, 0})), Error);
  FrictionLaw other(0, 1);
  EXPECT_NO_THROW(other.add(effect_of(effect_id<effects::ShearThinning>, 0, {0.9}, {2, 0})));
  FrictionLaw gear(0, 1);
  EXPECT_THROW(gear.add(effect_of(effect_id<effects::DirectionalEfficiency>, 0, {0.1, 1.0}, {})), Error);
}

}  // namespace
}  // namespace deltadyn
