#include "deltadyn/io/effect_file.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

namespace {

using Eigen::Index;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kVersion = "deltadyn effects";  // begins the comment on top

/// Refuses a file of another version. One without the comment was written by hand.
void check_version(const CsvReader& table) {
  const auto version = table.comment(kVersion);
  if (!version || *version == std::to_string(kEffectFileVersion)) return;
  throw Error(fmt::format("the effect file is of {}, this program reads version {}",
                          version->empty() ? "no version" : "version " + *version, kEffectFileVersion),
              place(table.path(), 1), "run delta-diagnose again with --effects-out to write it anew");
}

/// Place of a parameter among shapes and amplitudes.
struct Slot {
  bool amplitude;
  Index index;
  std::string unit;
  bool of_logs = false;  ///< names of logs may stand for the number of one
};

const Slot* find_slot(const std::vector<std::pair<std::string, Slot>>& slots, std::string_view name) {
  for (const auto& [slot_name, slot] : slots) {
    if (slot_name == name) return &slot;
  }
  return nullptr;
}

/// A shape that is the amplitude, too, stands in the file once.
std::vector<std::pair<std::string, Slot>> slots_of(const EffectKind& kind, int joint, const RobotDescription& robot) {
  std::vector<std::pair<std::string, Slot>> slots;
  for (std::size_t k = 0; k < kind.amplitudes.size(); ++k) {
    slots.emplace_back(kind.amplitudes[k].name,
                       Slot{true, static_cast<Index>(k), effect_unit(kind.amplitudes[k].unit, joint, robot), false});
  }
  for (std::size_t k = kind.tied ? 1 : 0; k < kind.shapes.size(); ++k) {
    slots.emplace_back(kind.shapes[k].name,
                       Slot{false, static_cast<Index>(k), effect_unit(kind.shapes[k].unit, joint, robot),
                            kind.shapes[k].scale == ShapeScale::logs});
  }
  return slots;
}

/// An effect while its rows come in, with the line of each parameter.
struct ReadEffect {
  Effect effect;
  long first_line = 0;
  std::map<std::string, long, std::less<>> lines;

  [[nodiscard]] double& value(const Slot& slot) {
    return (slot.amplitude ? effect.amplitude : effect.shape)(slot.index);
  }
};

ReadEffect nothing_of(const EffectKind& kind, int joint, long line) {
  ReadEffect out;
  out.first_line = line;
  out.effect.id = kind.id;
  out.effect.joint = joint;
  out.effect.amplitude = out.effect.amplitude_std =
      Eigen::VectorXd::Constant(static_cast<Index>(kind.amplitudes.size()), kNone);
  out.effect.shape = out.effect.shape_std = Eigen::VectorXd::Constant(static_cast<Index>(kind.shapes.size()), kNone);
  return out;
}

/// The columns of the file.
class EffectTable {
 public:
  explicit EffectTable(const std::string& path) : rows(path) { check_version(rows); }
  [[nodiscard]] std::string_view text(std::size_t column) const { return rows.text(column); }
  [[nodiscard]] std::string here(const char* column) const { return place(rows.path(), rows.line(), column); }

  CsvReader rows;
  std::size_t effect = require("effect"), joint = require("joint"), parameter = require("parameter"),
              value = require("value"), unit = require("unit");
  std::optional<std::size_t> deviation = rows.find("std");

