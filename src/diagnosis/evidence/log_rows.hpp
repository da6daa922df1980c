#pragma once

/// \file
/// A log as the diagnosis sees it: rows of the base regressor and of the torque, the state at each row, and the signals
/// that the catalogue's effects are computed from.

#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/effect_columns.hpp"

#include "noise_model.hpp"
#include "unknown_torque.hpp"

namespace deltadyn {

struct LogRows {
  PreparedLog log;
  int number = 1;               ///< among the training logs, from 1
  std::vector<MatrixXd> Y;      ///< for each drive: rows x base parameters
  MatrixXd tau;                 ///< rows x drives, without the torque of the known ripples
  MatrixXd ripple;              ///< rows x drives: that torque; empty: none
  std::vector<RowMask> usable;  ///< for each drive: rows with no reversal and no repaired sample in reach
  /// For each drive: rows of which something is known, in all directions but the unknown ones
  std::vector<RowMask> present;
  std::vector<std::vector<UnknownTorque>> unknown;  ///< for each drive: what reversals add to the rows that are present
  VectorXd t_s;                                     ///< of the rows' samples
  MatrixXd q, qd, qdd;                              ///< rows x drives
  EffectSignals signals;

  [[nodiscard]] Index rows() const { return tau.rows(); }
};

/// Rows of the base columns alone, low-passed, with the bristles' share of Coulomb's friction: for each drive rows x
/// base parameters.
[[nodiscard]] std::vector<MatrixXd> base_rows(const Robot& robot, const BaseParameters& base, const PreparedLog& log);

/// \param number  of the log among the training logs, from 1
/// The signals are left empty: they need parameters (EffectModel::signals).
[[nodiscard]] LogRows make_log_rows(const Robot& robot, const BaseParameters& base, PreparedLog log, int number);

/// What base parameters, in the head of beta, and amplitudes of the first columns of `effects` behind them leave of a
/// drive's torque.
[[nodiscard]] VectorXd without_model(const Eigen::Ref<const VectorXd>& torque, const MatrixXd& Y,
                                     const MatrixXd& effects, const VectorXd& beta);

/// The parameters closest to `around` that have the base parameters beta: p + B^T (B B^T)^-1 (beta - B p).
[[nodiscard]] VectorXd closest_parameters(const BaseParameters& base, const VectorXd& beta, const VectorXd& around);

/// Base parameters by ordinary least squares over all logs and drives, each drive in units of its own residual, as
/// closest_parameters().
[[nodiscard]] VectorXd refit_parameters(const BaseParameters& base, const std::vector<LogRows>& logs,
                                        const VectorXd& around);

}  // namespace deltadyn
