#include "deltadyn/io/extra_rows.hpp"

#include <array>
#include <charconv>
#include <fmt/format.h>
#include <numbers>
#include <optional>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

std::string place_of(const ParameterTable& table, const ParameterEntry& entry, const char* column) {
  return fmt::format("{}, line {}, column {}", table.file, entry.line, column);
}

/// Drive (from 0) and number of "drive2.ripple1.waves"; nothing for other rows.
std::optional<std::array<int, 2>> ripple_of_waves(const std::string& name) {
  const std::string drive = "drive", ripple = ".ripple", waves = ".waves";
  const auto middle = name.find(ripple);
  if (!name.starts_with(drive) || middle == std::string::npos || !name.ends_with(waves)) return std::nullopt;
  std::array<int, 2> out{};
  const char* text = name.data();
  const auto read = [text](std::size_t from, std::size_t to, int& value) {
    const auto [end, error] = std::from_chars(text + from, text + to, value);
    return error == std::errc() && end == text + to;
  };
  if (!read(drive.size(), middle, out[0]) || !read(middle + ripple.size(), name.size() - waves.size(), out[1]))
    return std::nullopt;
  --out[0];
  return out;
}

/// 2 pi where the waves of a file are counted a metre, as the law counts them in rad; files of before count rad, too
/// (1/rad, 1/m).
double rad_of_waves(const std::string& unit) {
  return unit == "waves/m" ? 2 * std::numbers::pi : 1.0;
}

}  // namespace

std::string presliding_damping_name(const RobotDescription& robot, int joint) {
  return presliding_name(robot, joint) + "_damping";
}

Eigen::VectorXd presliding_damping_of(const ParameterTable& table, const RobotDescription& robot) {
  const int joints = robot.drives() + (robot.telescope ? 1 : 0);
  Eigen::VectorXd damping = Eigen::VectorXd::Zero(joints);
  for (const ParameterEntry& entry : table.entries) {
    if (!entry.name.ends_with(".presliding_damping")) continue;
    int joint = 0;
    while (joint < joints && entry.name != presliding_damping_name(robot, joint)) ++joint;
    if (joint == joints) {
      throw Error(fmt::format("{} is not of a joint with friction of this robot", entry.name),
                  place_of(table, entry, "name"), "remove the row, or give the parameter file of this robot");
    }
    if (!(entry.value >= 0)) {
      throw Error(fmt::format("the damping {} is negative", entry.value), place_of(table, entry, "value"),
                  "give the time by which the friction is ahead of its bristles after a reversal, or 0");
    }
    damping(joint) = entry.value;
  }
  return damping;
}

std::vector<Ripple> ripples_of(const ParameterTable& table, const RobotDescription& robot) {
  std::vector<Ripple> ripples;
  for (const ParameterEntry& entry : table.entries) {
    const auto of = ripple_of_waves(entry.name);
    if (!of) continue;
    if ((*of)[0] < 0 || (*of)[0] >= robot.drives()) {
      throw Error(fmt::format("{} is of a drive that this robot does not have", entry.name),
                  place_of(table, entry, "name"), "remove the row, or give the parameter file of this robot");
    }
    if (!(entry.value > 0)) {
      throw Error(fmt::format("{} waves are none", entry.value), place_of(table, entry, "value"),
                  "give the waves a turn (or a metre), or remove the ripple's three rows");
    }
    Ripple ripple;
    ripple.drive = (*of)[0];
    ripple.n = rad_of_waves(entry.unit) * entry.value;
    const std::string stem = fmt::format("drive{}.ripple{}.", ripple.drive + 1, (*of)[1]);
    const ParameterEntry *cosine = table.find(stem + "cosine"), *sine = table.find(stem + "sine");
    if (cosine == nullptr || sine == nullptr) {
      throw Error(fmt::format("{} has no {}", entry.name, stem + (cosine == nullptr ? "cosine" : "sine")),
                  place_of(table, entry, "name"), "give waves, cosine and sine of each ripple");
    }
    ripple.cosine = cosine->value;
    ripple.sine = sine->value;
    ripples.push_back(ripple);
  }
  return ripples;
}

std::vector<ParameterEntry> ripple_rows(const std::vector<Ripple>& ripples, const RobotDescription& robot) {
  std::vector<ParameterEntry> rows;
  std::vector<int> count(static_cast<std::size_t>(robot.drives()), 0);
  for (const Ripple& ripple : ripples) {
    const bool turns = robot.kind_of_drive(ripple.drive) == DriveKind::revolute;
    const std::string stem =
        fmt::format("drive{}.ripple{}.", ripple.drive + 1, ++count[static_cast<std::size_t>(ripple.drive)]);
    const auto add = [&](const char* quantity, double value, const char* unit, double std) {
      ParameterEntry entry;
      entry.name = stem + quantity;
      entry.value = value;
      entry.unit = unit;
      entry.std = std;
      entry.data_share = 1;
      rows.push_back(std::move(entry));
    };
    const char* unit = turns ? "waves/turn" : "waves/m";
    add("waves", ripple.n / rad_of_waves(unit), unit, ripple.n_std / rad_of_waves(unit));
    add("cosine", ripple.cosine, turns ? "N*m" : "N", ripple.amplitude_std);
    add("sine", ripple.sine, turns ? "N*m" : "N", ripple.amplitude_std);
  }
  return rows;
}

}  // namespace deltadyn
