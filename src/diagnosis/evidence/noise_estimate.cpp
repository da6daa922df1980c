#include "noise_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/statistics.hpp"

namespace deltadyn {

namespace {

constexpr int kPasses = 3;
constexpr double kRidge = 1e-6;  // of the generic basis, whose hats overlap
constexpr Index kLargestOrder = 20;
constexpr double kLongestMemory_s = 0.15;  // of what counts as noise; what is slower is drift or structure
constexpr double kLeastWhite = 0.05;       // of the variance, white in every noise model
constexpr double kFewUsable = 0.35;        // share of rows far from reversals, below which the others serve, too
constexpr int kMostBlocks = 6;             // of the basis that the noise of one drive is freed of

/// The rows of a drive that show its noise: those far from reversals, or, where they are few, all of them without the
/// directions that reversals take.
class NoiseRows {
 public:
  NoiseRows(const LogRows& log, std::size_t drive, double std) : rows_(log.usable[drive]) {
    count_ = static_cast<double>(rows_.count());
    if (count_ >= kFewUsable * static_cast<double>(rows_.size())) return;
    all_.emplace(NoiseModel{{}, std}, log.present[drive], log.unknown[drive]);
    rows_ = log.present[drive];
    count_ = static_cast<double>(all_->freedom());
    std_ = std;
  }

  [[nodiscard]] NoiseModel noise(const VectorXd& residual, double row_s) const {
    const double damping = std::exp(-row_s / kLongestMemory_s);
    if (!all_) return fit_noise_model(residual, rows_, kLargestOrder, damping);
    NoiseModel out = fit_noise_model(without_unknown(residual), rows_, kLargestOrder, damping);
    out.std *= std::sqrt(static_cast<double>(all_->rows()) / std::max(count_, 1.0));
    return out;
  }
  [[nodiscard]] double squares(const VectorXd& residual) const {
    return rows_.select((all_ ? without_unknown(residual) : residual).array(), 0.0).square().sum();
  }
  /// Of independent values.
  [[nodiscard]] double count() const { return count_; }

 private:
  [[nodiscard]] VectorXd without_unknown(const VectorXd& residual) const {
    const VectorXd white = all_->apply(residual);
    VectorXd out = VectorXd::Zero(residual.size());
    for (std::size_t k = 0; k < all_->source().size(); ++k)
      out(all_->source()[k]) = std_ * white(static_cast<Index>(k));
    return out;
  }

  RowMask rows_;
  std::optional<Whitener> all_;
  double std_ = 1, count_ = 0;
};

/// One drive in all logs: what is left of it, in rows and white, and the basis beside it.
class DriveResidual {
 public:
  DriveResidual(const std::vector<LogRows>& logs, const WhiteProblem& problem, const GenericBasis& basis,
                const PerLogAndDrive<MatrixXd>& extra, std::size_t drive)
      : logs_(logs), basis_(basis), drive_(drive) {
    const Index b = logs.front().Y.front().cols();
    const Index columns = basis.columns.front()[drive].cols();
    gram_ = MatrixXd::Zero(columns, columns);
    inner_ = VectorXd::Zero(columns);
    for (std::size_t l = 0; l < logs.size(); ++l) {
      VectorXd e = logs[l].tau.col(static_cast<Index>(drive)) - logs[l].Y[drive] * problem.beta.head(b);
      if (!extra.empty()) e -= extra[l][drive] * problem.beta.tail(problem.beta.size() - b);
      residual_.push_back(std::move(e));
    }
    for (const WhiteSegment& segment : problem.segments) {
      if (segment.drive != drive) continue;
      noise_rows_.emplace_back(logs[segment.log], drive, segment.whitener.noise().total_std());
      rows_ += noise_rows_.back().count();
      const MatrixXd white = segment.whitener.apply(basis.columns[segment.log][drive]);
      gram_ += white.transpose() * white;
      inner_ += white.transpose() * problem.r.segment(segment.offset, segment.rows());
    }
  }

  struct Fit {
    std::vector<std::size_t> blocks;
    Index columns = 0;
    std::vector<VectorXd> residual;
    std::vector<NoiseModel> noise;
    std::vector<double> squares;  ///< of the residual in the rows that show the noise
    double log_likelihood = 0;
  };

  /// The basis' blocks that raise the likelihood by more than their columns cost, the best first.
  [[nodiscard]] Fit choose() const {
    Fit best = fit({});
    const std::size_t count = basis_.blocks[drive_].size();
    for (int step = 0; step < kMostBlocks; ++step) {
      Fit next = best;
      for (std::size_t block = 0; block < count; ++block) {
        if (std::count(best.blocks.begin(), best.blocks.end(), block) > 0) continue;
        std::vector<std::size_t> blocks = best.blocks;
        blocks.push_back(block);
        Fit trial = fit(std::move(blocks));
        if (trial.log_likelihood > next.log_likelihood) next = std::move(trial);
      }
      if (next.blocks.size() == best.blocks.size()) break;
      best = std::move(next);
    }
    return best;
  }

