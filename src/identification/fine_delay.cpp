#include "deltadyn/identification/fine_delay.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "deltadyn/identification/effect_columns.hpp"
#include "deltadyn/signal/differentiate.hpp"
#include "deltadyn/signal/log_part.hpp"
#include "deltadyn/signal/torque_timing_mend.hpp"

#include "partial_fit.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kDelaySamples = 20'000;  // of each log, as for presliding
constexpr int kSteps = 4;                // of Gauss and Newton; three suffice
constexpr double kSigmas = 5;            // a delay within these is chance
constexpr double kLeast = 0.05;          // of a sample: less is no matter
constexpr double kMost = 3;              // samples; a larger one is for the gate
// Of the torque: above it what the model lacks can pass for a delay, as in the gate
constexpr double kCleanDelayFit = 0.015;
constexpr double kAlike = 4;  // standard deviations of the drives' own delays about the common one
constexpr double kDampingStep_s = 1e-3, kDisplacementStep = 0.02;  // for the slopes; the second is a share

class DelaySearch {
 public:
  DelaySearch(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
              const ProcessingOptions& processing, const VectorXd* known)
      : robot_(robot), base_(base), processing_(processing), coulomb_(coulomb_columns(robot)), known_(known) {
    processing_.periods = Periods::ignore;
    if (processing_.presliding_damping_s.size() == 0)
      processing_.presliding_damping_s.setZero(processing_.presliding.size());
    for (const Log& log : logs) logs_.push_back(middle_of(log, kDelaySamples));
    sample_s_ = logs.front().sample_time_s();
  }

  FineDelay run() {
    FineDelay out;
    for (int step = 0; step < kSteps; ++step) {
      const PartialFit fit = prepare(out.delay_s);
      const PartialFit::Result result = fit.with(columns({-1}));
      const double change = result.amplitude(0);
      out.delay_s += change;
      out.std_s = result.std(0);
      move_bristles(fit, result);
      if (std::abs(out.delay_s) > kMost * sample_s_) return out;
      if (std::abs(change) < 0.2 * out.std_s) break;
    }
    out.certain = clean_ && std::abs(out.delay_s) > std::max(kSigmas * out.std_s, kLeast * sample_s_) &&
                  drives_agree(out.delay_s);
    return out;
  }

 private:
  /// Rows with the present delay taken out and the present bristles.
  PartialFit prepare(double delay_s) {
    prepared_.clear();
    torque_.clear();
    std::vector<BaseRows> rows;
    shifted_ = without_delay(logs_, delay_s);
    for (const Log& log : shifted_) {
      prepared_.push_back(prepare_log(robot_, log, processing_));
      RowUses use;
      rows.push_back(base_rows(robot_, base_, prepared_.back(), use));
      rows.back().weight = (use == RowUse::regular).cast<double>().matrix();
      torque_.push_back(rows.back().tau);
      if (known_ == nullptr) continue;
      for (Index j = 0; j < robot_.drives(); ++j) {
        MatrixXd& X = rows.back().X[static_cast<std::size_t>(j)];
        rows.back().tau.col(j) -= X * (base_.B * *known_);
        X.setZero();
      }
    }
    clean_ = is_clean(weigh_by_residual(rows, 2), rows);
    rows_ = rows;
    return PartialFit(std::move(rows));
  }

  /// Does the model explain the torque of every drive but for noise?
  /// \param left  mean square of each drive's residual
  [[nodiscard]] bool is_clean(const VectorXd& left, const std::vector<BaseRows>& rows) const {
    for (Index j = 0; j < left.size(); ++j) {
      double torque = 0, count = 0;
      for (std::size_t l = 0; l < rows.size(); ++l) {
        const Eigen::Array<bool, Eigen::Dynamic, 1> usable = rows[l].weight.col(j).array() > 0;
        torque += usable.select(torque_[l].col(j).array(), 0.0).square().sum();
        count += static_cast<double>(usable.count());
      }
      if (!(left(j) * count < kCleanDelayFit * kCleanDelayFit * torque)) return false;
    }
    return true;
  }

