#include "deltadyn/runtime/effect_catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

namespace {

template <class... Effects>
std::vector<EffectKind> kinds_of(EffectList<Effects...>) {
  static_assert(((Effects::traits().memory == kIs<Effects, JointMemory>)&&...),
                "the trait `memory` is that of a JointMemory, and of no other kind");
  std::vector<EffectKind> kinds;
  (kinds.push_back({Effects::traits(), effect_id<Effects>}), ...);
  return kinds;
}

void require_in(const Range& range, const EffectKind& kind, std::string_view name, double value,
                const std::string& where, ExitCode code) {
  if (range.holds(value)) return;
  const std::string what = fmt::format("{} of {}", name, kind.name);
  if (range.lowest == 0 && !(value > 0))
    throw Error(fmt::format("{} {}", what, range.open ? "must be positive" : "cannot be negative"), where,
                range.open ? "give a number above 0" : "give a positive number", code);
  throw Error(fmt::format("{} is {}, beyond its {} value", what, value, value < range.lowest ? "smallest" : "largest"),
              where, fmt::format("give a number from {} to {}", range.lowest, range.highest), code);
}

[[noreturn]] void refuse_joint(const EffectKind& kind, std::string_view name, const std::string& where,
                               const std::string& mend) {
  throw Error(fmt::format("the effect {} cannot act at '{}'", kind.name, name), where, mend);
}

}  // namespace

const std::vector<EffectKind>& effect_catalogue() {
  static const std::vector<EffectKind> catalogue = kinds_of(AllEffects());
  return catalogue;
}

const EffectKind& effect_kind(EffectId id) {
  return effect_catalogue().at(static_cast<std::size_t>(id));
}

EffectId effect_with(Role role) {
  const auto& all = effect_catalogue();
  const auto found = std::find_if(all.begin(), all.end(), [role](const EffectKind& kind) { return kind.role == role; });
  if (found == all.end())
    throw Error("no effect of the list stands for this term of the model", "", "", ExitCode::usage);
  return found->id;
}

bool of_one_log(EffectId id) {
  const auto& shapes = effect_kind(id).shapes;
  return std::any_of(shapes.begin(), shapes.end(),
                     [](const ShapeTraits& one) { return one.scale == ShapeScale::logs; });
}

std::string bare_name(const std::string& file) {
  return file.substr(file.find_last_of("/\\") + 1);
}

std::vector<Effect> effects_in_log(std::vector<Effect> effects, const std::string& file, int number) {
  const std::string name = bare_name(file);
  for (Effect& effect : effects) {
    if (effect.logs.empty()) continue;
    const bool here = std::find(effect.logs.begin(), effect.logs.end(), name) != effect.logs.end();
    const auto& shapes = effect_kind(effect.id).shapes;
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      if (shapes[k].scale == ShapeScale::logs) effect.shape(static_cast<Eigen::Index>(k)) = here ? number : -1;
    }
  }
  return effects;
}

std::vector<double> start_values(const ShapeTraits& shape) {
  const std::size_t count = static_cast<std::size_t>(shape.count);
  if (shape.grid == ShapeTraits::Grid::listed) return {shape.start, shape.start + count};
  std::vector<double> values;
  for (std::size_t k = 0; k < count; ++k) {
    const double share = count > 1 ? static_cast<double>(k) / static_cast<double>(count - 1) : 0.0;
    values.push_back(shape.start[0] * std::pow(shape.start[1] / shape.start[0], share));
  }
  if (shape.grid == ShapeTraits::Grid::logarithmic_both_signs) {
    for (std::size_t k = 0; k < count; ++k) values.push_back(-values[k]);
  }
  return values;
}

Shape<double> shape_of(EffectId id, const Eigen::VectorXd& shape) {
  const EffectKind& kind = effect_kind(id);
  Shape<double> out{};
  for (std::size_t k = 0; k < kind.shapes.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const double otherwise = kind.shapes[k].otherwise;
    out[k] = at < shape.size() ? shape(at) : (std::isnan(otherwise) ? 0.0 : otherwise);
  }
  return out;
}

Shape<double> shape_of(const Effect& effect) {
  return shape_of(effect.id, effect.shape);
}

std::array<double, kMostAmplitudes> amplitudes_of(const Effect& effect) {
  std::array<double, kMostAmplitudes> out{};
  for (Eigen::Index k = 0; k < effect.amplitude.size(); ++k) out[static_cast<std::size_t>(k)] = effect.amplitude(k);
  return out;
}