  [[nodiscard]] double rows() const { return rows_; }
  [[nodiscard]] double rows(std::size_t log) const { return noise_rows_[log].count(); }

 private:
  [[nodiscard]] Fit fit(std::vector<std::size_t> blocks) const {
    Fit out;
    out.blocks = std::move(blocks);
    std::vector<Index> chosen;
    for (const std::size_t block : out.blocks) {
      const auto& [first, count] = basis_.blocks[drive_][block];
      for (Index c = first; c < first + count; ++c) chosen.push_back(c);
    }
    out.columns = static_cast<Index>(chosen.size());
    out.residual = residual_;
    if (!chosen.empty()) {
      MatrixXd G = gram_(chosen, chosen);
      const VectorXd scale = G.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
      G = scale.asDiagonal() * G * scale.asDiagonal();
      G.diagonal().array() += kRidge;
      const VectorXd u = inner_(chosen);
      const VectorXd coefficients = scale.asDiagonal() * dense::solve_symmetric(G, VectorXd(scale.asDiagonal() * u));
      for (std::size_t l = 0; l < logs_.size(); ++l)
        out.residual[l] -= basis_.columns[l][drive_](Eigen::all, chosen) * coefficients;
    }
    for (std::size_t l = 0; l < logs_.size(); ++l) {
      const double count = noise_rows_[l].count();
      out.noise.push_back(noise_rows_[l].noise(out.residual[l], logs_[l].t_s(1) - logs_[l].t_s(0)));
      out.squares.push_back(noise_rows_[l].squares(out.residual[l]));
      out.log_likelihood -= count * std::log(std::max(out.noise.back().std, 1e-300)) +
                            0.5 * static_cast<double>(out.noise.back().order()) * std::log(std::max(count, 1.0));
    }
    out.log_likelihood -= 0.5 * static_cast<double>(out.columns) * std::log(std::max(rows_, 1.0));
    return out;
  }

  const std::vector<LogRows>& logs_;
  const GenericBasis& basis_;
  std::size_t drive_;
  std::vector<VectorXd> residual_;
  std::vector<NoiseRows> noise_rows_;  ///< of each log
  MatrixXd gram_;
  VectorXd inner_;
  double rows_ = 0;
};

}  // namespace

NoiseEstimate estimate_noise(const std::vector<LogRows>& logs, const GenericBasis& basis,
                             const PerLogAndDrive<MatrixXd>& extra, const PerLogAndDrive<NoiseModel>* start) {
  const std::size_t n = logs.front().usable.size();
  NoiseEstimate out;
  if (start != nullptr) {
    out.noise = *start;
  } else {
    // Drives weighted by their torque to begin with.
    out.noise.assign(logs.size(), std::vector<NoiseModel>(n));
    for (std::size_t l = 0; l < logs.size(); ++l) {
      for (std::size_t j = 0; j < n; ++j) {
        const auto tau = logs[l].tau.col(static_cast<Index>(j));
        out.noise[l][j].std = std::max(1e-2 * root_mean_square(tau), 1e-9);
      }
    }
  }
  out.floor_rms.assign(logs.size(), std::vector<double>(n, 0.0));
  const int passes = start != nullptr ? 1 : kPasses;
  for (int pass = 0; pass < passes; ++pass) {
    const WhiteProblem problem(logs, out.noise, extra);
    out.log_likelihood = 0;
    PerLogAndDrive<NoiseModel> next = out.noise;
    for (std::size_t j = 0; j < n; ++j) {
      const DriveResidual drive(logs, problem, basis, extra, j);
      const DriveResidual::Fit fit = drive.choose();
      const double spent =
          static_cast<double>(fit.columns) + static_cast<double>(problem.Q.cols()) / static_cast<double>(n);
      const double correction = std::sqrt(drive.rows() / std::max(drive.rows() - spent, 0.2 * drive.rows()));
      out.log_likelihood += fit.log_likelihood;
      for (std::size_t l = 0; l < logs.size(); ++l) {
        NoiseModel& model = next[l][j];
        model = fit.noise[l];
        model.std *= correction;
        model = with_white_share(model, kLeastWhite);
        out.floor_rms[l][j] = correction * std::sqrt(fit.squares[l] / std::max(1.0, drive.rows(l)));
        const double floor = 1e-9 * std::max(logs[l].tau.col(static_cast<Index>(j)).cwiseAbs().maxCoeff(), 1e-9);
        model.std = std::max(model.std, floor);
      }
    }
    out.noise = std::move(next);
  }
  return out;
}

}  // namespace deltadyn
