#include "rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "deltadyn/signal/reversal_mask.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;

constexpr double kReach = 4.5;          // standard deviations of the Gaussian that count
constexpr double kMaskFloor = 0.003;    // of a joint's largest rate: below, the sign of the friction is uncertain
constexpr Index kFewestUnmasked = 300;  // rows of a drive; with fewer, those near reversals count, too
constexpr double kLookUp_s = 0.05;      // torque is looked up so far from a row
// Standard deviations of the Gaussian about a reversal, for rows at single points
constexpr double kSmear = 2.5;
constexpr double kRowsPerBand = 0.4;  // spacing of rows in periods of the band: nearly independent rows

Index reach_of(const Sample& sample, const Stretch& stretch) {
  return static_cast<Index>(std::ceil(kReach * sample.sigma_s / stretch.step_s));
}

/// Gaussian and its first derivatives at points k of the grid, seen from `shift_s` after point 0.
struct Kernel {
  Index from = 0;                         ///< first point, relative to the row's
  std::array<Eigen::VectorXd, 4> weight;  ///< of derivative 0 to 3

  Kernel(double sigma, double step, double shift_s) {
    const auto middle = static_cast<Index>(std::lround(shift_s / step));
    const auto reach = static_cast<Index>(std::ceil(kReach * sigma / step));
    from = middle - reach;
    for (Eigen::VectorXd& w : weight) w.resize(2 * reach + 1);
    for (Index k = 0; k <= 2 * reach; ++k) {
      const double u = (shift_s - static_cast<double>(from + k) * step) / sigma;
      const double h = step / (sigma * std::sqrt(2 * std::numbers::pi)) * std::exp(-0.5 * u * u);
      weight[0](k) = h;
      weight[1](k) = -u * h / sigma;
      weight[2](k) = (u * u - 1) * h / (sigma * sigma);
      weight[3](k) = (3 * u - u * u * u) * h / (sigma * sigma * sigma);
    }
    // Exactly 1 for a constant, also on a coarse grid.
    weight[0] /= weight[0].sum();
  }
};

/// 1 near a reversal of the joint, at each point.
std::vector<char> near_reversal(const Eigen::VectorXd& rate) {
  return reversal_mask(rate, kMaskFloor * rate.cwiseAbs().maxCoeff(), 0);
}

bool any_within(const std::vector<char>& mask, Index centre, Index reach) {
  const Index from = std::max<Index>(0, centre - reach);
  const Index to = std::min<Index>(static_cast<Index>(mask.size()), centre + reach + 1);
  return std::any_of(mask.begin() + from, mask.begin() + to, [](char m) { return m != 0; });
}

/// Regressor of every point of a stretch and what spoils a point.
struct PointRegressor {
  std::vector<Eigen::MatrixXd> Y;  ///< one a drive: points x base
  std::vector<char> out_of_reach;
  std::vector<std::vector<char>> reversal;  ///< one a drive

  PointRegressor(const Robot& robot, const BaseParameters& base, const Stretch& stretch, const Reading& reading) {
    const Index N = stretch.points();
    const int n = robot.drives();
    const Eigen::MatrixXd q = reading.apply(stretch.q, 0), qd = reading.apply(stretch.qd, 1),
                          qdd = reading.apply(stretch.qdd, 2);
    Y.assign(static_cast<std::size_t>(n), Eigen::MatrixXd::Zero(N, base.count()));
    out_of_reach.assign(static_cast<std::size_t>(N), 0);
    Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(N, robot.friction_joints());
    Eigen::MatrixXd full(n, robot.parameters());
    Eigen::VectorXd v(robot.friction_joints());
    PathPose path;
    for (Index k = stretch.first; k < stretch.last; ++k) {
      const Eigen::VectorXd qk = q.row(k), vk = qd.row(k), ak = qdd.row(k);
      if (robot.regressor(qk, vk, ak, full, &path) != Status::ok ||
          robot.friction_joint_rates(qk, vk, v, &path) != Status::ok || !full.allFinite()) {
        out_of_reach[static_cast<std::size_t>(k)] = 1;
        continue;
      }
      rates.row(k) = v.transpose();
      for (int j = 0; j < n; ++j) Y[static_cast<std::size_t>(j)].row(k) = full.row(j)(base.independent);
    }
    for (int j = 0; j < n; ++j) reversal.push_back(near_reversal(rates.col(j)));
    if (robot.friction_joints() == n) return;
    const std::vector<char> inner = near_reversal(rates.col(rates.cols() - 1));
    for (std::size_t j = 0; j < reversal.size(); ++j) {
      if (!robot.description().feels_inner_joint(static_cast<int>(j))) continue;
      for (std::size_t k = 0; k < inner.size(); ++k) reversal[j][k] = reversal[j][k] != 0 || inner[k] != 0 ? 1 : 0;
    }
  }
};

