#include "torque_offset.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/statistics.hpp"

#include "readings.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSound = 0.02;          // of the torque: what a log without faults may leave
constexpr double kOffsetWins = 0.85;     // of the residual: offsets of all drives are nearly a load
constexpr double kMore = 0.95;           // of the residual of fewer drives
constexpr double kLeast = 0.01;          // of the drive's rms torque: less is no matter
constexpr double kOffsetSigmas = 15;     // of the offset
constexpr Index kFewestOffsetRows = 20;  // of a drive

/// All drives' rows, each over its rms torque, without what the base parameters explain of them.
struct Rest {
  MatrixXd offset;  ///< one column a drive
  VectorXd torque, rms;

  bool fill(const Rows& rows, const Points& points) {
    const auto drives = static_cast<Index>(rows.drives.size());
    Index total = 0;
    for (const DriveRows& drive : rows.drives) {
      if (drive.count() < kFewestOffsetRows) return false;
      total += drive.count();
    }
    const Index parameters = rows.drives.front().Y.cols();
    MatrixXd A = MatrixXd::Zero(total, parameters);
    offset.setZero(total, drives);
    torque.resize(total);
    rms.resize(drives);
    Index row = 0;
    for (Index j = 0; j < drives; ++j) {
      const DriveRows& drive = rows.drives[static_cast<std::size_t>(j)];
      const VectorXd tau = drive.of_points(points.tau.col(j));
      rms(j) = std::max(root_mean_square(tau), 1e-12);
      A.middleRows(row, tau.size()) = drive.Y / rms(j);
      offset.col(j).segment(row, tau.size()).setConstant(1 / rms(j));
      torque.segment(row, tau.size()) = tau / rms(j);
      row += tau.size();
    }
    const VectorXd norm = A.colwise().norm().cwiseMax(1e-300).transpose();
    A *= norm.cwiseInverse().asDiagonal();
    const dense::PivotedQr qr(A);
    for (auto column : offset.colwise()) column -= A * qr.solve(column);
    torque -= A * qr.solve(torque);
    return total > 2 * (parameters + drives);
  }
};

struct Offsets {
  std::vector<int> drives;
  VectorXd value, std;
  double residual = 1;  ///< relative
};

Offsets fit(const Rest& rest, const std::vector<int>& drives) {
  const MatrixXd A = rest.offset(Eigen::all, drives);
  const MatrixXd inverse = dense::pseudo_inverse(A.transpose() * A);
  Offsets out;
  out.drives = drives;
  out.value = inverse * (A.transpose() * rest.torque);
  out.residual = root_mean_square(rest.torque - A * out.value);
  out.std = out.residual * inverse.diagonal().cwiseMax(0.0).cwiseSqrt();
  return out;
}

bool stands_out(const Offsets& o, const Rest& rest) {
  for (Index k = 0; k < o.value.size(); ++k) {
    const double least = kLeast * rest.rms(o.drives[static_cast<std::size_t>(k)]);
    if (std::abs(o.value(k)) < std::max(least, kOffsetSigmas * o.std(k))) return false;
  }
  return true;
}

/// Offsets of the fewest drives that explain the torque; more of them only where they leave clearly less.
Offsets best_offsets(const Rest& rest, int drives) {
  Offsets best;
  for (int count = 1; count <= drives; ++count) {
    Offsets next;
    for (int set = 1; set < (1 << drives); ++set) {
      std::vector<int> members;
      for (int j = 0; j < drives; ++j) {
        if ((set >> j & 1) != 0) members.push_back(j);
      }
      if (static_cast<int>(members.size()) != count) continue;
      Offsets one = fit(rest, members);
      if (one.residual < next.residual && stands_out(one, rest)) next = std::move(one);
    }
    if (next.residual < (best.residual < kSound ? kMore : 1.0) * best.residual) best = std::move(next);
  }
  return best;
}

}  // namespace

std::optional<TorqueOffset> torque_offset(const Robot& robot, const BaseParameters& base, const Points& points) {
  if (robot.parameter_options().offset) return {};
  Rest rest;
  if (!rest.fill(rows_of_points(robot, base, points, Reading::as_given(robot.drives())), points)) return {};
  const double as_given = root_mean_square(rest.torque);
  const Offsets best = best_offsets(rest, robot.drives());
  if (best.residual >= kSound || best.residual >= kOffsetWins * as_given) return {};
  VectorXd offset = VectorXd::Zero(robot.drives());
  std::string sizes;
  const char* unit = "";
  for (Index k = 0; k < best.value.size(); ++k) {
    const int drive = best.drives[static_cast<std::size_t>(k)];
    unit = robot.description().kind_of_drive(drive) == DriveKind::revolute ? "N m" : "N";
    offset(drive) = best.value(k);
    const bool last = k + 1 == best.value.size();
    sizes +=
        fmt::format("{}{:+.4g} +- {:.2g} {}", k == 0 ? "" : (last ? " and " : ", "), best.value(k), best.std(k), unit);
  }
  return TorqueOffset{
      {.level = FindingLevel::warning,
       .key = "torque_offset",
       .drive = best.drives.size() == 1 ? best.drives.front() : -1,
       .value = best.value(0),
       .std = best.std(0),
       .unit = unit,
       .text = fmt::format("the torque of {} has an offset of {}: residual {:.2g} % as given, {:.2g} % without it",
                           drives_in_words(best.drives, robot.drives()), sizes, 100 * as_given, 100 * best.residual),
       .mend = "if the zero of the sensor or amplifier is off, fit it (delta-identify --offset) or take it out "
               "(delta-log import: offset in the map); friction that differs by direction looks alike, and so does a "
               "hose if all drives are off: delta-diagnose names them"},
      offset};
}

}  // namespace deltadyn::gate
