#pragma once

/// \file
/// The flag --effect NAME@JOINT:key=value,... and the list of what it takes.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "deltadyn/runtime/effect_catalogue.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn::tools {

/// One number of an effect, as the flag takes it.
struct EffectKey {
  std::string name, unit;  ///< unit with the catalogue's placeholders
  bool amplitude = true;   ///< else a shape
  Eigen::Index index = 0;  ///< among the amplitudes or the shapes
  Range range;
  std::vector<double> usual;        ///< values that are common; empty if that depends on the robot
  double otherwise = std::nan("");  ///< value if left out; NaN: must be given
};

/// "above 0", "1 to 6"; empty: every number.
inline std::string range_text(const Range& range) {
  if (range.lowest == 0 && range.open)
    return range.highest < 1e3 ? fmt::format("above 0, up to {}", range.highest) : "above 0";
  if (range.lowest == 0 && range.highest >= 1e3) return "not negative";
  if (range.lowest < 0 && !(range.highest < 1e3)) return "";
  return fmt::format("{} to {}", range.lowest, range.highest);
}

/// A shape that is the amplitude, too (`tied`), is one key.
inline std::vector<EffectKey> effect_keys(const EffectKind& kind) {
  std::vector<EffectKey> keys;
  for (std::size_t k = 0; k < kind.amplitudes.size(); ++k) {
    EffectKey key;
    key.name = kind.amplitudes[k].name;
    key.unit = kind.amplitudes[k].unit;
    key.index = static_cast<Eigen::Index>(k);
    key.range = kind.amplitudes[k].range();
    if (kind.amplitudes.size() > 1) key.otherwise = 0;
    keys.push_back(key);
  }
  for (std::size_t k = kind.tied ? 1 : 0; k < kind.shapes.size(); ++k) {
    const ShapeTraits& shape = kind.shapes[k];
    EffectKey key;
    key.name = shape.name;
    key.unit = shape.unit;
    key.amplitude = false;
    key.index = static_cast<Eigen::Index>(k);
    if (shape.scale != ShapeScale::choice && shape.scale != ShapeScale::logs) key.range = shape.range;
    const bool as_it_stands = shape.scale == ShapeScale::absolute || shape.scale == ShapeScale::choice;
    if (as_it_stands && shape.count <= 4) key.usual = start_values(shape);
    key.otherwise = shape.otherwise;
    if (shape.scale == ShapeScale::logs) key.otherwise = 1;  // a simulation makes one log
    keys.push_back(key);
  }
  return keys;
}

/// The first effect of the list as the flag takes it, with round numbers.
inline std::string example_effect() {
  const EffectKind& kind = effect_catalogue().front();
  std::string text;
  for (const EffectKey& key : effect_keys(kind)) {
    const double value = !key.usual.empty() ? key.usual.back() : (key.amplitude ? 2.0 : 0.25);
    text += fmt::format("{}{}={}", text.empty() ? "" : ",", key.name, value);
  }
  return fmt::format("{}@drive2:{}", kind.name, text);
}

/// Of the form of example_effect(). Throws Error(usage) that says what is known.
inline Effect parse_effect(const std::string& text, const RobotDescription& robot) {
  const auto at = text.find('@'), colon = text.find(':');
  const std::string where = "--effect " + text;
  if (at == std::string::npos || (colon != std::string::npos && colon < at)) {
    throw Error("an effect is written NAME@JOINT:key=value,...", where,
                "e.g. --effect " + example_effect() + "; --list-effects shows them all", ExitCode::usage);
  }
  const std::string name = text.substr(0, at),
                    joint = text.substr(at + 1, colon == std::string::npos ? colon : colon - at - 1);
  const EffectKind* kind = find_effect_kind(name);
  if (kind == nullptr) {
    std::string known;
    for (const EffectKind& each : effect_catalogue()) known.append(known.empty() ? "" : " ").append(each.name);
    throw Error("there is no effect '" + name + "'", where, "use one of: " + known, ExitCode::usage);
  }
  Effect effect;
  effect.id = kind->id;
  try {
    effect.joint = effect_joint(kind->id, joint, robot, where);
  } catch (const Error& e) {
    throw Error(e.problem(), e.where(), e.mend(), ExitCode::usage);  // here a flag is wrong, not a file
  }
  const double missing = std::nan("");
  effect.shape = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(kind->shapes.size()), missing);
  effect.amplitude = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(kind->amplitudes.size()), missing);
  const std::vector<EffectKey> keys = effect_keys(*kind);
  std::string known;
  for (const EffectKey& key : keys) known += (known.empty() ? "" : ", ") + key.name;
  std::istringstream entries(colon == std::string::npos ? "" : text.substr(colon + 1));
  std::set<std::string> given;
  for (std::string entry; std::getline(entries, entry, ',');) {
    const auto equal = entry.find('=');
    const std::string name_of_key = entry.substr(0, equal);
    double value = 0;
    try {
      std::size_t used = 0;
      value = std::stod(equal == std::string::npos ? "" : entry.substr(equal + 1), &used);
      if (used != entry.size() - equal - 1 || !std::isfinite(value)) throw std::invalid_argument(entry);
    } catch (const std::exception&) {
      throw Error("'" + entry + "' is not key=number", where, name + " has " + known, ExitCode::usage);
    }
    if (!given.insert(name_of_key).second)
      throw Error(name_of_key + " is given twice", where, "give each number once", ExitCode::usage);
    const auto key =
        std::find_if(keys.begin(), keys.end(), [&](const EffectKey& each) { return each.name == name_of_key; });
    if (key == keys.end())
      throw Error("the effect " + name + " has no '" + name_of_key + "'", where, "it has " + known, ExitCode::usage);
    (key->amplitude ? effect.amplitude : effect.shape)(key->index) = value;
  }
  // One of several amplitudes may be left out, but not all of them.
  const bool acts = effect.amplitude.array().isFinite().any();
  for (const EffectKey& key : keys) {
    double& value = (key.amplitude ? effect.amplitude : effect.shape)(key.index);
    if (std::isnan(value) && (acts || !key.amplitude)) value = key.otherwise;
    if (std::isnan(value))
      throw Error(key.name + " of the effect " + name + " is missing", where, "give all of " + known, ExitCode::usage);
  }
  if (kind->tied) effect.shape(0) = effect.amplitude(0);
  check_sizes(
      effect, [&where](std::string_view) { return where; }, ExitCode::usage);
  return effect;
}

