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

template <class Function, class... Effects>
constexpr bool visit_some(EffectList<Effects...>, [[maybe_unused]] EffectId id, [[maybe_unused]] Function& function) {
  return ((effect_id<Effects> == id ? (function(Effects()), true) : false) || ...);
}

}  // namespace detail

/// visit_effect() for a program that has but some of the effects, so that it holds no code of the others.
/// \tparam List  an EffectList
/// \return false if the effect is not in the list
template <class List, class Function>
constexpr bool visit_effect_in(EffectId id, Function function) {
  return detail::visit_some(List(), id, function);
}

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