/// A row of one drive.
struct FoundRow {
  Place at;
  Eigen::RowVectorXd Y;
  bool near_reversal = false;
};

DriveRows stacked(const std::vector<FoundRow>& found, int parameters) {
  DriveRows rows;
  rows.Y.resize(static_cast<Index>(found.size()), parameters);
  for (std::size_t k = 0; k < found.size(); ++k) {
    rows.at.push_back(found[k].at);
    rows.Y.row(static_cast<Index>(k)) = found[k].Y;
  }
  return rows;
}

}  // namespace

Reading Reading::as_given(int drives) {
  Reading out;
  for (int j = 0; j < drives; ++j) out.source.push_back(j);
  out.factor.setOnes(drives);
  out.offset.setZero(drives);
  return out;
}

Eigen::MatrixXd Reading::apply(const Eigen::MatrixXd& columns, int derivative) const {
  Eigen::MatrixXd out(columns.rows(), columns.cols());
  for (Index j = 0; j < out.cols(); ++j) {
    out.col(j) = factor(j) * columns.col(source[static_cast<std::size_t>(j)]);
    if (derivative == 0) out.col(j).array() += offset(j);
  }
  return out;
}

Eigen::MatrixXd DriveRows::of_points(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd out(count(), columns.cols());
  for (Index k = 0; k < count(); ++k) out.row(k) = columns.row(at[static_cast<std::size_t>(k)].point);
  return out;
}

Rows low_passed_rows(const Robot& robot, const BaseParameters& base, const Sample& sample, const Reading& reading) {
  const int n = robot.drives();
  std::vector<std::vector<FoundRow>> found(static_cast<std::size_t>(n));
  Rows rows;
  double looked_at = 0, unreachable = 0;
  for (std::size_t s = 0; s < sample.stretches.size(); ++s) {
    const Stretch& stretch = sample.stretches[s];
    PointRegressor regressor(robot, base, stretch, reading);
    for (Index k = stretch.first; k < stretch.last; ++k)
      unreachable += regressor.out_of_reach[static_cast<std::size_t>(k)];
    looked_at += static_cast<double>(std::max<Index>(0, stretch.last - stretch.first));
    const Kernel kernel(sample.sigma_s, stretch.step_s, 0.0);
    const Index reach = reach_of(sample, stretch);
    const auto search = static_cast<Index>(std::ceil(kLookUp_s / stretch.step_s));
    const auto spacing = std::max<Index>(1, static_cast<Index>(kRowsPerBand / sample.band_hz / stretch.step_s));
    const Index from = std::max(stretch.first + reach, reach + search);
    const Index to = std::min(stretch.last - reach, stretch.points() - reach - search);
    for (Index k = from; k < to; k += spacing) {
      if (any_within(regressor.out_of_reach, k, reach) || any_within(stretch.spoilt, k, reach)) continue;
      for (int j = 0; j < n; ++j) {
        const auto at = static_cast<std::size_t>(j);
        if (stretch.torque_out.col(j).segment(k - reach, 2 * reach + 1).any()) continue;
        found[at].push_back(
            {{static_cast<int>(s), k},
             kernel.weight[0].transpose() * regressor.Y[at].middleRows(k + kernel.from, kernel.weight[0].size()),
             any_within(regressor.reversal[at], k, reach)});
      }
    }
    rows.Y_of_points.push_back(std::move(regressor.Y));
  }
  for (std::vector<FoundRow>& of_drive : found) {
    if (std::ranges::count(of_drive, false, &FoundRow::near_reversal) >= kFewestUnmasked)
      std::erase_if(of_drive, std::mem_fn(&FoundRow::near_reversal));
    rows.drives.push_back(stacked(of_drive, base.count()));
  }
  rows.unreachable = looked_at > 0 ? unreachable / looked_at : 1.0;
  return rows;
}