/// Adds the effect of one flag to those of the file and of the flags before it, none of which may be of its kind at its
/// joint. Throws as parse_effect().
inline void add_effect(const std::string& text, const RobotDescription& robot, std::vector<Effect>& effects) {
  Effect effect = parse_effect(text, robot);
  for (const Effect& other : effects) {
    if (other.id != effect.id || other.joint != effect.joint) continue;
    throw Error(fmt::format("there is a second {} at {}", effect_kind(effect.id).name,
                            effect_joint_name(effect.id, effect.joint)),
                "--effect " + text, "give one effect of a kind at a joint, with both sizes in it", ExitCode::usage);
  }
  effects.push_back(std::move(effect));
}

/// For any robot: a unit that depends on the drive stands for both kinds, "N*m | N".
inline std::string unit_of_any_drive(std::string_view unit) {
  RobotDescription robot;
  robot.limbs.resize(1);
  robot.drive_kind = DriveKind::revolute;
  std::string text = effect_unit(unit, 0, robot);
  robot.drive_kind = DriveKind::prismatic;
  const std::string other = effect_unit(unit, 0, robot);
  if (other != text) text += " | " + other;
  return text;
}

/// The catalogue as the flag takes it: places, keys, units, limits, what may be left out, and an example of each.
inline void list_effects() {
  const auto place = [](EffectPlace where) {
    switch (where) {
      case EffectPlace::drive: return "@driveK";
      case EffectPlace::arm: return "@driveK of a limb with a revolute drive";
      case EffectPlace::limb: return "@driveK of a limb";
      case EffectPlace::limb_or_all: return "@driveK of a limb, or @robot for all limbs";
      case EffectPlace::drive_or_robot: return "@driveK, or @robot for all drives";
      case EffectPlace::telescope: return "@telescope";
      case EffectPlace::platform: return "@platform";
      default: return "@robot";
    }
  };
  fmt::print("--effect NAME@JOINT:key=value,...   K counts from 1; [unit of revolute drives | of prismatic drives]\n");
  for (const EffectKind& kind : effect_catalogue()) {
    fmt::print("\n{}{}  {}\n  {}\n  shows as: {}\n", kind.name,
               kind.alias.empty() ? "" : fmt::format(" (also {})", kind.alias), place(kind.place), kind.meaning,
               kind.shows);
    for (const EffectKey& key : effect_keys(kind)) {
      const std::string unit = unit_of_any_drive(key.unit);
      std::string text = fmt::format("    {:<24} {:<16}", key.name, unit.empty() ? "" : "[" + unit + "]");
      std::vector<std::string> notes;
      notes.push_back(range_text(key.range));
      std::string usual;
      for (const double value : key.usual) usual += fmt::format("{}{:.4g}", usual.empty() ? "" : ", ", value);
      if (!usual.empty()) notes.push_back("e.g. " + usual);
      if (!std::isnan(key.otherwise)) notes.push_back(fmt::format("{:.4g} if left out", key.otherwise));
      std::erase(notes, "");
      for (std::size_t k = 0; k < notes.size(); ++k) text += (k > 0 ? "; " : " ") + notes[k];
      while (!text.empty() && text.back() == ' ') text.pop_back();
      fmt::print("{}\n", text);
    }
  }
  fmt::print("\nExample:\n  --effect {}\n", example_effect());
}

}  // namespace deltadyn::tools
