#pragma once

/// \file
/// One effect with its numbers, as a table has it and as a controller holds it. What is checked here does not depend on
/// the robot.

#include <array>
#include <cstddef>

#include "deltadyn/effects/kinds.hpp"
#include "deltadyn/firmware/effect_refusal.hpp"

namespace deltadyn {

/// One effect with its numbers, in the order of its traits. A constant table of them is what a converted header holds.
struct EffectRow {
  EffectId id = EffectId{-1};
  int joint = -1;  ///< drive from 0; -1: not on one drive (telescope, platform, robot)
  Shape<double> shape{};
  std::array<double, kMostAmplitudes> amplitude{};
};

/// What a controller computes with.
template <class T>
struct EffectTerm {
  EffectId id = EffectId{-1};
  Role role = Role::none;
  int joint = -1;  ///< as in EffectRow
  Shape<T> shape{};
  std::array<T, kMostAmplitudes> amplitude{};
  T gain = T(1);  ///< of all amplitudes
};

namespace detail {

/// What the shape parameters can be, and the amplitudes, known to the compiler.
template <class Effect>
constexpr std::array<Range, kMostShapes> shape_ranges() {
  const EffectTraits traits = Effect::traits();
  std::array<Range, kMostShapes> ranges{};
  for (std::size_t k = 0; k < traits.shapes.size(); ++k) ranges[k] = traits.shapes[k].range;
  return ranges;
}
template <class Effect>
constexpr std::array<Range, kMostAmplitudes> amplitude_ranges() {
  const EffectTraits traits = Effect::traits();
  std::array<Range, kMostAmplitudes> ranges{};
  for (std::size_t k = 0; k < traits.amplitudes.size(); ++k) ranges[k] = traits.amplitudes[k].range();
  return ranges;
}

/// The numbers in the precision of the controller; false if one is not finite there or outside its range.
template <class T, std::size_t kCount>
bool take_numbers(const std::array<double, kCount>& given, const std::array<Range, kCount>& ranges,
                  std::array<T, kCount>& taken) {
  for (std::size_t k = 0; k < kCount; ++k) {
    taken[k] = static_cast<T>(given[k]);
    if (!(taken[k] - taken[k] == T(0)) || !ranges[k].holds(given[k])) return false;
  }
  return true;
}

}  // namespace detail

/// The term of a row, or why no controller can feed it forward, whatever the robot.
template <class Effect, class T>
EffectRefusal make_term(const EffectRow& row, EffectTerm<T>& term) {
  const EffectRefusal refusal = refusal_of<Effect>(row.shape);
  if (refusal != EffectRefusal::none) return refusal;
  term.id = row.id;
  term.role = Effect::traits().role;
  term.joint = row.joint;
  constexpr auto shapes = detail::shape_ranges<Effect>();
  constexpr auto amplitudes = detail::amplitude_ranges<Effect>();
  const bool taken = detail::take_numbers(row.shape, shapes, term.shape) &&
                     detail::take_numbers(row.amplitude, amplitudes, term.amplitude);
  return taken ? EffectRefusal::none : EffectRefusal::bad_number;
}

}  // namespace deltadyn
