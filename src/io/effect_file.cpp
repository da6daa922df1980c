#include "deltadyn/io/effect_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <limits>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

namespace {

using Eigen::Index;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The version in the comment on top; -1 if there is none (a file written by hand).
int version_of(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  int version = -1;
  while (std::getline(file, line) && !line.empty() && line[0] == '#') {
    if (std::sscanf(line.c_str(), "# deltadyn effects %d", &version) == 1) return version;
  }
  return -1;
}

/// Place of a parameter among shapes and amplitudes.
struct Slot {
  std::string name;
  bool amplitude;
  Index index;
  std::string unit;
};

/// A shape that is the amplitude, too, stands in the file once.
std::vector<Slot> slots_of(const EffectKind& kind, int joint, const RobotDescription& robot) {
  std::vector<Slot> slots;
  const auto add = [&](const auto& parameter, bool amplitude, std::size_t index) {
    slots.push_back(
        {std::string(parameter.name), amplitude, static_cast<Index>(index), effect_unit(parameter.unit, joint, robot)});
  };
  for (std::size_t k = 0; k < kind.amplitudes.size(); ++k) add(kind.amplitudes[k], true, k);
  for (std::size_t k = kind.tied ? 1 : 0; k < kind.shapes.size(); ++k) add(kind.shapes[k], false, k);
  return slots;
}

}  // namespace

std::vector<Effect> read_effects(const std::string& path, const RobotDescription& robot) {
  const int version = version_of(path);
  if (version != -1 && version != kEffectFileVersion) {
    throw Error(fmt::format("the effect file is of version {}, this program reads version {}", version, kEffectFileVersion),
                place(path, 1), "run delta-diagnose again with --effects-out to write it anew");
  }
  std::vector<Effect> effects;
  CsvReader table(path);
  const auto require = [&](const char* name) {
    const auto found = table.find(name);
    if (!found) {
      throw Error(fmt::format("the column '{}' is missing", name), path,
                  "write the columns effect,joint,parameter,value,unit,std");
    }
    return *found;
  };
  const std::size_t effect_column = require("effect"), joint_column = require("joint"), parameter_column = require("parameter");
  const std::size_t value_column = require("value"), unit_column = require("unit");
  const auto std_column = table.find("std");
  while (table.next_row()) {
    const std::string name(table.text(effect_column));
    const EffectKind* kind = find_effect_kind(name);
    if (kind == nullptr) {
      throw Error("there is no effect '" + name + "' in the catalogue", place(path, table.line(), "effect"),
                  "delta-diagnose --list-effects shows the names; a file of an older version must be written anew");
    }
    const int joint = effect_joint(kind->id, table.text(joint_column), robot, place(path, table.line(), "joint"));
    auto known = std::ranges::find_if(effects, [&](const Effect& other) { return other.id == kind->id && other.joint == joint; });
    if (known == effects.end()) {
      Effect fresh;
      fresh.id = kind->id;
      fresh.joint = joint;
      fresh.amplitude = fresh.amplitude_std = Eigen::VectorXd::Constant(static_cast<Index>(kind->amplitudes.size()), kNone);
      fresh.shape = fresh.shape_std = Eigen::VectorXd::Constant(static_cast<Index>(kind->shapes.size()), kNone);
      known = effects.insert(effects.end(), fresh);
    }
    Effect& effect = *known;
    const auto slots = slots_of(*kind, joint, robot);
    const auto slot = std::ranges::find(slots, table.text(parameter_column), &Slot::name);
    if (slot == slots.end()) {
      std::string choice;
      for (const Slot& entry : slots) choice += (choice.empty() ? "" : ", ") + entry.name;
      throw Error(fmt::format("the effect {} has no parameter '{}'", name, table.text(parameter_column)),
                  place(path, table.line(), "parameter"), "its parameters are " + choice);
    }
    double& value = (slot->amplitude ? effect.amplitude : effect.shape)(slot->index);
    if (!std::isnan(value)) {
      throw Error(fmt::format("{} of {} is there twice", table.text(parameter_column), name),
                  place(path, table.line(), "parameter"), "leave one of the rows out");
    }
    if (table.text(unit_column) != slot->unit) {
      throw Error(fmt::format("the unit '{}' is not that of the parameter", table.text(unit_column)),
                  place(path, table.line(), "unit"), "give the value in '" + slot->unit + "'");
    }
    value = table.number(value_column);
    if (std_column && !table.text(*std_column).empty()) {
      (slot->amplitude ? effect.amplitude_std : effect.shape_std)(slot->index) = table.number(*std_column);
    }
  }
  for (Effect& effect : effects) {
    const EffectKind& kind = effect_kind(effect.id);
    if (kind.tied) effect.shape(0) = effect.amplitude(0);
    for (Index k = 0; k < effect.shape.size(); ++k) {
      if (std::isnan(effect.shape(k))) effect.shape(k) = kind.shapes[static_cast<std::size_t>(k)].otherwise;
    }
    for (const Slot& slot : slots_of(kind, effect.joint, robot)) {
      if (std::isnan((slot.amplitude ? effect.amplitude : effect.shape)(slot.index))) {
        throw Error(fmt::format("{} of {} at {} is missing", slot.name, kind.name, effect_joint_name(effect.id, effect.joint)),
                    path, "add a row for it");
      }
    }
    check_sizes(effect, path, ExitCode::bad_input);
  }
  return effects;
}

void write_effects(const std::string& path, const std::vector<Effect>& effects, const RobotDescription& robot) {
  OutputFile file(path);
  file.print("# deltadyn effects {}\neffect,joint,parameter,value,unit,std\n", kEffectFileVersion);
  for (const Effect& effect : effects) {
    const EffectKind& kind = effect_kind(effect.id);
    for (const Slot& slot : slots_of(kind, effect.joint, robot)) {
      const Eigen::VectorXd& std = slot.amplitude ? effect.amplitude_std : effect.shape_std;
      const bool has_std = std.size() > slot.index && std::isfinite(std(slot.index));
      file.print("{},{},{},{},{},{}\n", kind.name, effect_joint_name(effect.id, effect.joint), slot.name,
                 (slot.amplitude ? effect.amplitude : effect.shape)(slot.index), slot.unit,
                 has_std ? fmt::format("{}", std(slot.index)) : std::string());
    }
  }
  file.commit();
}

}  // namespace deltadyn
