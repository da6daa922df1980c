#include "deltadyn/io/parameter_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <iterator>
#include <map>
#include <optional>
#include <unordered_set>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/plausibility.hpp"

#include "recording/field.hpp"

namespace deltadyn {
namespace {

namespace fs = std::filesystem;

const std::string kPresliding = "presliding";  // not a column of the regressor: the shape of a joint's Coulomb friction

const std::string kEffects = "effects:";  // begins the comment that names the effect file

/// A file's name as the folder of another one sees it.
std::string seen_from(const std::string& path, const std::string& file) {
  if (file == kEffectsNotWritten) return file;
  const fs::path folder = fs::absolute(path).parent_path();
  const fs::path relative = fs::absolute(file).lexically_normal().lexically_relative(folder.lexically_normal());
  return relative.empty() ? file : relative.generic_string();
}

/// Rows that are no parameter of the regressor and that nobody misses there (extra_rows.hpp).
bool is_extra(const std::string& name) {
  return name.ends_with("." + kPresliding) || name.ends_with("." + kPresliding + "_damping") ||
         name.find(".ripple") != std::string::npos;
}

/// One spelling for "kg*m^2", "kg m2" and "kgm²"; an angle in rad counts as a pure number.
std::string canonical_unit(const std::string& unit) {
  std::string result = forms::with_each(forms::with_each(unit, "²", "2"), "·", "");
  std::erase_if(result, [](char c) { return std::string_view(" *^()").find(c) != std::string_view::npos; });
  if (const auto angle = result.find("/rad"); angle != std::string::npos) result.erase(angle, 4);
  return result;
}

/// Units that fit the part of the name behind the dot; empty if the name is not one we know.
std::vector<std::string> plausible_units(const std::string& name) {
  const auto dot = name.rfind('.');
  const std::string quantity = dot == std::string::npos ? name : name.substr(dot + 1);
  for (int k = 0; k < kInertialParameters; ++k)
    if (quantity == kInertialNames[k]) return {kInertialUnits[k]};
  if (const auto id = parameter_id("drive1." + quantity))
    return {parameter_unit(*id, true), parameter_unit(*id, false)};
  if (quantity == kPresliding) return {"rad", "m"};
  if (quantity == kPresliding + "_damping") return {"s"};
  if (quantity == "waves") return {"waves/turn", "waves/m", "1/rad", "1/m"};
  if (quantity == "cosine" || quantity == "sine") return {"N*m", "N"};
  return {};
}

bool same_unit(const std::string& a, const std::string& b) {
  return canonical_unit(a) == canonical_unit(b);
}

/// "upper_arm2.m" -> "upper_arm.m"; empty if the name is not one of a single limb.
std::string shared_name(const std::string& name) {
  std::optional<ParameterId> id = parameter_id(name);
  if (!id || id->kind != ParameterKind::inertial || id->number == 0) return {};
  if (id->body != Body::upper_arm && id->body != Body::strut) return {};
  id->number = 0;
  return parameter_name(*id);
}

}  // namespace

const ParameterEntry* ParameterTable::find(const std::string& name) const {
  const auto found = std::ranges::find(entries, name, &ParameterEntry::name);
  return found == entries.end() ? nullptr : &*found;
}

ParameterTable read_parameters(const std::string& path) {
  const CsvTable csv = read_csv(path);
  const std::size_t name_column = csv.require("name");
  const std::size_t value_column = csv.require("value");
  const std::size_t unit_column = csv.require("unit");
  const auto std_column = csv.find("std");
  const auto prior_column = csv.find("prior");
  const auto share_column = csv.find("data_share");
  // What is not known is an empty field.
  const auto optional_number = [&](std::size_t row, std::optional<std::size_t> column) {
    if (!column || csv.text(row, *column).empty()) return std::numeric_limits<double>::quiet_NaN();
    return csv.number(row, *column);
  };

  ParameterTable table;
  table.file = path;
  if (const auto effects = csv.comment(kEffects); effects && !effects->empty())
    table.effects = *effects == kEffectsNotWritten ? *effects : (fs::path(path).parent_path() / *effects).string();
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    ParameterEntry entry;
    entry.line = csv.line(row);
    entry.name = csv.text(row, name_column);
    entry.unit = csv.text(row, unit_column);
    if (entry.name.empty())
      throw Error("the name is empty", place(path, entry.line, "name"), "name the parameter or remove the row");
    if (const ParameterEntry* first = table.find(entry.name)) {
      throw Error(fmt::format("the parameter {} was already given in line {}", entry.name, first->line),
                  place(path, entry.line, "name"), "keep one of the two rows");
    }
    entry.value = csv.number(row, value_column);
    entry.std = optional_number(row, std_column);
    entry.prior = optional_number(row, prior_column);
    entry.data_share = optional_number(row, share_column);
    const auto units = plausible_units(entry.name);
    if (!units.empty() &&
        std::ranges::none_of(units, [&](const std::string& unit) { return same_unit(unit, entry.unit); })) {
      throw Error(fmt::format("the unit '{}' does not fit {}", entry.unit, entry.name), place(path, entry.line, "unit"),
                  fmt::format("give the value in {}", fmt::join(units, " or ")));
    }
    if (entry.std < 0) {
      throw Error(fmt::format("the standard deviation of {} is negative", entry.name), place(path, entry.line, "std"),
                  "leave the field empty if it is not known");
    }
    if (entry.data_share < 0 || entry.data_share > 1) {
      throw Error(fmt::format("the data_share of {} is outside 0 to 1", entry.name),
                  place(path, entry.line, "data_share"), "leave the field empty if it is not known");
    }
    table.entries.push_back(std::move(entry));
  }
  return table;
}