void check_sizes(const Effect& effect, const std::function<std::string(std::string_view)>& where, ExitCode code) {
  const EffectKind& kind = effect_kind(effect.id);
  const auto amplitude = amplitudes_of(effect);
  const Shape<double> shape = shape_of(effect);
  for (std::size_t k = 0; k < kind.amplitudes.size(); ++k) {
    const AmplitudeTraits& one = kind.amplitudes[k];
    require_in(one.range(), kind, one.name, amplitude[k], where(one.name), code);
  }
  for (std::size_t k = kind.tied ? 1 : 0; k < kind.shapes.size(); ++k) {
    const ShapeTraits& one = kind.shapes[k];
    const std::vector<double> choice = one.scale == ShapeScale::choice ? start_values(one) : std::vector<double>();
    if (!choice.empty() && std::find(choice.begin(), choice.end(), shape[k]) == choice.end())
      throw Error(fmt::format("{} of {} is {}, which is none of its values", one.name, kind.name, shape[k]),
                  where(one.name), fmt::format("give one of {}", fmt::join(choice, ", ")), code);
    if (one.scale == ShapeScale::logs && !(shape[k] >= 1 && shape[k] == std::floor(shape[k])))
      throw Error(fmt::format("{} of {} is {}, which is no number of a log", one.name, kind.name, shape[k]),
                  where(one.name), "give the number of the log in which it acts, from 1", code);
    if (choice.empty()) require_in(one.range, kind, one.name, shape[k], where(one.name), code);
  }
}

const EffectKind* find_effect_kind(std::string_view name) {
  for (const EffectKind& kind : effect_catalogue()) {
    if (kind.name == name || (!kind.alias.empty() && kind.alias == name)) return &kind;
  }
  return nullptr;
}

std::string effect_joint_name(EffectId id, int joint) {
  if (joint >= 0) return fmt::format("drive{}", joint + 1);
  switch (effect_kind(id).place) {
    case EffectPlace::telescope: return "telescope";
    case EffectPlace::platform: return "platform";
    default: return "robot";
  }
}

std::vector<int> effect_joints(EffectId id, const RobotDescription& robot) {
  std::vector<int> joints;
  const bool plate = !robot.parts.empty();
  const auto add_drives = [&joints](int count) {
    for (int j = 0; j < count; ++j) joints.push_back(j);
  };
  const EffectPlace place = effect_kind(id).place;
  switch (place) {
    case EffectPlace::drive: add_drives(robot.drives()); break;
    case EffectPlace::arm:
    case EffectPlace::limb:
      if (place == EffectPlace::arm && robot.drive_kind != DriveKind::revolute) break;
      if (plate) add_drives(static_cast<int>(robot.limbs.size()));
      break;
    case EffectPlace::limb_or_all:
      add_drives(plate ? static_cast<int>(robot.limbs.size()) : robot.drives());
      if (joints.size() > 1) joints.push_back(-1);
      break;
    case EffectPlace::drive_or_robot:
      if (robot.drives() > 1) joints.push_back(-1);
      add_drives(robot.drives());
      break;
    case EffectPlace::telescope:
      if (robot.telescope) joints.push_back(-1);
      break;
    case EffectPlace::passive_joints:
    case EffectPlace::platform:
    case EffectPlace::robot:
      if (plate) joints.push_back(-1);
      break;
  }
  return joints;
}

bool acts_on_all(EffectId id, int drive, const RobotDescription& robot) {
  switch (effect_kind(id).place) {
    case EffectPlace::limb_or_all: return drive >= 0 && drive < static_cast<int>(robot.limbs.size());
    case EffectPlace::drive_or_robot: return drive >= 0 && drive < robot.drives();
    default: return false;
  }
}

int effect_joint(EffectId id, std::string_view name, const RobotDescription& robot, const std::string& where) {
  std::string choice;
  const std::vector<int> joints = effect_joints(id, robot);
  for (const int joint : joints) {
    const std::string text = effect_joint_name(id, joint);
    if (name == text || (joint >= 0 && name == std::to_string(joint + 1))) return joint;
    choice += (choice.empty() ? "" : ", ") + text;
  }
  refuse_joint(effect_kind(id), name, where,
               choice.empty() ? "this robot has no such part" : "give one of these: " + choice);
}

std::string effect_unit(std::string_view unit, int joint, const RobotDescription& robot) {
  const bool turns = robot.kind_of_drive(std::max(joint, 0)) == DriveKind::revolute;
  std::string text(unit);
  const auto replace = [&text](const std::string& mark, const std::string& word) {
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark))
      text.replace(at, mark.size(), word);
  };
  replace("{F}", turns ? "N*m" : "N");
  replace("{x}", turns ? "rad" : "m");
  // Inertia in its usual unit.
  if (text == "N*m*s^2/rad") return "kg*m^2";
  if (text == "N*s^2/m") return "kg";
  return text;
}

std::string effect_shape_text(const Effect& effect, const RobotDescription& robot) {
  const EffectKind& kind = effect_kind(effect.id);
  std::string text;
  for (std::size_t k = kind.tied ? 1 : 0; k < kind.shapes.size() && static_cast<Eigen::Index>(k) < effect.shape.size();
       ++k) {
    const std::string unit = effect_unit(kind.shapes[k].unit, effect.joint, robot);
    if (kind.shapes[k].scale == ShapeScale::logs && !effect.logs.empty()) {
      for (const std::string& log : effect.logs) text += (text.empty() ? "in " : ", ") + log;
      continue;
    }
    text += fmt::format("{}{}={:.4g}{}", text.empty() ? "" : "; ", kind.shapes[k].name,
                        effect.shape(static_cast<Eigen::Index>(k)), unit.empty() ? "" : " " + unit);
  }
  return text;
}

}  // namespace deltadyn
