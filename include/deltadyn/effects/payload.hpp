#pragma once

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// A mass dm on the plate that only some logs have: force dm (a - g) on the plate, torque J^T of it per unit mass;
/// amplitude dm [kg] > 0 in the log of the shape's number. Two logs can only tell it from the plate's own mass if one
/// of them is without.
struct Payload : PlateForce {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "payload";
    t.effect_class = EffectClass::load;
    t.place = EffectPlace::platform;
    t.amplitudes = {{"mass", "kg", Sign::positive, 1e4}};
    t.shapes = {ShapeTraits("log", "", ShapeScale::logs)};
    t.form = {0.01, 5e-4, 5e-4};  // linear in what is known
    t.meaning = "a mass on the plate in some of the logs only";
    t.shows = "the whole model scales in one log";
    t.remedy = "record all logs with the same load, or state it";
    return t;
  }

  template <class T>
  static std::array<Vector3<T>, 1> columns(const PlateInput<T>& in, const Shape<T>&) {
    return {in.acceleration - in.gravity};
  }
  template <class Machine>
  static void change(Machine& machine, int, const std::array<double, kMostAmplitudes>& mass, const Shape<double>&) {
    machine.add_to_plate(mass[0]);
  }
};

}  // namespace deltadyn::effects