ParameterTable read_parameters(const std::string& path, const RobotDescription& robot) {
  ParameterTable table = read_parameters(path);
  struct FileBody {
    Body kind;
    long line;  // of the first row
    InertialVector<double> p = InertialVector<double>::Zero();
  };
  std::map<std::string, FileBody> bodies;
  for (const ParameterEntry& entry : table.entries) {
    const auto id = parameter_id(entry.name);
    if (!id) continue;
    if (id->kind == ParameterKind::inertial) {
      bodies.try_emplace(owner_name(*id), FileBody{id->body, entry.line}).first->second.p(id->entry) = entry.value;
    } else {
      plausibility::require_joint_parameter(id->kind, entry.value, entry.name, place(path, entry.line, "value"));
    }
  }
  for (const auto& [name, body] : bodies)
    plausibility::require_body(robot, body.kind, body.p, name, place(path, body.line, "value"));
  return table;
}

std::string missing_effects(const ParameterTable& table, const std::string& effects_given) {
  if (table.effects.empty() || !effects_given.empty()) return {};
  if (table.effects == kEffectsNotWritten) {
    return table.file +
           " holds only together with effects that were not written: run delta-diagnose again with --effects-out FILE, "
           "and give --effects FILE";
  }
  std::error_code ignored;
  const std::string text = fmt::format("{} holds only together with the effects of {}", table.file, table.effects);
  if (fs::exists(table.effects, ignored)) return fmt::format("{}: give --effects {}", text, table.effects);
  return fmt::format("{}, which is not there: give --effects with the place of {}", text,
                     fs::path(table.effects).filename().string());
}

void write_parameters(const std::string& path, const ParameterTable& table) {
  struct Extra {
    const char* column;
    double ParameterEntry::*member;
    bool used;
  };
  std::array<Extra, 3> extras = {{{"std", &ParameterEntry::std, false},
                                  {"prior", &ParameterEntry::prior, false},
                                  {"data_share", &ParameterEntry::data_share, false}}};
  for (Extra& extra : extras) {
    extra.used = std::ranges::any_of(
        table.entries, [](double value) { return !std::isnan(value); }, extra.member);
  }
  std::string text = table.remark.empty() ? "" : "# " + table.remark + "\n";
  if (!table.effects.empty()) text += fmt::format("# {} {}\n", kEffects, seen_from(path, table.effects));
  text += "name,value,unit";
  for (const Extra& extra : extras) {
    if (extra.used) text += fmt::format(",{}", extra.column);
  }
  text += '\n';
  for (const ParameterEntry& entry : table.entries) {
    if (!std::isfinite(entry.value)) {
      throw Error(fmt::format("the value of {} is not finite", entry.name), path, "", ExitCode::no_convergence);
    }
    fmt::format_to(std::back_inserter(text), "{},{},{}", entry.name, entry.value, entry.unit);
    for (const Extra& extra : extras) {
      if (!extra.used) continue;
      text += ',';
      if (std::isfinite(entry.*extra.member)) fmt::format_to(std::back_inserter(text), "{}", entry.*extra.member);
    }
    text += '\n';
  }
  write_file(path, text);
}