 private:
  [[nodiscard]] std::size_t require(const char* name) const {
    if (const auto found = rows.find(name)) return *found;
    throw Error(fmt::format("the column '{}' is missing", name), rows.path(),
                "write the columns effect,joint,parameter,value,unit,std");
  }
};

const EffectKind& kind_in(const EffectTable& table) {
  const EffectKind* kind = find_effect_kind(table.text(table.effect));
  if (kind != nullptr) return *kind;
  throw Error(fmt::format("there is no effect '{}' in the catalogue", table.text(table.effect)), table.here("effect"),
              "delta-diagnose --list-effects shows the names; a file of an older version must be written anew");
}

void read_parameter(const EffectTable& table, const EffectKind& kind, const RobotDescription& robot, ReadEffect& into) {
  const auto slots = slots_of(kind, into.effect.joint, robot);
  const std::string name(table.text(table.parameter));
  const Slot* slot = find_slot(slots, name);
  if (slot == nullptr) {
    std::string choice;
    for (const auto& entry : slots) choice += (choice.empty() ? "" : ", ") + entry.first;
    throw Error(fmt::format("the effect {} has no parameter '{}'", kind.name, name), table.here("parameter"),
                "its parameters are " + choice);
  }
  const auto [before, fresh] = into.lines.emplace(name, table.rows.line());
  if (!fresh) {
    throw Error(fmt::format("{} of {} at {} is there twice, first in line {}", name, kind.name,
                            effect_joint_name(kind.id, into.effect.joint), before->second),
                table.here("parameter"), "leave one of the rows out: there is one effect of a kind at a joint");
  }
  if (table.text(table.unit) != slot->unit) {
    throw Error(fmt::format("the unit '{}' is not that of the parameter", table.text(table.unit)), table.here("unit"),
                "give the value in '" + slot->unit + "'");
  }
  const std::string value(table.text(table.value));
  if (slot->of_logs && !value.empty() && value.find_first_not_of("0123456789.eE+-") != std::string::npos) {
    into.value(*slot) = 1;  // no log's number counts where names stand
    std::istringstream names(value);
    for (std::string log; std::getline(names, log, ';');) into.effect.logs.push_back(bare_name(log));
  } else {
    into.value(*slot) = table.rows.number(table.value);
  }
  if (table.deviation && !table.text(*table.deviation).empty())
    (slot->amplitude ? into.effect.amplitude_std : into.effect.shape_std)(slot->index) =
        table.rows.number(*table.deviation);
}

/// Fills in what may be left out, and refuses what may not, and sizes that cannot be.
void complete(const std::string& path, const RobotDescription& robot, ReadEffect& read) {
  Effect& effect = read.effect;
  const EffectKind& kind = effect_kind(effect.id);
  if (kind.tied) effect.shape(0) = effect.amplitude(0);
  for (Index k = 0; k < effect.shape.size(); ++k) {
    if (std::isnan(effect.shape(k))) effect.shape(k) = kind.shapes[static_cast<std::size_t>(k)].otherwise;
  }
  for (const auto& [name, slot] : slots_of(kind, effect.joint, robot)) {
    if (!std::isnan(read.value(slot))) continue;
    const std::string joint = effect_joint_name(effect.id, effect.joint);
    throw Error(fmt::format("{} of {} at {} is missing", name, kind.name, joint), place(path, read.first_line),
                fmt::format("add a row {},{},{},VALUE,{},", kind.name, joint, name, slot.unit));
  }
  const auto where = [&](std::string_view name) {
    const auto line = read.lines.find(name);
    return place(path, line == read.lines.end() ? read.first_line : line->second, "value");
  };
  check_sizes(effect, where, ExitCode::bad_input);
}

}  // namespace

std::vector<Effect> read_effects(const std::string& path, const RobotDescription& robot) {
  EffectTable table(path);
  std::vector<ReadEffect> found;
  while (table.rows.next_row()) {
    const EffectKind& kind = kind_in(table);
    const int joint = effect_joint(kind.id, table.text(table.joint), robot, table.here("joint"));
    auto one = std::find_if(found.begin(), found.end(), [&](const ReadEffect& read) {
      return read.effect.id == kind.id && read.effect.joint == joint;
    });
    if (one == found.end()) one = found.insert(found.end(), nothing_of(kind, joint, table.rows.line()));
    read_parameter(table, kind, robot, *one);
  }
  std::vector<Effect> effects;
  for (ReadEffect& read : found) {
    complete(path, robot, read);
    effects.push_back(std::move(read.effect));
  }
  return effects;
}

void write_effects(const std::string& path, const std::vector<Effect>& effects, const RobotDescription& robot) {
  OutputFile file(path);
  file.print("# {} {}\neffect,joint,parameter,value,unit,std\n", kVersion, kEffectFileVersion);
  for (const Effect& effect : effects) {
    const EffectKind& kind = effect_kind(effect.id);
    for (const auto& [name, slot] : slots_of(kind, effect.joint, robot)) {
      const Eigen::VectorXd& std = slot.amplitude ? effect.amplitude_std : effect.shape_std;
      const bool has_std = std.size() > slot.index && std::isfinite(std(slot.index));
      const double number = (slot.amplitude ? effect.amplitude : effect.shape)(slot.index);
      const bool names = slot.of_logs && !effect.logs.empty();
      file.print("{},{},{},{},{},{}\n", kind.name, effect_joint_name(effect.id, effect.joint), name,
                 names ? fmt::format("{}", fmt::join(effect.logs, ";")) : fmt::format("{}", number), slot.unit,
                 has_std ? fmt::format("{}", std(slot.index)) : std::string());
    }
  }
  file.commit();
}

}  // namespace deltadyn
