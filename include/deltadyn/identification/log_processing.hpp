#pragma once

/// \file
/// From a recorded log to rows of the regression tau = Y p: filtering, derivatives, masks, decimation.
///
/// Positions are filtered without phase lag at `cutoff_hz` and differentiated. Regressor and torque then pass one and
/// the same linear-phase low pass and are decimated together, so that the filter does not bias the parameters.

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "deltadyn/identification/ripple.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/fir_decimator.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn {

/// How a log that repeats itself is used.
enum class Periods {
  detect,  ///< a log that consists of equal periods, nine tenths of it at least, counts as periodic
  given,   ///< ProcessingOptions::period_s
  ignore   ///< every log is filtered like any other
};

struct ProcessingOptions {
  bool filter = true;     ///< false: torque, q, qd, qdd of the log as they are (then qd and qdd are required)
  double cutoff_hz = 50;  ///< of rows: pass band that motion and torque share
  /// -3 dB point of the positions' filter (two passes together) in units of cutoff_hz. Wider than the rows' low pass,
  /// so that what the filter bends of the motion lies beyond it; the noise that it lets through does, too.
  double motion_over_pass = 2;
  double torque_cutoff_ratio = 1.25;  ///< -6 dB point of the low pass of regressor and torque, in units of cutoff_hz
  Periods periods = Periods::detect;  ///< periodic logs: Fourier fit of the motion, torque averaged over the periods
  double period_s = 0;                ///< used if periods is `given`
  /// A rate below this share of the joint's largest one has no certain sign, nor one in its noise
  double reversal_floor = 0.003;
  /// Of each joint with friction (drives, then the inner one) the displacement over which its friction builds up after
  /// a reversal [rad | m] (effects/bristle.hpp); 0 or absent: Coulomb's law, whose sign is uncertain near reversals.
  Eigen::VectorXd presliding;
  Eigen::VectorXd presliding_damping_s;  ///< of the same joints' bristles; 0 or absent: none
  std::vector<Ripple> ripples;           ///< torque that the model holds beside Y p
  int stride = 0;                        ///< use every stride-th sample; 0: what the pass band asks for

  /// A cut-off far below the band of the motion (choose_cutoff) is one of the rows: the positions keep their band.
  void keep_motion(double motion_hz);

  /// Throws deltadyn::Error naming the field.
  void validate() const;
};

/// A log made ready: motion filtered, torque as recorded. Rows are numbered from 0; row k belongs to sample first + k
/// stride of the log.
struct PreparedLog : Log {
  double rate_hz = 0;
  std::shared_ptr<const FirDecimator> low_pass;  ///< null without filter
  Eigen::Index first = 0, rows = 0, stride = 1;
  std::optional<double> period_s;  ///< of a periodic log, whose samples then are means over the periods
  /// N x drives: the sign of a friction in this drive's torque is uncertain
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> reversal;
  /// N x drives: a joint whose friction this drive feels stands still
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> rest;
  /// N x joints with friction: what the bristles hold of Coulomb's friction, with the sign of the rate taken out; 1 for
  /// a joint without presliding. Empty if no joint has any. The joints' Coulomb columns in the regressor are multiplied
  /// by it.
  Eigen::MatrixXd coulomb_share;
  Eigen::MatrixXd ripple;  ///< N x drives: torque of ProcessingOptions::ripples; empty: none

  [[nodiscard]] double row_rate_hz() const { return rate_hz / static_cast<double>(stride); }
};

/// Filters, differentiates and masks one log. Throws deltadyn::Error with file and line for poses out of reach,
/// singular poses, logs too short for the cut-off, and missing derivatives when filter is off.
[[nodiscard]] PreparedLog prepare_log(const Robot& robot, const Log& log, const ProcessingOptions& options);
[[nodiscard]] std::vector<PreparedLog> prepare_logs(const Robot& robot, const std::vector<Log>& logs,
                                                    const ProcessingOptions& options);

/// Do samples [first, first + count) hold one that must not enter a row of this drive (Log::filled, Log::torque_out)?
[[nodiscard]] bool left_out(const PreparedLog& log, int drive, Eigen::Index first, Eigen::Index count);

/// What a row may be used for.
enum class RowUse : char {
  regular,   ///< for every fit
  reversal,  ///< a velocity reversal is in reach of the filter: only where static friction is no matter
  unusable   ///< samples that are left out are in reach of the filter, or rest, where static friction takes any value
};

/// Rows x drives.
using RowUses = Eigen::Array<RowUse, Eigen::Dynamic, Eigen::Dynamic>;

/// Rows of a drive that count: all but the unusable ones, and without those near reversals if asked.
[[nodiscard]] Eigen::Array<bool, Eigen::Dynamic, 1> usable_rows(const RowUses& use, Eigen::Index drive,
                                                                bool with_reversals);

/// Consecutive rows of a prepared log.
struct RowBlock {
  Eigen::Index first_row = 0;
  std::vector<Eigen::MatrixXd> Y;  ///< for each drive: rows x parameters
  /// Rows x drives, filtered as Y, without the torque of ripples
  Eigen::MatrixXd tau;
  Eigen::MatrixXd ripple;  ///< rows x drives: that torque; empty: none
  RowUses use;

  [[nodiscard]] Eigen::Index rows() const { return tau.rows(); }
};

/// Computes rows [first_row, first_row + count). Blocks are independent of each other: call from several threads at
/// will.
void read_rows(const Robot& robot, const PreparedLog& log, Eigen::Index first_row, Eigen::Index count, RowBlock& block);

/// The same rows of the same motion under two low passes, with one evaluation of the regressor.
/// \param other  differs from `log` in the low pass alone
void read_rows(const Robot& robot, const PreparedLog& log, const PreparedLog& other, Eigen::Index first_row,
               Eigen::Index count, RowBlock& block, RowBlock& other_block);

/// Sample of a row in the log.
[[nodiscard]] inline Eigen::Index sample_of_row(const PreparedLog& log, Eigen::Index row) {
  return log.first + row * log.stride;
}

}  // namespace deltadyn