namespace {

/// Of another robot's file a body would be counted as none at all: one is missing, and one is nobody's. Base parameters
/// may leave out a body that others carry along.
void require_own_bodies(const ParameterTable& table, const std::vector<std::string>& names,
                        const std::vector<std::string>& missing, const std::vector<const ParameterEntry*>& foreign) {
  const auto is_mass = [](const ParameterEntry* entry) { return entry->name.ends_with(".m"); };
  const auto stranger = std::ranges::find_if(foreign, is_mass);
  if (stranger == foreign.end()) return;
  for (const std::string& name : missing) {
    if (!name.ends_with(".m")) continue;
    const std::string body = name.substr(0, name.size() - 1);
    const auto of_body = [&body](const std::string& other) { return other.starts_with(body); };
    if (std::ranges::count_if(missing, of_body) < std::ranges::count_if(names, of_body)) continue;
    throw Error(
        fmt::format("the file has no value of {}, a body of this robot, but {}, which is none of its parameters",
                    name.substr(0, name.size() - 2), (*stranger)->name),
        place(table.file, (*stranger)->line),
        "check that this is the parameter file of this robot; delta-model prior writes one with all names");
  }
}

}  // namespace

ParameterMatch match_parameters(const ParameterTable& table, const std::vector<std::string>& names,
                                const std::vector<std::string>& units) {
  if (!units.empty() && units.size() != names.size()) {
    throw Error("as many units as names are needed", table.file, "", ExitCode::usage);
  }
  const auto count = static_cast<Eigen::Index>(names.size());
  ParameterMatch match;
  match.value = match.prior = Eigen::VectorXd::Zero(count);
  match.std = Eigen::VectorXd::Constant(count, std::numeric_limits<double>::quiet_NaN());
  std::unordered_set<const ParameterEntry*> used;
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    const ParameterEntry* found = table.find(name);
    if (found == nullptr) found = table.find(shared_name(name));
    if (found == nullptr) {
      match.missing.push_back(name);
      continue;
    }
    const ParameterEntry& entry = *found;
    if (!units.empty() && !same_unit(entry.unit, units[static_cast<std::size_t>(i)])) {
      throw Error(fmt::format("the unit '{}' does not fit {} of this robot", entry.unit, name),
                  place(table.file, entry.line, "unit"),
                  fmt::format("give the value in {}", units[static_cast<std::size_t>(i)]));
    }
    used.insert(&entry);
    match.value(i) = entry.value;
    match.std(i) = entry.std;
    match.prior(i) = std::isfinite(entry.prior) ? entry.prior : entry.value;
  }
  if (used.empty() && !names.empty()) {
    throw Error(fmt::format("none of the robot's parameters is in the file (for example {})", names.front()),
                table.file, "check that this is the parameter file of this robot");
  }
  std::vector<const ParameterEntry*> foreign;
  for (const ParameterEntry& entry : table.entries) {
    if (used.count(&entry) != 0 || is_extra(entry.name)) continue;
    foreign.push_back(&entry);
    // Taking zero here, because the limbs' values have other names, would be a silent and gross error.
    if (const std::string shared = shared_name(entry.name);
        std::ranges::find(match.missing, shared) != match.missing.end()) {
      throw Error(
          fmt::format("the file gives {} of one limb, but {} shared by all limbs is needed", entry.name, shared),
          place(table.file, entry.line, "name"), "use --individual-limbs, or give the shared value");
    }
    match.warnings.push_back(fmt::format("{}: {} is not a parameter of this robot and is not used",
                                         place(table.file, entry.line), entry.name));
  }
  require_own_bodies(table, names, match.missing, foreign);
  if (!match.missing.empty())
    match.warnings.push_back(fmt::format("{}: not in the file and counted as 0 ({}): {}", table.file,
                                         match.missing.size(), fmt::join(match.missing, " ")));
  return match;
}

ParameterOptions parameter_options_of(const ParameterTable& table, const RobotDescription& robot) {
  const auto any = [&table](const auto& of_it) {
    return std::ranges::any_of(table.entries, of_it, &ParameterEntry::name);
  };
  ParameterOptions options;
  options.individual_limbs = any([](const std::string& name) { return !shared_name(name).empty(); });
  options.tool = any([](const std::string& name) {
    const auto id = parameter_id(name);
    return id && id->kind == ParameterKind::inertial && id->body == Body::tool;
  });
  for (int drive = 1; drive <= robot.drives(); ++drive) {
    if (table.find(fmt::format("drive{}.rotor_inertia", drive)) != nullptr) options.rotor_inertia.push_back(drive);
    options.offset = options.offset || table.find(fmt::format("drive{}.offset", drive)) != nullptr;
  }
  return options;
}

Eigen::VectorXd values(const ParameterTable& table, const std::vector<std::string>& names,
                       const std::vector<std::string>& units) {
  return match_parameters(table, names, units).value;
}

}  // namespace deltadyn