  /// What a later torque does to the rows, for each of the drives (-1: all alike), then slopes of the bristles'
  /// friction.
  [[nodiscard]] std::vector<Columns> columns(const std::vector<int>& drives) const {
    std::vector<Columns> out(prepared_.size());
    for (std::size_t l = 0; l < prepared_.size(); ++l) {
      const PreparedLog& log = prepared_[l];
      const MatrixXd rate = low_passed_rows(log, differentiate(log.tau, 1 / log.rate_hz, 1, 3));
      for (const int drive : drives) {
        MatrixXd column = -rate;
        for (Index j = 0; j < column.cols(); ++j) {
          if (drive >= 0 && j != drive) column.col(j).setZero();
        }
        out[l].push_back(std::move(column));
      }
    }
    for (Index joint = 0; joint < processing_.presliding.size() && known_ == nullptr; ++joint) {
      if (base_index(joint) < 0 || !(processing_.presliding(joint) > 0)) continue;
      ProcessingOptions damped = processing_, wider = processing_;
      damped.presliding_damping_s(joint) += kDampingStep_s;
      wider.presliding(joint) *= 1 + kDisplacementStep;
      add_slope(damped, joint, kDampingStep_s, out);
      add_slope(wider, joint, kDisplacementStep * processing_.presliding(joint), out);
    }
    return out;
  }

  void add_slope(const ProcessingOptions& changed, Index joint, double step, std::vector<Columns>& out) const {
    for (std::size_t l = 0; l < shifted_.size(); ++l) {
      RowUses use;
      const BaseRows there = base_rows(robot_, base_, prepare_log(robot_, shifted_[l], changed), use);
      MatrixXd column(there.tau.rows(), there.tau.cols());
      for (Index j = 0; j < column.cols(); ++j) {
        const auto drive = static_cast<std::size_t>(j);
        column.col(j) = (there.X[drive].col(base_index(joint)) - rows_[l].X[drive].col(base_index(joint))) / step;
      }
      out[l].push_back(std::move(column));
    }
  }

  /// The joint's Coulomb friction among the base parameters; -1: not there.
  [[nodiscard]] Index base_index(Index joint) const {
    return base_.place_of(coulomb_[static_cast<std::size_t>(joint)]);
  }

  /// The slopes' amplitudes are changes of the shapes times the friction.
  void move_bristles(const PartialFit& fit, const PartialFit::Result& result) {
    if (known_ != nullptr) return;
    const VectorXd beta = fit.base_parameters();
    Index at = 1;
    for (Index joint = 0; joint < processing_.presliding.size(); ++joint) {
      if (base_index(joint) < 0 || !(processing_.presliding(joint) > 0)) continue;
      const double friction = std::max(beta(base_index(joint)), 1e-12);
      double &damping = processing_.presliding_damping_s(joint), &displacement = processing_.presliding(joint);
      damping = std::max(0.0, damping + result.amplitude(at) / friction);
      displacement =
          std::clamp(displacement + result.amplitude(at + 1) / friction, 0.5 * displacement, 2 * displacement);
      at += 2;
    }
  }

  /// One recorder delays all drives alike; what the model lacks does not.
  [[nodiscard]] bool drives_agree(double delay_s) {
    const PartialFit fit = prepare(delay_s);
    std::vector<int> drives;
    for (int j = 0; j < robot_.drives(); ++j) drives.push_back(j);
    const PartialFit::Result result = fit.with(columns(drives));
    for (Index j = 0; j < robot_.drives(); ++j) {
      if (std::abs(result.amplitude(j)) > kAlike * result.std(j)) return false;
    }
    return true;
  }

  const Robot& robot_;
  const BaseParameters& base_;
  ProcessingOptions processing_;
  std::vector<Index> coulomb_;
  const VectorXd* known_;
  std::vector<Log> logs_, shifted_;
  std::vector<PreparedLog> prepared_;
  std::vector<BaseRows> rows_;
  std::vector<MatrixXd> torque_;  ///< rows x drives of each log
  double sample_s_ = 0;
  bool clean_ = false;
};

}  // namespace

FineDelay find_fine_delay(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                          const ProcessingOptions& processing, const VectorXd* known) {
  if (logs.empty() || !processing.filter || !(processing.presliding.array() > 0).any()) return {};
  return DelaySearch(robot, base, logs, processing, known).run();
}

std::vector<Log> without_delay(std::vector<Log> logs, double delay_s) {
  if (delay_s == 0) return logs;
  for (Log& log : logs) {
    const double step_s = log.sample_time_s();
    for (Index j = 0; j < log.tau.cols(); ++j) log.tau.col(j) = mend_timing(log.tau.col(j), step_s, delay_s, 0.0);
    const auto lost = std::min<Index>(log.samples(), static_cast<Index>(std::ceil(std::abs(delay_s) / step_s)));
    const Index begin = delay_s > 0 ? log.samples() - lost : 0;
    log.leave_out(begin, begin + lost);
  }
  return logs;
}

}  // namespace deltadyn
