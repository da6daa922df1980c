#include "data_fold.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/in_parallel.hpp"
#include "deltadyn/runtime/statistics.hpp"

namespace deltadyn {

namespace {

// Large enough for the QR to be efficient, small enough to stay in the cache
constexpr Eigen::Index kRowsPerBlock = 256;

/// Rows of `block` with the given use, drive by drive.
void add_rows(const RowBlock& block, int drive, RowUse use, const Eigen::VectorXd* p, const RowWeight& weight,
              DriveFold& fold) {
  const auto& Y = block.Y[static_cast<std::size_t>(drive)];
  Eigen::MatrixXd rows(block.rows(), Y.cols());
  Eigen::VectorXd tau(block.rows());
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < block.rows(); ++k) {
    if (block.use(k, drive) != use) continue;
    double scale = 1.0;
    if (p != nullptr && weight) scale = std::sqrt(weight(drive, block.tau(k, drive) - Y.row(k).dot(*p)));
    rows.row(count) = scale * Y.row(k);
    tau(count++) = scale * block.tau(k, drive);
  }
  if (count > 0) fold.add(rows.topRows(count), tau.head(count));
}

/// QR of [R d; Y tau] in place of the factor.
void triangularize(DriveFold& fold, const Eigen::Ref<const Eigen::MatrixXd>& Y,
                   const Eigen::Ref<const Eigen::VectorXd>& tau) {
  const Eigen::Index P = fold.R.cols();
  Eigen::MatrixXd stacked(P + Y.rows(), P + 1);
  stacked.topLeftCorner(P, P) = fold.R;
  stacked.topRightCorner(P, 1) = fold.d;
  stacked.bottomLeftCorner(Y.rows(), P) = Y;
  stacked.bottomRightCorner(Y.rows(), 1) = tau;
  const Eigen::MatrixXd R = dense::r_factor(stacked);
  fold.R = R.topLeftCorner(P, P);
  fold.d = R.topRightCorner(P, 1);
  if (stacked.rows() > P) {
    const double rest = R(P, P);
    fold.remainder += rest * rest;
  }
}

}  // namespace

DriveFold::DriveFold(Eigen::Index parameters)
    : R(Eigen::MatrixXd::Zero(parameters, parameters)), d(Eigen::VectorXd::Zero(parameters)) {}

void DriveFold::add(const Eigen::Ref<const Eigen::MatrixXd>& Y, const Eigen::Ref<const Eigen::VectorXd>& tau) {
  if (Y.rows() == 0) return;
  triangularize(*this, Y, tau);
  tau_square += tau.squaredNorm();
  tau_max = std::max(tau_max, tau.cwiseAbs().maxCoeff());
  rows += Y.rows();
}

void DriveFold::add(const DriveFold& other) {
  if (other.rows == 0) return;
  triangularize(*this, other.R, other.d);
  remainder += other.remainder;
  tau_square += other.tau_square;
  tau_max = std::max(tau_max, other.tau_max);
  rows += other.rows;
}

double DriveFold::square_error(const Eigen::Ref<const Eigen::VectorXd>& p) const {
  return (R * p - d).squaredNorm() + remainder;
}

double DriveFold::rms(const Eigen::Ref<const Eigen::VectorXd>& p) const {
  return root_mean_square(square_error(p), static_cast<double>(rows));
}

void DataFold::add(const DataFold& other) {
  if (regular.empty()) {
    *this = other;
    return;
  }
  for (std::size_t j = 0; j < regular.size(); ++j) {
    regular[j].add(other.regular[j]);
    reversal[j].add(other.reversal[j]);
  }
  samples += other.samples;
}

std::vector<DriveFold> DataFold::with_reversals(const std::vector<bool>& keep) const {
  std::vector<DriveFold> folds = regular;
  for (std::size_t j = 0; j < folds.size(); ++j) {
    if (keep[j]) folds[j].add(reversal[j]);
  }
  return folds;
}

std::vector<DriveFold> DataFold::to_begin_with() const {
  std::vector<bool> keep;
  for (std::size_t j = 0; j < regular.size(); ++j) keep.push_back(regular[j].rows < reversal[j].rows);
  return with_reversals(keep);
}

DataFold fold_log(const Robot& robot, const PreparedLog& log, int threads, const Eigen::VectorXd* p,
                  const RowWeight& weight) {
  const int n = robot.drives();
  const auto drives = static_cast<std::size_t>(n);
  DataFold fold;
  fold.regular.assign(drives, DriveFold(robot.parameters()));
  fold.reversal = fold.regular;
  const Eigen::Index blocks = (log.rows + kRowsPerBlock - 1) / kRowsPerBlock;
  const auto part_of = [&](Eigen::Index k) {
    RowBlock block;
    read_rows(robot, log, k * kRowsPerBlock, std::min(kRowsPerBlock, log.rows - k * kRowsPerBlock), block);
    DataFold part;
    part.regular.assign(drives, DriveFold(robot.parameters()));
    part.reversal = part.regular;
    for (int j = 0; j < n; ++j) {
      add_rows(block, j, RowUse::regular, p, weight, part.regular[static_cast<std::size_t>(j)]);
      add_rows(block, j, RowUse::reversal, p, weight, part.reversal[static_cast<std::size_t>(j)]);
    }
    return part;
  };
  in_parallel_in_order(
      blocks, part_of, [&](Eigen::Index, const DataFold& part) { fold.add(part); }, threads);
  fold.samples = log.t_s.size();
  return fold;
}

DataFold fold_logs(const Robot& robot, const std::vector<PreparedLog>& logs, int threads, const Eigen::VectorXd* p,
                   const RowWeight& weight) {
  DataFold fold;
  for (const PreparedLog& log : logs) fold.add(fold_log(robot, log, threads, p, weight));
  return fold;
}

}  // namespace deltadyn
