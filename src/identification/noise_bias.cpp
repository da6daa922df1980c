#include "noise_bias.hpp"

#include <algorithm>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/in_parallel.hpp"
#include "deltadyn/signal/log_part.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kBiasSamples = 100'000;  // of each log, from its middle
constexpr Index kBiasBlockRows = 256;    // as in fold_log
constexpr double kMostNoise = 0.99;      // of a direction's information: beyond, nothing is known there
constexpr double kNoise = 1e-10;         // of the largest eigenvalue: rounding

/// Products of one drive's used rows in the base parameters: regressor Y, instruments Z, torque tau.
struct Products {
  MatrixXd YtY, ZtY, ZtZ;
  VectorXd Yt_tau, Zt_tau;
  explicit Products(Index count = 0)
      : YtY(MatrixXd::Zero(count, count)), ZtY(YtY), ZtZ(YtY), Yt_tau(VectorXd::Zero(count)), Zt_tau(Yt_tau) {}
  void add(const Products& other, double times = 1) {
    YtY += times * other.YtY;
    ZtY += times * other.ZtY;
    ZtZ += times * other.ZtZ;
    Yt_tau += times * other.Yt_tau;
    Zt_tau += times * other.Zt_tau;
  }
};

/// Base columns of one drive's rows; rows that the fit does not use are zero.
MatrixXd base_rows(const BaseParameters& base, const RowBlock& block, std::size_t drive, const Eigen::VectorXd& used) {
  return used.asDiagonal() * block.Y[drive](Eigen::all, base.independent);
}

/// The rows that two readings of one log share are made the only ones of both.
void share_rows(PreparedLog& a, PreparedLog& b) {
  const Index first = std::max(a.first, b.first);
  const Index last = std::min(a.first + a.rows * a.stride, b.first + b.rows * b.stride);
  for (PreparedLog* log : {&a, &b}) {
    log->first = first;
    log->rows = std::max<Index>(0, (last - first) / log->stride);
  }
}

std::vector<Products> products_of(const Robot& robot, const BaseParameters& base, const PreparedLog& log,
                                  const PreparedLog& narrow, const std::vector<bool>& keep) {
  const Index blocks = (log.rows + kBiasBlockRows - 1) / kBiasBlockRows;
  std::vector<Products> sum(keep.size(), Products(base.count()));
  const auto products_of_block = [&](Index b) {
    const Index first = b * kBiasBlockRows, count = std::min(kBiasBlockRows, log.rows - first);
    RowBlock wide, instruments;
    read_rows(robot, log, first, count, wide);
    read_rows(robot, narrow, first, count, instruments);
    std::vector<Products> products(keep.size());
    for (std::size_t j = 0; j < keep.size(); ++j) {
      const auto drive = static_cast<Index>(j);
      const VectorXd used = usable_rows(wide.use, drive, keep[j]).cast<double>();
      const MatrixXd Y = base_rows(base, wide, j, used), Z = base_rows(base, instruments, j, used);
      const VectorXd tau = wide.tau.col(drive);
      Products& part = products[j];
      part.YtY = Y.transpose() * Y;
      part.ZtY = Z.transpose() * Y;
      part.ZtZ = Z.transpose() * Z;
      part.Yt_tau = Y.transpose() * tau;
      part.Zt_tau = Z.transpose() * tau;
    }
    return products;
  };
  in_parallel_in_order(blocks, products_of_block, [&](Index, const std::vector<Products>& products) {
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j].add(products[j]);
  });
  return sum;
}

/// Inverse of Z^T Z in the directions that the instruments span.
MatrixXd inverse_of(const MatrixXd& ZtZ) {
  const VectorXd scale = ZtZ.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const dense::Spectrum of_Z = dense::spectrum(scale.asDiagonal() * ZtZ * scale.asDiagonal());
  const double least = kNoise * of_Z.values.maxCoeff();
  const VectorXd inverse = (of_Z.values.array() > least).select(of_Z.values.array().inverse(), 0.0);
  const MatrixXd V = scale.asDiagonal() * of_Z.vectors;
  return V * inverse.asDiagonal() * V.transpose();
}

}  // namespace

NoiseBias noise_bias(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                     const ProcessingOptions& processing, const std::vector<bool>& keep_reversals,
                     double instrument_hz) {
  ProcessingOptions wide = processing;
  wide.periods = Periods::ignore;
  ProcessingOptions narrow = wide;
  narrow.motion_over_pass = std::min(wide.motion_over_pass, instrument_hz / wide.cutoff_hz);
  NoiseBias bias;
  for (int j = 0; j < robot.drives(); ++j) {
    bias.information.emplace_back(MatrixXd::Zero(base.count(), base.count()));
    bias.torque.emplace_back(VectorXd::Zero(base.count()));
  }
  if (!(narrow.motion_over_pass < wide.motion_over_pass)) return bias;
  std::vector<Products> sum(bias.information.size(), Products(base.count()));
  for (const Log& log : logs) {
    const Log part = middle_of(log, kBiasSamples);
    PreparedLog plain = prepare_log(robot, part, wide), smooth = prepare_log(robot, part, narrow);
    const auto all_rows =
        static_cast<double>(plain.rows) * static_cast<double>(log.samples()) / static_cast<double>(part.samples());
    share_rows(plain, smooth);
    if (plain.rows == 0) continue;
    const std::vector<Products> products = products_of(robot, base, plain, smooth, keep_reversals);
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j].add(products[j], all_rows / static_cast<double>(plain.rows));
  }
  for (std::size_t j = 0; j < sum.size(); ++j) {
    const Products& s = sum[j];
    const MatrixXd first_stage = inverse_of(s.ZtZ) * s.ZtY;  // regression of Y on Z
    bias.information[j] = s.YtY - s.ZtY.transpose() * first_stage;
    bias.information[j] = 0.5 * (bias.information[j] + bias.information[j].transpose()).eval();
    bias.torque[j] = s.Yt_tau - first_stage.transpose() * s.Zt_tau;
  }
  return bias;
}

void take_off_noise(const BaseParameters& base, const MatrixXd& information, const VectorXd& torque, MatrixXd& R,
                    VectorXd& d) {
  const Index count = base.count();
  const MatrixXd R_base = R(Eigen::all, base.independent);
  const VectorXd scale = R_base.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  const MatrixXd G = scale.asDiagonal() * (R_base.transpose() * R_base) * scale.asDiagonal();
  const MatrixXd D = scale.asDiagonal() * information * scale.asDiagonal();
  const dense::Spectrum of_G = dense::spectrum(G);
  const VectorXd root_size = of_G.values.cwiseMax(kNoise * of_G.values.maxCoeff()).cwiseSqrt();
  // In the directions of G, with each of size one, the excess is its share of the information.
  const MatrixXd root = of_G.vectors * root_size.cwiseInverse().asDiagonal();
  const dense::Spectrum of_share = dense::spectrum(root.transpose() * D * root);
  const MatrixXd U = root * of_share.vectors;  // U^T G U = 1
  const VectorXd plain = U.transpose() * (scale.asDiagonal() * (R_base.transpose() * d));
  const VectorXd excess = U.transpose() * (scale.asDiagonal() * torque);
  VectorXd left(count), right(count);
  for (Index k = 0; k < count; ++k) {
    const double share = of_share.values(k);
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
