#pragma once

/// \file
/// Faults of recorded logs, one a kind and robot, laid over a sound log.

#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/log.hpp"
#include "deltadyn/signal/torque_timing_mend.hpp"

namespace deltadyn::testing_support {

struct FaultyLog {
  std::string name;
  std::function<void(Log&)> spoil;
  std::vector<std::string> keys;  ///< any of these must be found, as a fault
  double value = 0;               ///< of the finding, where it must be right within 3 %; 0: not looked at
};

/// Column j becomes factor_j times column source_j (plus offset_j).
inline void remap(Eigen::MatrixXd& columns, const std::vector<int>& source, const std::vector<double>& factor,
                  const std::vector<double>& offset = {}) {
  const Eigen::MatrixXd before = columns;
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    columns.col(j) = factor[at] * before.col(source[at]);
    if (!offset.empty()) columns.col(j).array() += offset[at];
  }
}

inline std::vector<double> for_limbs(int drives, double limb, double yaw) {
  std::vector<double> values(static_cast<std::size_t>(drives), limb);
  if (drives > 3) values[3] = yaw;
  return values;
}

inline std::vector<double> for_one(int drives, int drive, double value, double others) {
  std::vector<double> values(static_cast<std::size_t>(drives), others);
  values[static_cast<std::size_t>(drive)] = value;
  return values;
}

inline std::vector<int> order(int drives, std::vector<int> first) {
  for (int j = static_cast<int>(first.size()); j < drives; ++j) first.push_back(j);
  return first;
}

