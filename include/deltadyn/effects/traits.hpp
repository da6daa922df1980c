#pragma once

/// \file
/// What is known of a physical effect apart from its law: the words and numbers that every effect states of itself, as
/// constants. Files, flags, reports and the diagnosis read them; none of them knows an effect by name.

#include <cstddef>
#include <initializer_list>
#include <limits>
#include <string_view>

namespace deltadyn {

/// What remains to be said when effects cannot be told apart.
enum class EffectClass {
  velocity_shape,
  quasi_constant,
  load,
  reversal_memory,
  position_periodic,
  inertia_like,
  pose_force,
  phase,
  drift
};

/// "velocity-shape", ...
[[nodiscard]] constexpr std::string_view effect_class_name(EffectClass effect_class) {
  switch (effect_class) {
    case EffectClass::velocity_shape: return "velocity-shape";
    case EffectClass::quasi_constant: return "quasi-constant";
    case EffectClass::load: return "load";
    case EffectClass::reversal_memory: return "reversal-memory";
    case EffectClass::position_periodic: return "position-periodic";
    case EffectClass::inertia_like: return "inertia-like";
    case EffectClass::pose_force: return "pose-force";
    case EffectClass::phase: return "phase";
    case EffectClass::drift: return "drift";
  }
  return "";
}

/// Where an effect acts.
enum class EffectPlace {
  drive,           ///< on one drive
  arm,             ///< on one revolute drive that moves a limb (not the telescope's)
  limb,            ///< on one drive that moves a limb
  limb_or_all,     ///< on one drive that moves a limb (of an axis: its drive), or on all of them alike
  drive_or_robot,  ///< on one drive, or on all drives alike
  telescope,       ///< on the telescope bar's prismatic joint
  passive_joints,  ///< on all ball and universal joints alike
  platform,        ///< on the plate
  robot            ///< on the robot as a whole
};

/// What a shape parameter's start values are measured in.
enum class ShapeScale {
  absolute,        ///< as they stand
  choice,          ///< as they stand, and there is nothing between them
  largest_rate,    ///< share of the joint's largest rate in the logs
  largest_torque,  ///< share of the drive's largest torque in the logs
  displacement,    ///< 1 rad or 0.1 m, or the joint's range in the logs if that is wider
  range,           ///< share of the joint's range in the logs
  place,           ///< from the middle of the joint's range in the logs, in ranges
  waves,           ///< waves per range, from the first start value to the second or to what the pass band lets through
  logs             ///< number of a log, from 1: the effect acts in this log only
};

/// How the search moves a shape parameter between its start values.
struct ShapeSearch {
  enum Kind { fixed, by_factor, by_difference };
  Kind kind = by_factor;
  double low = 0.55, high = 1.8;  ///< of a start value: factors, or differences
  double least = -std::numeric_limits<double>::infinity();
};

/// The numbers that a parameter can have.
struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool open = false;  ///< `lowest` itself is not among them

  /// NaN is in no range.
  [[nodiscard]] constexpr bool holds(double value) const {
    return value >= lowest && value <= highest && !(open && value == lowest);
  }
};

/// A parameter in which the effect is not linear.
struct ShapeTraits {
  std::string_view name;
  std::string_view unit;  ///< "{x}": rad or m, "{F}": N*m or N as the joint is
  ShapeScale scale = ShapeScale::absolute;
  enum class Grid { listed, logarithmic, logarithmic_both_signs };
  Grid grid = Grid::listed;
  double start[8] = {};  ///< start values; low and high end of a logarithmic grid
  int count = 0;         ///< of the start values of one sign
  Range range;           ///< above 0 where all start values are
  ShapeSearch search;
  /// What holds where files and flags do not say; NaN: they must
  double otherwise = std::numeric_limits<double>::quiet_NaN();

  constexpr ShapeTraits() = default;
  constexpr ShapeTraits(std::string_view its_name, std::string_view its_unit,
                        ShapeScale its_scale = ShapeScale::absolute)
      : name(its_name), unit(its_unit), scale(its_scale) {
    if (scale == ShapeScale::choice || scale == ShapeScale::logs) search.kind = ShapeSearch::fixed;
  }
  constexpr ShapeTraits& from(double low, double high, int points) {
    grid = Grid::logarithmic;
    start[0] = low;
    start[1] = high;
    count = points;
    return above_zero(true);
  }
  constexpr ShapeTraits& from_both_signs(double low, double high, int points) {
    from(low, high, points);
    grid = Grid::logarithmic_both_signs;
    return above_zero(false);
  }
  constexpr ShapeTraits& among(std::initializer_list<double> values) {
    count = 0;
    bool positive = true;
    for (const double value : values) {
      start[count++] = value;
      positive = positive && value > 0;
    }
    return above_zero(positive);
  }
  /// Both ends are allowed. Beyond them the law makes no sense, or a unit is wrong.
  constexpr ShapeTraits& within(double low, double high) {
    range = {low, high, false};
    return *this;
  }
  constexpr ShapeTraits& up_to(double high) {
    range.highest = high;
    return *this;
  }
  constexpr ShapeTraits& searched(ShapeSearch how) {
    search = how;
    return *this;
  }
  constexpr ShapeTraits& else_is(double value) {
    otherwise = value;
    return *this;
  }

