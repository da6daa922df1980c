#include "deltadyn/io/extra_rows.hpp"

#include <array>
#include <charconv>
#include <fmt/format.h>
#include <numbers>
#include <optional>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

/// A row that each joint with friction may have, and the words of its messages.
struct JointRow {
  const char *name, *owner, *quantity, *mend;
};

constexpr JointRow kDisplacement{".presliding", "a joint", "displacement",
                                 "give the displacement over which the friction builds up after a reversal, or 0"};
constexpr JointRow kDamping{".presliding_damping", "of a joint", "damping",
                            "give the time by which the friction is ahead of its bristles after a reversal, or 0"};

std::string name_of(const RobotDescription& robot, int joint, const JointRow& row) {
  return (joint < robot.drives() ? fmt::format("drive{}", joint + 1) : robot.inner_joint()) + row.name;
}

/// Its values, drives first, then the inner joint; 0 where the file has no such row.
Eigen::VectorXd of_joints(const ParameterTable& table, const RobotDescription& robot, const JointRow& row) {
  const int joints = robot.drives() + (*robot.inner_joint() != 0 ? 1 : 0);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(joints);
  for (const ParameterEntry& entry : table.entries) {
    if (!entry.name.ends_with(row.name)) continue;
    int joint = 0;
    while (joint < joints && entry.name != name_of(robot, joint, row)) ++joint;
    if (joint == joints) {
      throw Error(fmt::format("{} is not {} with friction of this robot", entry.name, row.owner),
                  place(table.file, entry.line, "name"), "remove the row, or give the parameter file of this robot");
    }
    if (!(entry.value >= 0)) {
      throw Error(fmt::format("the {} {} is negative", row.quantity, entry.value),
                  place(table.file, entry.line, "value"), row.mend);
    }
    values(joint) = entry.value;
  }
  return values;
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

Eigen::VectorXd presliding_of(const ParameterTable& table, const RobotDescription& robot) {
  return of_joints(table, robot, kDisplacement);
}

std::string presliding_name(const RobotDescription& robot, int joint) {
  return name_of(robot, joint, kDisplacement);
}

Eigen::VectorXd presliding_damping_of(const ParameterTable& table, const RobotDescription& robot) {
  return of_joints(table, robot, kDamping);
}

std::string presliding_damping_name(const RobotDescription& robot, int joint) {
  return name_of(robot, joint, kDamping);
}

std::vector<Ripple> ripples_of(const ParameterTable& table, const RobotDescription& robot) {
  std::vector<Ripple> ripples;
  for (const ParameterEntry& entry : table.entries) {
    const auto of = ripple_of_waves(entry.name);
    if (!of) continue;
    if ((*of)[0] < 0 || (*of)[0] >= robot.drives()) {
      throw Error(fmt::format("{} is of a drive that this robot does not have", entry.name),
                  place(table.file, entry.line, "name"), "remove the row, or give the parameter file of this robot");
    }
    if (!(entry.value > 0)) {
      throw Error(fmt::format("{} waves are none", entry.value), place(table.file, entry.line, "value"),
                  "give the waves a turn (or a metre), or remove the ripple's three rows");
    }
    Ripple ripple;
    ripple.drive = (*of)[0];
    ripple.n = rad_of_waves(entry.unit) * entry.value;
    const std::string stem = fmt::format("drive{}.ripple{}.", ripple.drive + 1, (*of)[1]);
    const ParameterEntry *cosine = table.find(stem + "cosine"), *sine = table.find(stem + "sine");
    if (cosine == nullptr || sine == nullptr) {
      throw Error(fmt::format("{} has no {}", entry.name, stem + (cosine == nullptr ? "cosine" : "sine")),
                  place(table.file, entry.line, "name"), "give waves, cosine and sine of each ripple");
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
      rows.push_back({.name = stem + quantity, .value = value, .unit = unit, .std = std, .data_share = 1});
    };
    const char* unit = turns ? "waves/turn" : "waves/m";
    add("waves", ripple.n / rad_of_waves(unit), unit, ripple.n_std / rad_of_waves(unit));
    add("cosine", ripple.cosine, turns ? "N*m" : "N", ripple.amplitude_std);
    add("sine", ripple.sine, turns ? "N*m" : "N", ripple.amplitude_std);
  }
  return rows;
}

}  // namespace deltadyn