Points pick_points(const Sample& sample, Index count) {
  Points out;
  out.sigma_s = sample.sigma_s;
  Index available = 0;
  for (const Stretch& stretch : sample.stretches) available += std::max<Index>(0, stretch.last - stretch.first);
  const Index spacing = std::max<Index>(1, available / std::max<Index>(1, count));
  for (std::size_t s = 0; s < sample.stretches.size(); ++s) {
    const Stretch& stretch = sample.stretches[s];
    const Index reach = reach_of(sample, stretch);
    for (Index k = stretch.first + reach; k < stretch.last - reach; k += spacing) {
      if (!any_within(stretch.spoilt, k, reach)) out.at.push_back({static_cast<int>(s), k});
    }
  }
  const auto N = static_cast<Index>(out.at.size());
  const Index n = sample.stretches.empty() ? 0 : sample.stretches.front().q.cols();
  for (Eigen::MatrixXd* m : {&out.q, &out.qd, &out.qdd, &out.tau}) m->resize(N, n);
  out.torque_out.setConstant(N, n, false);
  for (Index row = 0; row < N; ++row) {
    const Place& place = out.at[static_cast<std::size_t>(row)];
    const Stretch& stretch = sample.stretches[static_cast<std::size_t>(place.stretch)];
    const Kernel kernel(sample.sigma_s, stretch.step_s, 0.0);
    const auto smooth = [&](const Eigen::MatrixXd& columns) -> Eigen::RowVectorXd {
      return kernel.weight[0].transpose() * columns.middleRows(place.point + kernel.from, kernel.weight[0].size());
    };
    out.q.row(row) = smooth(stretch.q);
    out.qd.row(row) = smooth(stretch.qd);
    out.qdd.row(row) = smooth(stretch.qdd);
    out.tau.row(row) = smooth(stretch.tau);
    const Index reach = reach_of(sample, stretch);
    out.torque_out.row(row) = stretch.torque_out.middleRows(place.point - reach, 2 * reach + 1).colwise().any();
  }
  return out;
}

Rows rows_of_points(const Robot& robot, const BaseParameters& base, const Points& points, const Reading& reading) {
  const int n = robot.drives();
  const Eigen::MatrixXd q = reading.apply(points.q, 0), qd = reading.apply(points.qd, 1),
                        qdd = reading.apply(points.qdd, 2);
  const Eigen::RowVectorXd floor = 0.02 * qd.cwiseAbs().colwise().maxCoeff();
  Rows rows;
  std::vector<std::vector<FoundRow>> found(static_cast<std::size_t>(n));
  Eigen::MatrixXd full(n, robot.parameters());
  Index unreachable = 0;
  PathPose path;
  for (Index k = 0; k < q.rows(); ++k) {
    const Eigen::VectorXd qk = q.row(k), vk = qd.row(k), ak = qdd.row(k);
    if (robot.regressor(qk, vk, ak, full, &path) != Status::ok || !full.allFinite()) {
      ++unreachable;
      continue;
    }
    for (int j = 0; j < n; ++j) {
      // The Gaussian smears the friction's step over what the drive takes to reverse.
      const double smeared = kSmear * points.sigma_s * std::abs(ak(j));
      if (std::abs(vk(j)) < std::max(floor(j), smeared) || points.torque_out.row(k).any()) continue;
      found[static_cast<std::size_t>(j)].push_back({{0, k}, full.row(j)(base.independent)});
    }
  }
  for (const std::vector<FoundRow>& of_drive : found) rows.drives.push_back(stacked(of_drive, base.count()));
  rows.unreachable = q.rows() > 0 ? static_cast<double>(unreachable) / static_cast<double>(q.rows()) : 1.0;
  return rows;
}

Eigen::MatrixXd values_at(const Sample& sample, const std::vector<Eigen::VectorXd>& column,
                          const std::vector<Place>& at, const std::vector<double>& shift_s_of_log, int derivatives,
                          double sigma_s) {
  Eigen::MatrixXd out(static_cast<Index>(at.size()), 1 + derivatives);
  std::vector<Kernel> kernels;  // one a stretch: steps and shifts may differ
  for (const Stretch& stretch : sample.stretches) {
    kernels.emplace_back(sigma_s, stretch.step_s,
                         shift_s_of_log.empty() ? 0.0 : shift_s_of_log[static_cast<std::size_t>(stretch.file)]);
  }
  for (std::size_t k = 0; k < at.size(); ++k) {
    const auto s = static_cast<std::size_t>(at[k].stretch);
    const auto window = column[s].segment(at[k].point + kernels[s].from, kernels[s].weight[0].size());
    for (int d = 0; d <= derivatives; ++d) {
      out(static_cast<Index>(k), d) = kernels[s].weight[static_cast<std::size_t>(d)].dot(window);
    }
  }
  return out;
}

}  // namespace deltadyn::gate