 private:
  constexpr ShapeTraits& above_zero(bool is) {
    range = is ? Range{0, range.highest, true} : Range{};
    return *this;
  }
};

enum class Sign { either, positive };

/// A parameter in which the effect is linear.
struct AmplitudeTraits {
  std::string_view name;
  std::string_view unit;     ///< as in ShapeTraits
  Sign sign = Sign::either;  ///< positive: physics fixes it
  /// Largest size that makes sense, in a diagnosis that of a force no larger than the joint's torque in the logs, too.
  /// The default is beyond every machine in SI units, and catches a number in others.
  double largest = 1e6;

  [[nodiscard]] constexpr bool positive() const { return sign == Sign::positive; }
  [[nodiscard]] constexpr Range range() const { return {positive() ? 0 : -largest, largest, false}; }
};

/// A few constants in a row, without heap.
template <class Item, std::size_t kMost>
struct Few {
  Item items[kMost] = {};
  std::size_t count = 0;

  constexpr Few() = default;
  constexpr Few(std::initializer_list<Item> list) {
    for (const Item& item : list) items[count++] = item;
  }
  [[nodiscard]] constexpr std::size_t size() const { return count; }
  [[nodiscard]] constexpr bool empty() const { return count == 0; }
  [[nodiscard]] constexpr const Item& operator[](std::size_t k) const { return items[k]; }
  [[nodiscard]] constexpr const Item& front() const { return items[0]; }
  [[nodiscard]] constexpr const Item* begin() const { return items; }
  [[nodiscard]] constexpr const Item* end() const { return items + count; }
};

constexpr std::size_t kMostAmplitudes = 6;
constexpr std::size_t kMostShapes = 3;

/// How far the effect's law is from what machines do; no residual tells. The shares are about twice what hidden effects
/// leave that were made in other forms than the law's, by a simulation and by an independent plant.
struct FormShare {
  /// Standard deviation of an amplitude, of its size: the column is not quite what the machine does
  double amplitude = 0.03;
  double own = 0.05;    ///< of the effect's gain, left at its place for effects that depend on the same ...
  double other = 0.02;  ///< ... and for all others
};

/// Parameter of the model that is the effect, in models that have it.
enum class BaseTerm {
  none,
  offset,         ///< driveK.offset
  rotor_inertia,  ///< driveK.rotor_inertia, and the inertia of an axis or of the tool
  limb,           ///< the arm of a limb with parameters of its own
  torque_scale    ///< of a drive alone: scales all its parameters
};

/// What a shape says of friction beyond the speeds that were seen.
enum class Course {
  not_by_rate,   ///< nothing
  open,          ///< it goes on growing
  ends_at_rate,  ///< the bend is over some times its first shape parameter, a rate
  endless        ///< it never ends
};

/// Terms of the model itself that other parts of the model read as this effect.
enum class Role {
  none,
  bristle,  ///< driveK.presliding rows
  wave      ///< driveK.rippleI rows
};

struct EffectTraits {
  std::string_view name, alias;  ///< a contract with files and command lines; the alias may be empty
  EffectClass effect_class = EffectClass::velocity_shape;
  EffectPlace place = EffectPlace::drive;
  Few<AmplitudeTraits, kMostAmplitudes> amplitudes;
  Few<ShapeTraits, kMostShapes> shapes;
  bool tied = false;          ///< the first shape parameter is the amplitude, too (a delay, a time constant)
  bool memory = false;        ///< has a state: needs the rows near reversals
  bool by_direction = false;  ///< friction that differs by direction, which it may do by rate, place or time
  FormShare form;
  BaseTerm base_term = BaseTerm::none;
  Role role = Role::none;
  Few<std::string_view, 2> special_cases;  ///< names of simpler effects that this one holds
  double simpler_gain = 0.95;              ///< share of its gain from which a special case is preferred
  std::string_view meaning;                ///< in plain words: what it is
  std::string_view shows;                  ///< how it shows
  std::string_view remedy;                 ///< what to do about it on the machine

  // What only some effects have to say; null: nothing.
  /// Is the parameter a mere unit beside the others, so that one start value (the last) serves?
  bool (*is_unit)(std::size_t parameter, const double* shape) = nullptr;
  /// Do the amplitudes lie so near a special case that only the form of the law can have parted them?
  bool (*nearly_special)(const double* amplitude) = nullptr;
  /// Does it act below a small share of the largest rate only, as friction near rest does that is not Coulomb's?
  bool (*only_near_rest)(const double* shape, double largest_rate) = nullptr;
  Course (*course)(const double* shape) = nullptr;
  /// Resonance that the amplitude stands for [Hz]; in the logs' band it would show as such.
  double (*resonance_hz)(const double* amplitude) = nullptr;
};

}  // namespace deltadyn
