#pragma once

/// \file
/// The torque of a sample as a function of its delay and lag against the positions, base parameters eliminated.

#include <functional>
#include <utility>
#include <vector>

#include "deltadyn/runtime/dense.hpp"

#include "rows.hpp"
#include "torque_timing.hpp"

namespace deltadyn::gate {

/// Which delays and lags are free, and which are tied together.
struct Freedom {
  std::vector<int> delay, lag;  ///< free parameter of each (log, drive), log * drives + drive; -1: held at 0
  int parameters = 0;
};

/// `group` numbers the (log, drive) pairs.
[[nodiscard]] Freedom freedom(int logs, int drives, bool delay, bool lag, const std::function<int(int, int)>& group);

/// A timing that fits best, with the freedom it had.
struct Solution {
  Freedom free;
  Eigen::VectorXd theta, std;  ///< free delays and lags [s]; `std` is empty until add_deviations()
  double chi2 = 0;             ///< in units of the noise, memory of the noise allowed for
  double explained = 0;        ///< about what the timing takes off chi2
  bool converged = true;
};

/// The stacked rows of all drives, their torque as a function of the timing, and everything that needs both.
class TimingProblem {
 public:
  /// \param rows  of the sample, as low_passed_rows() makes them; both must outlive the problem
  /// \param logs  files, each with a timing of its own
  TimingProblem(const Sample& sample, const Rows& rows, int logs);

  /// Are there rows enough of every drive?
  [[nodiscard]] bool solvable() const;

  /// Weights by the torque first, then by what a common delay leaves; the delay that the fit begins with.
  double prepare();

  /// Residual of the base parameters, each drive over its torque, rms over the drives.
  [[nodiscard]] double relative_rms(const Shifts& shifts) const;

  /// Gauss-Newton from `start`; a lag has instruments, which noise does not pull.
  [[nodiscard]] Solution solve(const Freedom& free, const Eigen::VectorXd& start) const;

  /// Fills in Solution::std.
  void add_deviations(Solution& s) const;

  /// Noise that a solution leaves, memory allowed for, in units of Solution::chi2: what a worse timing leaves is no
  /// noise.
  [[nodiscard]] double noise_unit(const Solution& s) const;

  /// What a timing leaves of the torque's second derivative, with its standard deviation [s^2]: 0 if the timing is of
  /// the right kind. A delay c and a lag c are alike to first order; in the second one they differ by c^2 / 2.
  [[nodiscard]] std::pair<double, double> curvature(const Shifts& shifts) const;

  /// One delay and no lag.
  [[nodiscard]] Shifts all_alike(double delay) const;
  /// Delays and lags, or their standard deviations, of Solution::theta or Solution::std.
  [[nodiscard]] Shifts expand(const Freedom& free, const Eigen::VectorXd& values) const;
  [[nodiscard]] int logs() const { return logs_; }
  [[nodiscard]] int drives() const { return drives_; }

 private:
  [[nodiscard]] const std::vector<Place>& places(int drive) const {
    return rows_.drives[static_cast<std::size_t>(drive)].at;
  }
  /// First of a drive's stacked rows, and their number.
  [[nodiscard]] std::pair<Eigen::Index, Eigen::Index> stacked(int drive) const {
    const auto at = static_cast<std::size_t>(drive);
    return {first_[at], rows_.drives[at].count()};
  }

  /// Orthonormal basis of what base parameters and an offset of each drive can explain.
  void make_basis();

  /// First and second time derivative of the torque that the base parameters give, behind a low pass of |lag| and a
  /// calmer Gaussian: instruments free of noise, which would pull a lag towards whatever smooths the record.
  /// \param tau   that the base parameters are fitted to, weighted
  /// \param calm  width of the Gaussian over that of the sample
  [[nodiscard]] Eigen::MatrixXd model_slopes(const Eigen::VectorXd& tau, const Eigen::MatrixXd& lag, double calm) const;

  /// Weighted torque with delay and lag taken out; columns of `slopes`, if wanted: by delay and by lag.
  [[nodiscard]] Eigen::VectorXd torque(const Shifts& shifts, Eigen::MatrixXd* slopes = nullptr) const;

  /// Columns behind a first-order low pass with the time constant -lag of their log; as they are where the lag is not
  /// negative.
  [[nodiscard]] std::vector<Eigen::VectorXd> behind_low_pass(const std::vector<Eigen::VectorXd>& columns,
                                                             const Eigen::VectorXd& lag_of_log) const;

  void project_out(Eigen::MatrixXd& columns) const { columns -= basis_ * (basis_.transpose() * columns); }

  /// Residual r(theta), its slopes J and instruments Z for them, base parameters eliminated.
  void linearise(const Freedom& free, const Eigen::VectorXd& theta, Eigen::VectorXd& r, Eigen::MatrixXd& J,
                 Eigen::MatrixXd& Z) const;

  /// The delay common to all that leaves least, on a grid [s].
  [[nodiscard]] double scan() const;

  /// Memory of a residual, mean over the drives.
  [[nodiscard]] double memory_of(const Eigen::VectorXd& r) const;

  /// Weights by the residual at a common delay, and the memory of that residual.
  void reweigh(double delay);

  /// Of the step (Z^T J)^-1 Z^T r: the larger one of the deviation by the noise and that by a jackknife over parts of
  /// the rows. What the model lacks is no white noise, but it differs from part to part.
  [[nodiscard]] Eigen::VectorXd deviations(const Eigen::VectorXd& r, const Eigen::MatrixXd& J,
                                           const Eigen::MatrixXd& Z) const;

  const Sample& sample_;
  const Rows& rows_;
  int logs_, drives_;
  std::vector<Eigen::Index> first_;  ///< of each drive's stacked rows
  Eigen::Index total_ = 0;
  Eigen::VectorXd weight_;
  double memory_ = 1;
  Eigen::MatrixXd basis_;
  dense::PivotedQr qr_;
  Eigen::VectorXd column_norm_;
  std::vector<std::vector<Eigen::VectorXd>> recorded_;  ///< torque of each drive in each stretch
};

}  // namespace deltadyn::gate
