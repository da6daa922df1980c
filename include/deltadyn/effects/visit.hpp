#pragma once

/// \file
/// From an effect's number to its type: one call that finds the type in the list and hands it to a function. No heap,
/// no virtual calls.

#include <cstddef>
#include <string_view>
#include <type_traits>
#include <utility>

#include "deltadyn/effects/all.hpp"

namespace deltadyn {

/// Number of an effect in the list.
enum class EffectId : int {};

inline constexpr int kEffectCount = AllEffects::kCount;

namespace detail {

template <class Effect, class... Effects>
constexpr int index_in(EffectList<Effects...>) {
  int index = -1, k = 0;
  ((index = std::is_same_v<Effect, Effects> ? k : index, ++k), ...);
  return index;
}

}  // namespace detail

template <class Effect>
inline constexpr EffectId effect_id = EffectId{detail::index_in<Effect>(AllEffects())};

namespace detail {

template <class Function, class... Effects>
constexpr bool visit_in(EffectList<Effects...>, [[maybe_unused]] EffectId id, [[maybe_unused]] Function& function) {
  return ((effect_id<Effects> == id ? (function(Effects()), true) : false) || ...);
}

}  // namespace detail

/// Calls function(Effect()) for the effect with this number: a generic lambda `[&](auto effect) { using E =
/// decltype(effect); ... }`. A program that visits a list of some of the effects holds no code of the others.
/// \tparam List  an EffectList
/// \return false if the effect is not in the list
template <class List, class Function>
constexpr bool visit_effect_in(EffectId id, Function function) {
  return detail::visit_in(List(), id, function);
}

/// visit_effect_in() the list of all effects.
template <class Function>
constexpr void visit_effect(EffectId id, Function function) {
  visit_effect_in<AllEffects>(id, function);
}

/// Has the effect a change() of the machine?
template <class Effect, class Machine, class = void>
struct HasChange : std::false_type {};
template <class Effect, class Machine>
struct HasChange<Effect, Machine,
                 std::void_t<decltype(Effect::change(std::declval<Machine&>(), 0,
                                                     std::declval<const std::array<double, kMostAmplitudes>&>(),
                                                     std::declval<const Shape<double>&>()))>> : std::true_type {};

}  // namespace deltadyn
