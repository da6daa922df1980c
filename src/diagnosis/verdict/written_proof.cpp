#include "written_proof.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "deltadyn/identification/log_gate.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/signal/motion_band.hpp"

#include "../evidence/eigen_names.hpp"

namespace deltadyn::detail {

namespace {

constexpr double kChance = 0.025;         // of a gain that is none: the upper end of a 95 % interval
constexpr double kWrittenBlock_s = 0.25;  // longer than the memory of the noise
constexpr Index kFewestDriveRows = 5;     // of a drive, below which its rms says nothing
constexpr int kWrittenResamples = 1000;
constexpr std::size_t kFewestBlocks = 12;  // from which they say anything about the noise

/// Squares of both residuals in rows that both models answer for, in units of the given model's, by blocks of time.
std::vector<Eigen::Array2d> blocks_of(const Prediction& before, const Prediction& after,
                                      const std::vector<int>& drives) {
  std::vector<Eigen::Array2d> blocks;
  if (before.rows() != after.rows() || before.rows() < 2) return blocks;
  const auto per_block = std::max<Index>(1, static_cast<Index>(kWrittenBlock_s / (before.t_s(1) - before.t_s(0))));
  const MatrixXd e0 = before.residual(), e1 = after.residual();
  for (const int j : drives) {
    const auto rows = (before.usable(j, false) && after.usable(j, false)).eval();
    const double scale =
        rows.select(e0.col(j).array(), 0.0).square().sum() / std::max<double>(1, static_cast<double>(rows.count()));
    if (!(scale > 0)) continue;
    for (Index first = 0; first < before.rows(); first += per_block) {
      const Index count = std::min(per_block, before.rows() - first);
      const auto use = rows.segment(first, count);
      if (!use.any()) continue;
      blocks.emplace_back(use.select(e0.col(j).segment(first, count).array(), 0.0).square().sum() / scale,
                          use.select(e1.col(j).segment(first, count).array(), 0.0).square().sum() / scale);
    }
  }
  return blocks;
}

double square(double x) {
  return x * x;
}

double chance_of_no_gain(const std::vector<Eigen::Array2d>& blocks, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const UniformIndex pick(blocks.size());
  int losses = 0;
  for (int k = 0; k < kWrittenResamples; ++k) {
    double gain = 0;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const Eigen::Array2d& one = blocks[pick(random)];
      gain += one(0) - one(1);
    }
    losses += gain <= 0 ? 1 : 0;
  }
  return (losses + 1.0) / (kWrittenResamples + 1.0);
}

/// \param touched  drives that the names reach
WrittenProof compare(const Validation& before, const Validation& after, const std::vector<int>& touched,
                     const DiagnosisOptions& options) {
  const DiagnosisPolicy& policy = options.policy;
  WrittenProof out;
  double gain = 0;  // of the named drives, in mean square
  for (const int j : touched) {
    const auto drive = static_cast<std::size_t>(j);
    gain += square(before.drives[drive].rms_residual) - square(after.drives[drive].rms_residual);
  }
  for (std::size_t j = 0; j < before.drives.size(); ++j) {
    const ValidatedDrive &b = before.drives[j], &a = after.drives[j];
    out.drives.push_back({b.rms_residual, a.rms_residual, b.rows, a.rows});
    if (std::min(b.rows, a.rows) < kFewestDriveRows) continue;
    const bool named = std::ranges::count(touched, static_cast<int>(j)) > 0;
    const double worse = named ? policy.worse : policy.worse_elsewhere;
    // Rows near reversals count where the given model answers for them.
    const bool near = b.reversal_rows < a.reversal_rows || b.rms_with_reversals < policy.worse * b.rms_residual;
    const auto is_worse = [&](double rms, double given) {
      return rms > worse * given && (named || square(rms) - square(given) > policy.loss_elsewhere * gain);
    };
    const bool loses = is_worse(a.rms_residual, b.rms_residual) ||
                       (near && is_worse(a.rms_with_reversals, std::max(b.rms_with_reversals, b.rms_residual)));
    if (loses && out.worse_drive < 0) out.worse_drive = static_cast<int>(j);
    if (b.rms_residual > 0) out.largest_loss = std::max(out.largest_loss, a.rms_residual / b.rms_residual);
  }
  const std::vector<Eigen::Array2d> blocks =
      blocks_of(before.logs.front().prediction, after.logs.front().prediction, touched);
  out.blocks = blocks.size();
  if (blocks.empty()) return out;
  const Eigen::Array2d all = std::accumulate(blocks.begin(), blocks.end(), Eigen::Array2d(0, 0));
  out.rms_ratio = std::sqrt(all(1) / all(0));
  out.p_no_gain = chance_of_no_gain(blocks, options.seed);
  out.clearly_better = out.rms_ratio < policy.clearly_better && out.p_no_gain < kChance && out.worse_drive < 0;
  return out;
}

/// The effects that a log which is none of the training logs can have: what acts in the log of a number is of training.
WrittenModel of_another_log(WrittenModel model) {
  std::erase_if(model.effects, [](const Effect& effect) { return of_one_log(effect.id) && effect.logs.empty(); });
  return model;
}

}  // namespace

