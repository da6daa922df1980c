#include "deltadyn/effects/some_effects.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

static_assert(effect_named("hose_force") == effect_id<effects::HoseForce>);
static_assert(effect_named("no such effect") == EffectId{-1});
static_assert(std::is_same_v<SomeEffects<effect_named("stribeck"), effect_named("payload")>,
                             EffectList<effects::Stribeck, effects::Payload>>);

TEST(SomeEffects, AreVisitedAndNoOthers) {
  using Two = SomeEffects<effect_named("stribeck"), effect_named("payload")>;
  std::string_view name;
  const auto visit = [&name](auto effect) { name = decltype(effect)::traits().name; };
  EXPECT_TRUE(visit_effect_in<Two>(effect_id<effects::Payload>, visit));
  EXPECT_EQ(name, "payload");
  EXPECT_FALSE(visit_effect_in<Two>(effect_id<effects::HoseForce>, visit));
  EXPECT_FALSE(visit_effect_in<EffectList<>>(effect_id<effects::Payload>, visit));
  EXPECT_EQ(name, "payload");
}

}  // namespace
}  // namespace deltadyn
