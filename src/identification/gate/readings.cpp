#include "readings.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

namespace deltadyn::gate {

namespace {

constexpr double kPi = std::numbers::pi;

std::vector<int> limbs_of(const RobotDescription& robot) {
  std::vector<int> limbs(robot.limbs.size());
  std::iota(limbs.begin(), limbs.end(), 0);
  return limbs;
}

/// Wrong signs of single positions, of several limbs, of all of them, of the yaw.
void add_signs(const RobotDescription& robot, std::vector<PositionHypothesis>& out) {
  const int n = robot.drives();
  for (int set = 1; set < (1 << n); ++set) {
    PositionHypothesis h;
    h.reading = Reading::as_given(n);
    std::vector<int> drives;
    for (int j = 0; j < n; ++j) {
      if ((set >> j & 1) == 0) continue;
      h.reading.factor(j) = -1;
      drives.push_back(j);
    }
    h.key = "position_sign";
    h.words = fmt::format("the position of {} has the wrong sign", drives_in_words(drives, n));
    h.mend =
        "turn the sign of the column (delta-log import: sign = -1 in the map), or the direction of counting in the "
        "drive";
    h.drive = drives.size() == 1 ? drives.front() : -1;
    // All limbs alike is one convention, not several faults.
    const bool all_limbs = drives.size() == robot.limbs.size() && drives.back() < static_cast<int>(robot.limbs.size());
    h.changes = drives.size() == static_cast<std::size_t>(n) || all_limbs ? 1.0 : static_cast<double>(drives.size());
    out.push_back(std::move(h));
  }
}

/// Columns of other drives: of the positions, and of positions and torques where that is more than limbs numbered in
/// another way.
void add_orders(const RobotDescription& robot, std::vector<PositionHypothesis>& out) {
  const int n = robot.drives();
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  while (std::next_permutation(order.begin(), order.end())) {
    PositionHypothesis h;
    h.reading = Reading::as_given(n);
    h.reading.source = order;
    int moved = 0;
    for (int j = 0; j < n; ++j) moved += order[static_cast<std::size_t>(j)] != j ? 1 : 0;
    h.key = "position_order";
    std::string columns;
    for (const int j : order) columns += fmt::format("{}{}", columns.empty() ? "" : ", ", j + 1);
    h.words =
        fmt::format("the positions are in another order: drives 1 to {} are in the columns of drives {}", n, columns);
    h.mend = robot.plate
                 ? "put the position columns in the order of the limbs in the robot file"
                 : "put the position columns in the order of the limbs, counter-clockwise from above (limb 1 on +x)";
    h.changes = moved;
    out.push_back(h);
    // Three limbs alike move by the same equations in any order; on the halves of a plate it matters where a limb is.
    if (!robot.plate && (order.size() == robot.limbs.size() || order.back() == n - 1)) continue;
    h.key = "drive_order";
    h.drives_moved = true;
    if (robot.plate) {
      h.words =
          fmt::format("the drives are in another order: drives 1 to {} are in the columns of drives {}", n, columns);
      h.mend = "put positions and torques in the order of the limbs in the robot file";
      out.push_back(std::move(h));
      continue;
    }
    h.words = fmt::format(
        "the drives are in another order: the drive that turns the tool is in the columns of drive {}, the limbs, "
        "counted from any of them, in those of drives {}",
        order.back() + 1, columns.substr(0, columns.rfind(',')));
    h.mend =
        "put the columns in the order of the limbs, counter-clockwise from above (limb 1 on +x), then the drive that "
        "turns the tool (delta-log import: source in the map)";
    out.push_back(std::move(h));
  }
}

struct Unit {
  double factor;
  const char* words;
};

/// Units that positions of this drive may be in.
const std::vector<Unit>& units_of(const RobotDescription& robot, int drive) {
  static const std::vector<Unit> angles = {{kPi / 180, "degrees"}, {2 * kPi, "turns"},
                                           {1e-3, "mrad"},         {180 / kPi, "rad converted twice"},
                                           {kPi / 200, "gon"},     {kPi / 180 / 60, "minutes of arc"}};
  static const std::vector<Unit> lengths = {
      {1e-3, "millimetres"}, {1e-2, "centimetres"}, {1e-6, "micrometres"}, {0.0254, "inches"}, {1e3, "kilometres"}};
  return robot.kind_of_drive(drive) == DriveKind::revolute ? angles : lengths;
}

std::string unit_in_words(const RobotDescription& robot, int drive, double factor, double tolerance) {
  for (const Unit& unit : units_of(robot, drive)) {
    if (std::abs(factor / unit.factor - 1) < std::max(tolerance, 0.005)) return unit.words;
  }
  return "";
}

/// A member of a family without its words.
PositionHypothesis member_of(const PositionFamily& family, const RobotDescription& robot, double factor,
                             double offset) {
  PositionHypothesis h;
  h.reading = Reading::as_given(robot.drives());
  for (const int j : family.drives) {
    h.reading.factor(j) = factor;
    h.reading.offset(j) = offset;
  }
  h.key = family.key;
  h.changes = family.changes;
  h.drive = family.drives.size() == 1 ? family.drives.front() : -1;
  return h;
}

PositionHypothesis scaled(const PositionFamily& family, const RobotDescription& robot, double value, double tolerance) {
  PositionHypothesis h = member_of(family, robot, value, 0);
  const std::string who = drives_in_words(family.drives, robot.drives());
  const std::string unit = unit_in_words(robot, family.drives.front(), value, tolerance);
  if (!unit.empty()) {
    h.words = fmt::format("the position of {} looks like {}", who, unit);
    h.mend = robot.kind_of_drive(family.drives.front()) == DriveKind::revolute
                 ? "name the columns with their unit (q1_deg ...), or convert them to rad"
                 : "convert the columns to m";
    return h;
  }
  const double ratio = 1 / value;
  const double whole = std::round(ratio), inverse = std::round(value);
  const auto is_whole = [&](double x) {
    return x > 1.5 && std::abs(x / std::round(x) - 1) < std::max(tolerance, 0.01);
  };
  const bool gear = is_whole(ratio);
  if (is_whole(value)) {
    h.words = fmt::format(
        "the position of {} is 1/{:g} of the joint's: a gear ratio taken out of what is the joint's already?", who,
        inverse);
    h.mend = fmt::format(
        "multiply the positions by {:g}, and divide the torque by it if it was multiplied (delta-log import: leave "
        "gear_ratio out of the map's blocks)",
        inverse);
    return h;
  }
  h.odd = !gear;
  if (!gear) h.changes += 0.7;  // no unit and no whole ratio: less likely than any of these
  h.words = fmt::format("the position of {} is {:.4g} times the joint's: motor side of a gear{}?", who,
                        gear ? whole : ratio, gear ? "" : ", or another unit");
  h.mend =
      "divide the positions by the gear ratio and multiply the torque by it (delta-log import: gear_ratio in the map)";
  return h;
}

}  // namespace

std::string drives_in_words(const std::vector<int>& drives, int all) {
  if (static_cast<int>(drives.size()) == all && all > 1) return "all drives";
  std::string text = drives.size() == 1 ? "drive " : "drives ";
  for (std::size_t k = 0; k < drives.size(); ++k) {
    text += fmt::format("{}{}", k == 0 ? "" : (k + 1 == drives.size() ? " and " : ", "), drives[k] + 1);
  }
  return text;
}

Reading compose(const Reading& outer, const Reading& inner) {
  Reading out = outer;
  for (std::size_t j = 0; j < outer.source.size(); ++j) {
    const auto from = static_cast<std::size_t>(outer.source[j]);
    const auto at = static_cast<Eigen::Index>(j), source = static_cast<Eigen::Index>(from);
    out.source[j] = inner.source[from];
    out.factor(at) = outer.factor(at) * inner.factor(source);
    out.offset(at) = outer.factor(at) * inner.offset(source) + outer.offset(at);
  }
  return out;
}

std::vector<double> plausible_values(const PositionFamily& family, const RobotDescription& robot, double value) {
  constexpr double kNear = 0.03;
  // Short motions tell a factor no better, and a unit is likelier than a ratio that is as near
  constexpr double kNearUnit = 0.08;
  std::vector<double> out;
  if (!family.geometric && robot.kind_of_drive(family.drives.front()) != DriveKind::revolute) return out;
  if (!family.geometric) {
    const double quarter = std::round(value / (kPi / 2)) * (kPi / 2);
    if (std::abs(value - quarter) < kNear * 2) out.push_back(quarter);
    return out;
  }
  for (const Unit& unit : units_of(robot, family.drives.front())) {
    if (std::abs(value / unit.factor - 1) < kNearUnit) out.push_back(unit.factor);
  }
  const double ratio = 1 / value, whole = std::round(ratio);
  if (ratio > 1.5 && std::abs(ratio / whole - 1) < kNear) out.push_back(1 / whole);
  const double inverse = std::round(value);
  if (value > 1.5 && std::abs(value / inverse - 1) < kNear) out.push_back(inverse);
  return out;
}

std::vector<PositionHypothesis> position_hypotheses(const RobotDescription& robot) {
  std::vector<PositionHypothesis> out;
  add_signs(robot, out);
  if (!robot.parts.empty()) add_orders(robot, out);
  return out;
}

std::vector<PositionFamily> position_families(const RobotDescription& robot) {
  std::vector<PositionFamily> out;
  if (robot.parts.empty()) return out;
  const std::vector<int> limbs = limbs_of(robot);
  const auto scales = [&robot](std::vector<int> drives, double step, double changes) -> PositionFamily {
    constexpr double kFarthest = 400;  // of a gear; units may be farther off
    std::vector<double> factors;
    for (double f = 1 / kFarthest; f < kFarthest; f *= 1 + step) {
      if (f < 0.8 || f > 1.25) factors.push_back(f);
    }
    for (const Unit& unit : units_of(robot, drives.front())) {
      if (unit.factor < 1 / kFarthest || unit.factor > kFarthest) factors.push_back(unit.factor);
    }
    return {"position_scale", std::move(drives), factors, true, step, {}, changes};
  };
  out.push_back(scales(limbs, 0.05, 1));
  for (const int limb : limbs) out.push_back(scales({limb}, 0.08, 1.5));
  if (robot.drive_kind != DriveKind::revolute) {
    // The zeros of all carriages together are a matter of where the plate's is.
    constexpr double kStep_m = 0.02, kFarthest = 0.5;  // of the strut
    std::vector<double> lengths;
    for (double x = -kFarthest * robot.limbs.front().strut; x <= kFarthest * robot.limbs.front().strut; x += kStep_m)
      lengths.push_back(x);
    for (const int limb : limbs) out.push_back({"position_zero", {limb}, lengths, false, kStep_m, {1}, 1.6});
    return out;
  }
  std::vector<double> angles;
  for (int degrees = -180; degrees < 180; degrees += 10) angles.push_back(degrees * kPi / 180);
  out.push_back({"position_zero", limbs, angles, false, 10 * kPi / 180, {1}, 1.2});
  out.push_back({"position_zero", limbs, angles, false, 10 * kPi / 180, {-1}, 1.3});
  for (const int limb : limbs) out.push_back({"position_zero", {limb}, angles, false, 10 * kPi / 180, {1}, 1.6});
  return out;
}

PositionHypothesis member(const PositionFamily& family, const RobotDescription& robot, double value, double tolerance) {
  if (family.geometric) return scaled(family, robot, value, tolerance);
  const double sign = family.sign.front();
  PositionHypothesis h = member_of(family, robot, sign, value);
  const std::string who = drives_in_words(family.drives, robot.drives());
  if (robot.kind_of_drive(family.drives.front()) != DriveKind::revolute) {
    h.odd = true;
    h.words = fmt::format("the zero of the carriage of {} is off: {:+.1f} mm must be added", who, 1e3 * value);
    h.mend = fmt::format("carriages count along their rails from the base: use {:.4g} m + q", value);
    return h;
  }
  double degrees = value * 180 / kPi;
  const double quarter = std::round(degrees / 90) * 90;
  const bool right_angle = std::abs(degrees - quarter) < std::max(1.0, tolerance * 180 / kPi);
  if (right_angle) degrees = quarter;
  h.odd = !right_angle;
  if (!right_angle) h.changes += 0.5;
  h.words = sign > 0
                ? fmt::format("the zero of the angle of {} is off: {:+.1f} deg must be added", who, degrees)
                : fmt::format(
                      "the angle of {} counts upwards{}", who,
                      degrees == 0
                          ? ""
                          : fmt::format(" from another zero ({:.1f} deg minus the recorded angle is right)", degrees));
  h.mend = fmt::format("arm angles count from horizontal outwards, positive down: use {} {} q",
                       fmt::format("{:.4g} rad", right_angle ? degrees * kPi / 180 : value), sign > 0 ? "+" : "-");
  return h;
}

}  // namespace deltadyn::gate