bool WrittenProof::testable() const {
  return blocks >= kFewestBlocks;
}

bool WrittenProof::passed() const {
  return testable() && clearly_better;
}

const std::vector<Log>& ValidatedLogs::beside(const std::vector<Effect>& effects) const {
  return with_delay(holds_timing(effects));
}

const std::vector<Log>& ValidatedLogs::with_delay(bool keep) const {
  GateOptions gate;
  gate.keep_delay = keep;
  std::optional<std::vector<Log>>& logs = gate.keep_delay ? with_delay_ : mended_;
  if (!logs) logs = examine_logs(robot_, logs_, {}, {}, gate).logs;
  return *logs;
}

WrittenModel written_model(const VectorXd& p, const std::vector<Effect>& effects, const ProcessingOptions& extras) {
  return {p, effects, extras.presliding, extras.presliding_damping_s, extras.ripples};
}

GivenModel::GivenModel(const Robot& robot, const ValidatedLogs& holdout, const WrittenModel& model,
                       const DiagnosisOptions& options)
    : robot_(robot), holdout_(holdout), options_(options), model_(of_another_log(model)) {}

double GivenModel::chosen_cutoff_hz(const WrittenModel& model, bool keep_delay) const {
  const std::pair<bool, bool> key(keep_delay, holds_timing(model.effects));
  const auto known = cutoffs_hz_.find(key);
  if (known != cutoffs_hz_.end()) return known->second;
  const std::vector<Log>& logs = holdout_.with_delay(keep_delay);
  return cutoffs_hz_[key] = written_cutoff_hz(robot_, logs, model, options_.processing, keep_delay, options_.threads);
}

Validation GivenModel::validation_of(const WrittenModel& model, double cutoff_hz, bool keep_delay) const {
  ProcessingOptions processing = options_.processing;
  if (cutoff_hz > 0)
    processing.cutoff_hz = cutoff_hz;
  else if (processing.filter && options_.choose_cutoff)
    processing.cutoff_hz = chosen_cutoff_hz(model, keep_delay);
  return validate_written(robot_, holdout_.with_delay(keep_delay), model, processing, false, keep_delay,
                          options_.threads)
      .validation;
}

WrittenProof GivenModel::proof_at(double cutoff_hz, const WrittenModel& improved,
                                  const std::vector<int>& touched) const {
  // A delay that the improved model explains is in the log of both: else the check would have mended what one of them
  // lacks.
  const bool keep_delay = holds_timing(improved.effects);
  const std::pair<bool, double> key(keep_delay, cutoff_hz);
  if (validations_.count(key) == 0) validations_[key] = validation_of(model_, cutoff_hz, keep_delay);
  WrittenProof out = compare(validations_.at(key), validation_of(improved, cutoff_hz, keep_delay), touched, options_);
  out.cutoff_hz = cutoff_hz;
  return out;
}

WrittenProof GivenModel::compare_with(const WrittenModel& improved, const std::vector<int>& touched,
                                      double search_hz) const {
  const WrittenModel written = of_another_log(improved);
  WrittenProof out = proof_at(0, written, touched);
  if (out.testable() || !options_.choose_cutoff) return out;
  // A cut-off that leaves too little beside reversals gives way to the one of the search, then to that of the motion.
  const double motion_hz = choose_cutoff(holdout_.beside(written.effects)).cutoff_hz;
  for (const double cutoff_hz : {search_hz, motion_hz}) {
    WrittenProof wider = proof_at(cutoff_hz, written, touched);
    if (!wider.testable()) continue;
    // The few rows at delta-validate's own cut-off cannot bear the names out, but they can contradict a gain that is
    // small beside what is lost there.
    return wider.passed() && wider.rms_ratio * out.largest_loss >= 1 ? out : wider;
  }
  return out;
}

}  // namespace deltadyn::detail
