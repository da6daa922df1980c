#include "mirror.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/statistics.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;

constexpr double kMirrorOutOfReach = 0.01;  // share of poses
constexpr double kMirrorRidge = 1e-11;      // of the scaled normal equations
constexpr int kWeightPasses = 4;            // of the weights
constexpr Index kFewestYawRows = 300;       // of the yaw's drive
// Chi^2 of independent rows. Where a log cannot tell, the margin scatters by 2 to 4 about 0; the right reading of a log
// that can tell has -30 and less.
constexpr double kClear = 15;

struct DriveFit {
  double rms = 0, correlation = 0;  ///< of neighbouring rows
  Index rows = 0;
};

/// Torques of each drive at its rows, under the Gaussian of the regressor.
std::vector<Eigen::VectorXd> torques_at(const Sample& sample, const Rows& rows, const Reading& reading) {
  std::vector<Eigen::VectorXd> out;
  for (std::size_t j = 0; j < rows.drives.size(); ++j) {
    const auto drive = static_cast<Index>(j);
    const Eigen::VectorXd tau =
        values_at(sample, recorded_torque(sample, drive), rows.drives[j].at, {}, 0, sample.sigma_s);
    out.emplace_back(reading.factor(drive) * tau);
  }
  return out;
}

Eigen::VectorXd solve(const Rows& rows, const std::vector<Eigen::VectorXd>& tau, const std::vector<double>& weight) {
  const Index B = rows.drives.front().Y.cols();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(B, B);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(B);
  for (std::size_t j = 0; j < tau.size(); ++j) {
    const Eigen::MatrixXd& Y = rows.drives[j].Y;
    A += weight[j] * Y.transpose() * Y;
    b += weight[j] * Y.transpose() * tau[j];
  }
  const Eigen::VectorXd scale = A.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * A * scale.asDiagonal();
  scaled.diagonal().array() += kMirrorRidge;
  return scale.asDiagonal() * dense::solve_symmetric(scaled, Eigen::VectorXd(scale.asDiagonal() * b));
}

DriveFit figures_of(const Eigen::VectorXd& e) {
  DriveFit fit;
  fit.rows = e.size();
  const double square = e.squaredNorm();
  fit.rms = std::sqrt(square / static_cast<double>(std::max<Index>(1, fit.rows)));
  if (fit.rows > 1 && square > 0)
    fit.correlation = std::clamp(e.head(fit.rows - 1).dot(e.tail(fit.rows - 1)) / square, 0.0, 0.99);
  return fit;
}

/// Empty if this reading has too few rows to judge by.
std::vector<DriveFit> fit_of(const Robot& robot, const BaseParameters& base, const Sample& sample,
                             const Reading& reading) {
  const Rows rows = low_passed_rows(robot, base, sample, reading);
  Index fewest = rows.drives.back().count();
  for (const DriveRows& drive : rows.drives) fewest = std::min(fewest, drive.count() + kFewestYawRows - 1);
  if (rows.unreachable > kMirrorOutOfReach || fewest < kFewestYawRows) return {};
  const std::vector<Eigen::VectorXd> tau = torques_at(sample, rows, reading);
  std::vector<double> weight;
  for (const Eigen::VectorXd& t : tau)
    weight.push_back(static_cast<double>(t.size()) / std::max(t.squaredNorm(), 1e-300));
  std::vector<DriveFit> out;
  for (int pass = 0; pass < kWeightPasses; ++pass) {
    const Eigen::VectorXd beta = solve(rows, tau, weight);
    out.clear();
    for (std::size_t j = 0; j < tau.size(); ++j) {
      out.push_back(figures_of(tau[j] - rows.drives[j].Y * beta));
      const double least = 1e-6 * root_mean_square(tau[j]);  // logs without noise
      weight[j] = 1 / std::max(out[j].rms * out[j].rms, least * least + 1e-300);
    }
  }
  return out;
}

/// Fall of chi^2 from one residual to another; rows that follow one another count for less.
double margin_of(const DriveFit& given, const DriveFit& turned) {
  if (!(given.rms > 0) || !(turned.rms > 0)) return 0;
  const double independent = (1 - given.correlation) / (1 + given.correlation);
  return independent * static_cast<double>(given.rows) * 2 * std::log(given.rms / turned.rms);
}

}  // namespace

std::optional<LogFinding> mirror_finding(const Robot& robot, const BaseParameters& base, const Sample& sample) {
  const RobotDescription& description = robot.description();
  const int yaw = robot.drives() - 1;
  if (!description.telescope || yaw != static_cast<int>(description.limbs.size()) || sample.stretches.empty())
    return std::nullopt;
  Reading turned = Reading::as_given(robot.drives());
  turned.factor(yaw) = -1;
  const std::vector<DriveFit> given = fit_of(robot, base, sample, Reading::as_given(robot.drives()));
  if (given.empty()) return std::nullopt;
  const std::vector<DriveFit> other = fit_of(robot, base, sample, turned);
  if (other.empty()) return std::nullopt;
  const double margin = margin_of(given.back(), other.back());
  double margin_of_all = 0;
  for (std::size_t j = 0; j < given.size(); ++j) margin_of_all += margin_of(given[j], other[j]);
  // What the model lacks in the yaw's drive alone is no evidence against all drives together.
  if (margin < kClear || margin_of_all < kClear) return std::nullopt;
  return LogFinding{.level = FindingLevel::warning,
                    .key = "mirrored",
                    .drive = yaw,
                    .value = margin,
                    .text = fmt::format(
                        "the numbering of the limbs and the sign of drive {0} do not belong together: residual of "
                        "drive {0} {1:.4g} N m as given, {2:.4g} N m with the yaw turned (chi^2 less by {3:.0f}); the "
                        "parameters are those of the columns as they are",
                        yaw + 1, given.back().rms, other.back().rms, margin),
                    .mend = fmt::format(
                        "move one drive by hand: limb 2 stands 120 deg counter-clockwise from limb 1 seen from above, "
                        "and a positive angle of drive {0} turns the tool counter-clockwise; turn position and torque "
                        "of drive {0} (sign = -1 in the map), or swap the columns of limbs 2 and 3",
                        yaw + 1)};
}

bool is_turned_yaw(const RobotDescription& robot, const Explanation& explanation) {
  if (!robot.telescope) return false;
  Eigen::VectorXd turned = Eigen::VectorXd::Ones(robot.drives());
  turned(robot.drives() - 1) = -1;
  const Reading& reading = explanation.reading;
  return reading.factor == turned && reading.offset.isZero() && explanation.factor == turned &&
         std::is_sorted(reading.source.begin(), reading.source.end()) &&
         std::is_sorted(explanation.assignment.begin(), explanation.assignment.end());
}

}  // namespace deltadyn::gate
