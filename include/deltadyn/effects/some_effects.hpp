#pragma once

/// \file
/// Lists of some of the effects, for programs that shall hold no code of the others.

#include <tuple>

#include "deltadyn/effects/visit.hpp"

namespace deltadyn {

namespace detail {

template <int k, class List>
struct EffectAt;
template <int k, class... Effects>
struct EffectAt<k, EffectList<Effects...>> {
  static_assert(k >= 0, "there is no effect of this name in this version of deltadyn");
  using Type = std::tuple_element_t<static_cast<std::size_t>(k), std::tuple<Effects...>>;
};

}  // namespace detail

/// Number of the effect of this name; -1 if there is none.
[[nodiscard]] constexpr EffectId effect_named(std::string_view name) {
  int found = -1;
  for (int k = 0; k < kEffectCount; ++k) {
    visit_effect(EffectId{k}, [&](auto effect) { found = decltype(effect)::traits().name == name ? k : found; });
  }
  return EffectId{found};
}

/// List of the effects with these numbers: SomeEffects<effect_named("..."), effect_named("...")>.
template <EffectId... ids>
using SomeEffects = EffectList<typename detail::EffectAt<static_cast<int>(ids), AllEffects>::Type...>;

}  // namespace deltadyn
