#pragma once

/// \file
/// The proof of what is written: the model as given and the improved one on the hold-out log, on the path of
/// delta-validate.

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "deltadyn/diagnosis/diagnose.hpp"
#include "deltadyn/identification/written_model.hpp"

namespace deltadyn::detail {

struct WrittenProof {
  std::vector<HoldoutFigure> drives;
  /// Improved over given, over the drives that the names reach, each in units of its own residual
  double rms_ratio = 1;
  double p_no_gain = 1;         ///< chance that the improved model is no better (paired block bootstrap)
  int worse_drive = -1;         ///< from 0: it got worse; -1: none
  double largest_loss = 1;      ///< improved over given of the drive that got worst; 1: none did
  bool clearly_better = false;  ///< beyond chance, and no drive worse
  std::size_t blocks = 0;       ///< of rows that both models answer for
  double cutoff_hz = 0;         ///< that delta-validate must be given for these figures; 0: the one that it chooses
  /// Are there rows enough for a proof either way?
  [[nodiscard]] bool testable() const;
  [[nodiscard]] bool passed() const;
};

/// Logs as delta-validate takes them: a delay that is certain is removed, unless the effects explain it. The checks
/// that find it take longer than a fit, so each of the two answers is found once, when it is asked for.
class ValidatedLogs {
 public:
  ValidatedLogs(const Robot& robot, std::vector<Log> logs) : robot_(robot), logs_(std::move(logs)) {}

  /// Not for several threads at a time.
  [[nodiscard]] const std::vector<Log>& beside(const std::vector<Effect>& effects) const;
  [[nodiscard]] const std::vector<Log>& with_delay(bool keep) const;

 private:
  const Robot& robot_;
  std::vector<Log> logs_;
  mutable std::optional<std::vector<Log>> mended_, with_delay_;
};

/// The model as its files would hold it.
/// \param extras  its bristles and ripples are the model's
[[nodiscard]] WrittenModel written_model(const Eigen::VectorXd& p, const std::vector<Effect>& effects,
                                         const ProcessingOptions& extras);

/// The model as given on the hold-out log. Every improved one is compared with it, so that what both comparisons need
/// is found once. Not for several threads at a time.
class GivenModel {
 public:
  GivenModel(const Robot& robot, const ValidatedLogs& holdout, const WrittenModel& model,
             const DiagnosisOptions& options);

  /// \param touched    drives from 0 that the named effects reach
  /// \param search_hz  cut-off of the search, for hold-out logs in which the chosen one leaves too few rows
  /// Throws deltadyn::Error as validate_written() does.
  [[nodiscard]] WrittenProof compare_with(const WrittenModel& improved, const std::vector<int>& touched,
                                          double search_hz) const;

 private:
  /// At a cut-off of 0 each model is validated at the one that delta-validate chooses for it.
  [[nodiscard]] WrittenProof proof_at(double cutoff_hz, const WrittenModel& improved,
                                      const std::vector<int>& touched) const;
  [[nodiscard]] Validation validation_of(const WrittenModel& model, double cutoff_hz, bool keep_delay) const;
  [[nodiscard]] double chosen_cutoff_hz(const WrittenModel& model, bool keep_delay) const;

  const Robot& robot_;
  const ValidatedLogs& holdout_;
  const DiagnosisOptions& options_;
  WrittenModel model_;
  mutable std::map<std::pair<bool, bool>, double> cutoffs_hz_;  ///< by keep_delay, and a model that holds_timing()
  mutable std::map<std::pair<bool, double>, Validation> validations_;  ///< of `model_`, by keep_delay and cut-off
};

}  // namespace deltadyn::detail
