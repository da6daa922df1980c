#include "deltadyn/identification/noise_bias.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

#include "deltadyn/signal/motion_band.hpp"

#include "log_middle.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kSamples = 30'000;    // of each log: the excess is then known to a few per cent, whatever the log's length
constexpr Index kRowsPerBlock = 256;  // as in fold_log
constexpr double kMostNoise = 0.5;    // of a direction's information: beyond, what would be left is known worse than nothing
constexpr double kShown = 1e-3;       // of the largest eigenvalue: weaker directions are for other drives to show
constexpr double kNoise = 1e-10;      // of the largest eigenvalue: rounding

/// Y^T Y and Y^T tau of the used rows in the base parameters, rows chosen by `use_of` (that of the log without added noise).
struct Normal {
  std::vector<MatrixXd> information;
  std::vector<VectorXd> torque;
  Normal(Index drives, Index count)
      : information(static_cast<std::size_t>(drives), MatrixXd::Zero(count, count)),
        torque(static_cast<std::size_t>(drives), VectorXd::Zero(count)) {}
  void add(const Normal& other, double weight) {
    for (std::size_t j = 0; j < information.size(); ++j) {
      information[j] += weight * other.information[j];
      torque[j] += weight * other.torque[j];
    }
  }
};

Normal normal_of(const Robot& robot, const BaseParameters& base, const PreparedLog& log, const std::vector<bool>& keep) {
  const Index blocks = (log.rows + kRowsPerBlock - 1) / kRowsPerBlock, count = base.count();
  std::vector<Normal> parts(static_cast<std::size_t>(blocks), Normal(robot.drives(), count));
#pragma omp parallel for schedule(static, 1)
  for (Index b = 0; b < blocks; ++b) {
    RowBlock block;
    read_rows(robot, log, b * kRowsPerBlock, std::min(kRowsPerBlock, log.rows - b * kRowsPerBlock), block);
    for (std::size_t j = 0; j < keep.size(); ++j) {
      const auto drive = static_cast<Index>(j);
      MatrixXd Y(block.rows(), count);
      for (Index c = 0; c < count; ++c) Y.col(c) = block.Y[j].col(base.independent[static_cast<std::size_t>(c)]);
      VectorXd tau = block.tau.col(drive);
      for (Index k = 0; k < block.rows(); ++k) {
        const RowUse use = block.use(k, drive);
        if (use == RowUse::regular || (use == RowUse::reversal && keep[j])) continue;
        Y.row(k).setZero();
        tau(k) = 0;
      }
      parts[static_cast<std::size_t>(b)].information[j] = Y.transpose() * Y;
      parts[static_cast<std::size_t>(b)].torque[j] = Y.transpose() * tau;
    }
  }
  Normal sum(robot.drives(), count);
  for (const Normal& part : parts) sum.add(part, 1.0);
  return sum;
}

/// Std of the white noise of each drive's positions.
VectorXd noise_std(const Log& log) {
  VectorXd std(log.drives());
  const double rate_hz = 1.0 / log.sample_time_s();
  for (Index j = 0; j < log.drives(); ++j) std(j) = std::sqrt(motion_band(log.q.col(j), rate_hz).noise_density * rate_hz / 2);
  return std;
}

}  // namespace

NoiseBias simulate_noise_bias(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                              const ProcessingOptions& processing, const std::vector<bool>& keep_reversals, std::uint64_t seed,
                              int draws) {
  ProcessingOptions options = processing;
  options.periods = Periods::ignore;
  Normal excess(robot.drives(), base.count()), whole(robot.drives(), base.count());
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (const Log& log : logs) {
    const Log part = middle_of(log, kSamples);
    const double times = static_cast<double>(log.samples()) / static_cast<double>(part.samples());
    const VectorXd std = noise_std(part);
    const PreparedLog plain = prepare_log(robot, part, options);
    const Normal without = normal_of(robot, base, plain, keep_reversals);
    whole.add(without, times);
    for (int draw = 0; draw < draws; ++draw) {
      const MatrixXd noise =
          MatrixXd::NullaryExpr(part.samples(), part.drives(), [&]() { return normal(random); }) * std.asDiagonal();
      for (const double sign : {1.0, -1.0}) {
        Log noisy = part;
        noisy.q += sign * noise;
        PreparedLog prepared = prepare_log(robot, noisy, options);
        prepared.reversal = plain.reversal;  // the same rows on either side
        excess.add(normal_of(robot, base, prepared, keep_reversals), times / (2.0 * draws));
      }
    }
    excess.add(without, -times);
  }
  NoiseBias bias;
  bias.information = std::move(excess.information);
  bias.torque = std::move(excess.torque);
  for (std::size_t j = 0; j < bias.information.size(); ++j) {
    const VectorXd scale = whole.information[j].diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const MatrixXd G = scale.asDiagonal() * whole.information[j] * scale.asDiagonal();
    const MatrixXd D = scale.asDiagonal() * bias.information[j] * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(G);
    for (Index k = 0; k < G.rows(); ++k) {
      const double value = eigen.eigenvalues()(k);
      if (value < kShown * eigen.eigenvalues().maxCoeff()) continue;
      const VectorXd v = eigen.eigenvectors().col(k);
      bias.largest_share = std::max(bias.largest_share, v.dot(D * v) / value);
    }
  }
  return bias;
}

void take_off_noise(const BaseParameters& base, const MatrixXd& information, const VectorXd& torque, MatrixXd& R, VectorXd& d) {
  const Index count = base.count();
  MatrixXd R_base(R.rows(), count);
  for (Index c = 0; c < count; ++c) R_base.col(c) = R.col(base.independent[static_cast<std::size_t>(c)]);
  const VectorXd scale = R_base.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  const MatrixXd G = scale.asDiagonal() * (R_base.transpose() * R_base) * scale.asDiagonal();
  const MatrixXd D = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> of_G(G);
  const VectorXd root_size = of_G.eigenvalues().cwiseMax(kNoise * of_G.eigenvalues().maxCoeff()).cwiseSqrt();
  // In the directions of G, with each of size one, the excess is its share of the information.
  const MatrixXd root = of_G.eigenvectors() * root_size.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> of_share(root.transpose() * D * root);
  const MatrixXd U = root * of_share.eigenvectors();  // U^T G U = 1
  const VectorXd plain = U.transpose() * (scale.asDiagonal() * (R_base.transpose() * d));
  const VectorXd excess = U.transpose() * (scale.asDiagonal() * torque);
  VectorXd left(count), right(count);
  for (Index k = 0; k < count; ++k) {
    const double share = of_share.eigenvalues()(k);
    const bool known = share < kMostNoise;
    left(k) = known ? 1 - share : 1.0;
    right(k) = known ? plain(k) - excess(k) : plain(k);
  }
  const MatrixXd factor = left.cwiseSqrt().asDiagonal() * U.transpose() * G * scale.cwiseInverse().asDiagonal();
  R.setZero();
  d.setZero();
  R.topRows(count) = factor * base.B;
  d.head(count) = right.cwiseQuotient(left.cwiseSqrt());
}

}  // namespace deltadyn