/// Everything that must be called by its name.
inline std::vector<FaultyLog> faulty_logs(const RobotDescription& robot) {
  const int n = robot.drives();
  const bool turns = robot.drive_kind == DriveKind::revolute;
  const double quarter = std::numbers::pi / 2, degrees = 180 / std::numbers::pi;
  const std::vector<int> same = order(n, {0, 1, 2});
  const auto q = [&](const std::string& name, std::vector<int> source, std::vector<double> factor,
                     std::vector<double> offset, std::vector<std::string> keys, double value = 0) {
    return FaultyLog{name, [=](Log& log) { remap(log.q, source, factor, offset); }, std::move(keys), value};
  };
  const auto t = [&](const std::string& name, std::vector<int> source, std::vector<double> factor,
                     std::vector<std::string> keys, double value = 0) {
    return FaultyLog{name, [=](Log& log) { remap(log.tau, source, factor); }, std::move(keys), value};
  };
  const auto both = [&](const std::string& name, std::vector<double> fq, std::vector<double> ft,
                        std::vector<std::string> keys) {
    return FaultyLog{name,
                     [=](Log& log) {
                       remap(log.q, same, fq);
                       remap(log.tau, same, ft);
                     },
                     std::move(keys), 0};
  };
  const std::vector<double> ones(static_cast<std::size_t>(n), 1.0), zeros(static_cast<std::size_t>(n), 0.0);
  const std::vector<std::string> any_order = {"torque_order", "position_order"};
  std::vector<FaultyLog> out = {
      t("torque sign 1", same, for_one(n, 0, -1, 1), {"torque_sign"}),
      t("torque sign 3", same, for_one(n, 2, -1, 1), {"torque_sign"}),
      t("torque sign all", same, std::vector<double>(static_cast<std::size_t>(n), -1.0), {"torque_sign"}),
      q("position sign 2", same, for_one(n, 1, -1, 1), zeros, {"position_sign"}),
      t("torques 2 and 3 swapped", order(n, {0, 2, 1}), ones, any_order),
      t("torques rotated", order(n, {1, 2, 0}), ones, any_order),
      q("positions 1 and 2 swapped", order(n, {1, 0, 2}), ones, zeros, any_order),
      q("positions rotated", order(n, {2, 0, 1}), ones, zeros, any_order),
      t("torque sign 1 of swapped 2 and 3", order(n, {0, 2, 1}), for_one(n, 0, -1, 1),
        {"torque_order", "position_order", "torque_sign"}),
      t("torque 2 in thousandths", same, for_one(n, 1, 1000, 1), {"torque_scale_drive"}, 1000),
      t("torque 3 of the motor", same, for_one(n, 2, 0.05, 1), {"torque_scale_drive"}, 0.05),
      t("torque 1 doubled", same, for_one(n, 0, 2, 1), {"torque_scale_drive"}, 2),
      t("torque in thousandths", same, for_limbs(n, 1000, 1000), {"scale"}),
      t("torque in thousands", same, for_limbs(n, 1e-3, 1e-3), {"scale"}),
      t("torque in per mille of 60", same, for_limbs(n, 1000.0 / 60, 250), {"scale"}),
      t("torque of the motor", same, for_limbs(n, 0.05, 1), {"scale"}),
      both("motor side, 20", for_limbs(n, 20, 1), for_limbs(n, 0.05, 1), {"position_scale"}),
      both("gear ratio taken out twice", for_limbs(n, 0.05, 1), for_limbs(n, 20, 1), {"position_scale"}),
      both("motor side of drive 2, 8", for_one(n, 1, 8, 1), for_one(n, 1, 0.125, 1), {"position_scale"}),
      both("positions and torques against the axis", for_limbs(n, -1, 1), for_limbs(n, -1, 1),
           {"position_sign", "position_zero"}),
  };
  if (turns) {
    out.push_back(q("degrees", same, for_limbs(n, degrees, degrees), zeros, {"position_scale"}));
    out.push_back(q("degrees of drive 1", same, for_one(n, 0, degrees, 1), zeros, {"position_scale"}));
    out.push_back(q("turns", same, for_limbs(n, 0.5 / std::numbers::pi, 1), zeros, {"position_scale"}));
    out.push_back(q("zero a quarter turn off", same, ones, for_limbs(n, quarter, 0), {"position_zero"}));
    out.push_back(
        q("angle from the vertical, upwards", same, for_limbs(n, -1, 1), for_limbs(n, quarter, 0), {"position_zero"}));
    out.push_back(q("zero of drive 2 off by 12 degrees", same, ones, for_one(n, 1, 0.2, 0), {"position_zero"}));
    out.push_back(q("positions upwards", same, for_limbs(n, -1, 1), zeros, {"position_sign", "position_zero"}));
  } else {
    out.push_back(q("millimetres", same, for_limbs(n, 1000, 1000), zeros, {"position_scale"}));
    out.push_back(q("positions upwards", same, for_limbs(n, -1, 1), zeros, {"position_sign"}));
    out.push_back(q("zero of carriage 2 off by 60 mm", same, ones, for_one(n, 1, 0.06, 0), {"position_zero"}));
  }
  if (n == 4) {
    out.push_back(t("torque sign of the yaw", same, for_one(n, 3, -1, 1), {"torque_sign"}));
    out.push_back(q("yaw in degrees", same, for_one(n, 3, degrees, 1), zeros, {"torque_scale", "position_range"}));
    out.push_back(t("torques 3 and 4 swapped", {0, 1, 3, 2}, ones, any_order));
    for (const std::vector<int>& source : {std::vector<int>{3, 1, 2, 0}, {3, 0, 1, 2}, {0, 1, 3, 2}}) {
      out.push_back({"yaw in the columns of a limb",
                     [=](Log& log) {
                       remap(log.q, source, ones);
                       remap(log.tau, source, ones);
                     },
                     {"drive_order"},
                     0});
    }
  }
  return out;
}

/// A torque that is `delay_s` late, or behind a low pass of `lag_s`.
inline void make_late(Log& log, double delay_s, double lag_s, int only_drive = -1) {
  for (Eigen::Index j = 0; j < log.drives(); ++j) {
    if (only_drive >= 0 && j != only_drive) continue;
    if (lag_s > 0) log.tau.col(j) = first_order_low_pass(log.tau.col(j), log.sample_time_s(), lag_s);
    if (delay_s != 0) log.tau.col(j) = mend_timing(log.tau.col(j), log.sample_time_s(), -delay_s, 0.0);
  }
}

}  // namespace deltadyn::testing_support
