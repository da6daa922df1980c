#include "deltadyn/identification/structure_left.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/identification/residual_structure.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;

constexpr double kLeastOfTorque = 0.002;  // less moves no figure that a user acts on
// A dependence with a share of a fifth that chance gives once in twenty logs; clean logs stay below a twentieth of the
// residual.
constexpr double kRareShare = 0.2;
constexpr double kRare = 0.05;
constexpr double kNotableShare = 0.1;  // a smaller share must be rarer by chance
constexpr double kVeryRare = 0.01;
// Rows that tell as much as one of white noise; sensors' own noise has none at these rates
constexpr double kMemory = 3;
constexpr Index kRanges = 5;  // of speed, with the same number of rows each
constexpr double kSure = 4;   // standard deviations of the mean in a range

struct Row {
  double speed, friction_like, torque;
};

/// The range of speed whose mean friction-like residual is largest beside the torque in it.
void find_speed_range(const Prediction& rows, int drive, double correlation, StructureLeft& out) {
  std::vector<Row> all;
  const auto usable = rows.usable(drive, false);
  for (Index k = 0; k < rows.rows(); ++k) {
    if (!usable(k)) continue;
    const double rate = rows.qd(k, drive), e = rows.tau(k, drive) - rows.model(k, drive);
    all.push_back({std::abs(rate), rate > 0 ? e : -e, rows.tau(k, drive)});
  }
  std::sort(all.begin(), all.end(), [](const Row& a, const Row& b) { return a.speed < b.speed; });
  const auto n = static_cast<Index>(all.size());
  for (Index range = 0; range < kRanges && n > 20 * kRanges; ++range) {
    double sum = 0, square = 0, torque = 0;
    const Index first = range * n / kRanges, last = (range + 1) * n / kRanges;
    for (Index k = first; k < last; ++k) {
      const Row& row = all[static_cast<std::size_t>(k)];
      sum += row.friction_like;
      square += row.friction_like * row.friction_like;
      torque += row.torque * row.torque;
    }
    const auto count = static_cast<double>(last - first);
    const double mean = sum / count, std = std::sqrt(square / count / count * std::max(1.0, correlation));
    const double share = torque > 0 ? std::abs(mean) / std::sqrt(torque / count) : 0.0;
    if (std::abs(mean) < kSure * std || share <= out.of_torque_there) continue;
    out.of_torque_there = share;
    out.speed_low = all[static_cast<std::size_t>(first)].speed;
    out.speed_high = all[static_cast<std::size_t>(last - 1)].speed;
  }
}

bool is_structure(const DependenceOnMotion& found) {
  return (found.share > kRareShare && found.p_value <= kRare) ||
         (found.share > kNotableShare && found.p_value <= kVeryRare);
}

StructureLeft structure_of(const ValidatedLog& log, const ValidatedDrive& figures, const ResidualStructure& residual,
                           int drive) {
  StructureLeft out;
  out.file = log.file;
  out.drive = drive;
  const std::pair<const char*, const DependenceOnMotion*> all[] = {{"velocity", &residual.on_velocity},
                                                                   {"position", &residual.on_position},
                                                                   {"acceleration", &residual.on_acceleration}};
  for (const auto& [coordinate, found] : all) {
    if (!is_structure(*found) || found->share <= out.share) continue;
    out.coordinate = coordinate;
    out.share = found->share;
  }
  if (out.coordinate.empty() && residual.correlation > kMemory) {
    out.coordinate = "time";
    out.share = 1 - 1 / residual.correlation;
  }
  if (out.coordinate.empty()) return out;
  out.of_torque = std::sqrt(out.share) * figures.relative_residual;
  find_speed_range(log.prediction, drive, residual.correlation, out);
  return out;
}

double size(const StructureLeft& structure) {
  return std::max(structure.of_torque, structure.of_torque_there);
}

}  // namespace

std::optional<StructureLeft> structure_left(const Validation& validation) {
  std::optional<StructureLeft> worst;
  for (const ValidatedLog& log : validation.logs) {
    Validation single;
    single.logs = {log};
    single.processing = validation.processing;
    single.drives = drive_figures(single.logs, validation.drives.size());
    const std::vector<ResidualStructure> residual = residual_structure(single);
    for (std::size_t j = 0; j < residual.size(); ++j) {
      const StructureLeft found = structure_of(log, single.drives[j], residual[j], static_cast<int>(j));
      if (found.coordinate.empty() || size(found) < kLeastOfTorque) continue;
      if (!worst || size(found) > size(*worst)) worst = found;
    }
  }
  return worst;
}

}  // namespace deltadyn
