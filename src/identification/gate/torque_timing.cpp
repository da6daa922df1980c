#include "torque_timing.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>

#include "deltadyn/identification/least_squares.hpp"
#include "deltadyn/signal/torque_timing_mend.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;

constexpr double kScanStep_s = 0.002;  // fine enough for Gauss-Newton to start in the right valley
constexpr double kLongestDelay_s = 0.04;
constexpr double kLongestLag_s = 0.02;
constexpr double kFarthest_s = 0.048;   // the rows leave this margin to the ends of their stretch
constexpr double kCalm = 3.0;           // times the Gaussian of the sample: instruments see the motion, not the encoders' noise
constexpr int kParts = 10;              // of the rows for the jackknife
constexpr double kSigmas = 4.5;         // a delay within this many of its standard deviations is chance
constexpr double kWorth = 25.0;         // fall of chi^2 that pays for a further parameter: five standard deviations
constexpr double kShare = 0.01;         // of the residual's mean square: a delay that explains less is no matter to the fit
constexpr double kShareOfSplit = 0.03;  // the same for delays that differ between drives or logs
constexpr double kFails = 3.0;          // standard deviations
constexpr double kMostOfDelay = 1e-6;   // s; Gauss-Newton ends below this step

/// Which delays and lags are free, and which are tied together.
struct Freedom {
  std::vector<int> delay, lag;  ///< free parameter of each (log, drive), log * drives + drive; -1: held at 0
  int parameters = 0;
};

/// `group` numbers the (log, drive) pairs.
Freedom freedom(int logs, int drives, bool delay, bool lag, const std::function<int(int, int)>& group) {
  Freedom out;
  int groups = 0;
  for (int l = 0; l < logs; ++l) {
    for (int j = 0; j < drives; ++j) groups = std::max(groups, group(l, j) + 1);
  }
  for (int l = 0; l < logs; ++l) {
    for (int j = 0; j < drives; ++j) {
      out.delay.push_back(delay ? group(l, j) : -1);
      out.lag.push_back(lag ? (delay ? groups : 0) + group(l, j) : -1);
    }
  }
  out.parameters = groups * (static_cast<int>(delay) + static_cast<int>(lag));
  return out;
}

struct Solution {
  Freedom free;
  Eigen::VectorXd theta, std;
  double chi2 = 0;       ///< in units of the noise, memory of the noise allowed for
  double explained = 0;  ///< about what the timing takes off chi2
  bool converged = true;
};

/// The stacked rows of all drives, their torque as a function of the timing, and everything that needs both.
class TimingProblem {
 public:
  TimingProblem(const Sample& sample, const Rows& rows, int logs)
      : sample_(sample), rows_(rows), logs_(logs), drives_(static_cast<int>(rows.drives.size())) {
    for (const DriveRows& drive : rows.drives) total_ += drive.count();
    for (int j = 0; j < drives_; ++j) {
      std::vector<Eigen::VectorXd> column;
      for (const Stretch& stretch : sample.stretches) column.emplace_back(stretch.tau.col(j));
      recorded_.push_back(std::move(column));
    }
    weight_.setOnes(drives_);
    memory_ = 1.0;
  }

  [[nodiscard]] bool solvable() const {
    return std::all_of(rows_.drives.begin(), rows_.drives.end(), [](const DriveRows& d) { return d.count() >= 20; }) &&
           total_ > 3 * (rows_.drives.front().Y.cols() + drives_);
  }

  /// Weights by the torque first, then by what a common delay leaves; the delay that the fit begins with.
  double prepare() {
    const std::vector<double> none(static_cast<std::size_t>(logs_), 0.0);
    for (int j = 0; j < drives_; ++j) {
      const Eigen::VectorXd tau = values_at(sample_, recorded_[static_cast<std::size_t>(j)], places(j), none, 0, sample_.sigma_s);
      weight_(j) = std::sqrt(static_cast<double>(tau.size()) / std::max(tau.squaredNorm(), 1e-300));
    }
    make_basis();
    double delay = scan();
    reweigh(delay);
    delay = scan();
    reweigh(delay);
    return delay;
  }

  /// Residual of the base parameters, each drive over its torque, rms over the drives.
  [[nodiscard]] double relative_rms(const Eigen::MatrixXd& delay, const Eigen::MatrixXd& lag) const {
    Eigen::VectorXd r, unused;
    Eigen::MatrixXd slopes;
    const Eigen::VectorXd tau = torque(delay, lag, slopes, false);
    r = tau - basis_ * (basis_.transpose() * tau);
    double sum = 0;
    Index row = 0;
    for (int j = 0; j < drives_; ++j) {
      const Index count = places_count(j);
      sum += r.segment(row, count).squaredNorm() / std::max(tau.segment(row, count).squaredNorm(), 1e-300);
      row += count;
    }
    return std::sqrt(sum / drives_);
  }

  [[nodiscard]] Solution solve(const Freedom& free, const Eigen::VectorXd& start) const {
    Solution out;
    out.free = free;
    out.theta = start;
    Eigen::MatrixXd J, Z;
    Eigen::VectorXd r;
    for (int pass = 0; pass < 30; ++pass) {
      linearise(free, out.theta, r, J, Z);
      if (free.parameters == 0) break;
      const Eigen::VectorXd step = (Z.transpose() * J).colPivHouseholderQr().solve(-Z.transpose() * r);
      // Half a scan step at most: the torque is only locally linear in its delay.
      const double size = step.cwiseAbs().maxCoeff();
      out.theta += step * std::min(1.0, 2 * kScanStep_s / std::max(size, 1e-300));
      out.converged = size < kMostOfDelay;
      if (out.converged) break;
    }
    linearise(free, out.theta, r, J, Z);
    out.chi2 = r.squaredNorm() / memory_;
    out.explained = free.parameters > 0 ? (Z * out.theta).squaredNorm() / memory_ : 0.0;
    return out;
  }

  /// Fills in Solution::std.
  void add_deviations(Solution& s) const {
    if (s.free.parameters == 0 || s.std.size() > 0) return;
    Eigen::VectorXd r;
    Eigen::MatrixXd J, Z;
    linearise(s.free, s.theta, r, J, Z);
    s.std = deviations(r, J, Z);
  }

  /// Noise that a solution leaves, memory allowed for, in units of Solution::chi2: what a worse timing leaves is no noise.
  [[nodiscard]] double noise_unit(const Solution& s) const {
    Eigen::VectorXd r;
    Eigen::MatrixXd J, Z;
    linearise(s.free, s.theta, r, J, Z);
    const double variance = r.squaredNorm() / static_cast<double>(std::max<Index>(1, total_ - basis_.cols()));
    return variance * std::max(1.0, memory_of(r)) / memory_;
  }

  /// What a timing leaves of the torque's second derivative, with its standard deviation [s^2]: 0 if the timing is of the right kind.
  /// A delay c and a lag c are alike to first order; in the second one they differ by c^2 / 2.
  [[nodiscard]] std::pair<double, double> curvature(const Eigen::MatrixXd& delay, const Eigen::MatrixXd& lag) const {
    Eigen::MatrixXd slopes, all(total_, 5);
    const Eigen::VectorXd tau = torque(delay, lag, slopes, false);
    all.col(0) = tau;
    all.middleCols(1, 2) = model_slopes(tau, Eigen::MatrixXd::Zero(logs_, drives_), 1.0);
    all.rightCols(2) = model_slopes(tau, Eigen::MatrixXd::Zero(logs_, drives_), kCalm);
    project_out(all);
    const Eigen::VectorXd r = all.col(0);
    const Eigen::MatrixXd J = all.middleCols(1, 2), Z = all.rightCols(2);
    const Eigen::VectorXd step = (Z.transpose() * J).partialPivLu().solve(Z.transpose() * r);
    return {step(1), deviations(r - J * step, J, Z)(1)};
  }

  void expand(const Solution& s, Eigen::MatrixXd& delay, Eigen::MatrixXd& lag) const {
    delay.setZero(logs_, drives_);
    lag.setZero(logs_, drives_);
    spread(s.free, s.theta, delay, lag);
  }
  void expand_std(const Solution& s, Eigen::MatrixXd& delay, Eigen::MatrixXd& lag) const {
    delay.setZero(logs_, drives_);
    lag.setZero(logs_, drives_);
    spread(s.free, s.std, delay, lag);
  }
  [[nodiscard]] int logs() const { return logs_; }
  [[nodiscard]] int drives() const { return drives_; }

 private:
  [[nodiscard]] const std::vector<Place>& places(int drive) const { return rows_.drives[static_cast<std::size_t>(drive)].at; }
  [[nodiscard]] Index places_count(int drive) const { return rows_.drives[static_cast<std::size_t>(drive)].count(); }

  void spread(const Freedom& free, const Eigen::VectorXd& theta, Eigen::MatrixXd& delay, Eigen::MatrixXd& lag) const {
    for (int l = 0; l < logs_; ++l) {
      for (int j = 0; j < drives_; ++j) {
        const auto at = static_cast<std::size_t>(l * drives_ + j);
        if (free.delay[at] >= 0) delay(l, j) = theta(free.delay[at]);
        if (free.lag[at] >= 0) lag(l, j) = theta(free.lag[at]);
      }
    }
  }

  /// Orthonormal basis of what base parameters and an offset of each drive can explain.
  void make_basis() {
    const Index B = rows_.drives.front().Y.cols();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(total_, B + drives_);
    Index row = 0;
    for (int j = 0; j < drives_; ++j) {
      const Index count = places_count(j);
      A.block(row, 0, count, B) = weight_(j) * rows_.drives[static_cast<std::size_t>(j)].Y;
      A.block(row, B + j, count, 1).setConstant(weight_(j));
      row += count;
    }
    const Eigen::VectorXd norm = A.colwise().norm().cwiseMax(1e-300).transpose();
    A *= norm.cwiseInverse().asDiagonal();
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
    qr.setThreshold(1e-9);
    basis_ = qr.householderQ() * Eigen::MatrixXd::Identity(total_, qr.rank());
    qr_ = std::move(qr);
    column_norm_ = norm;
  }

  /// First and second time derivative of the torque that the base parameters give, behind a low pass of |lag| and a calmer Gaussian:
  /// instruments free of noise, which would pull a lag towards whatever smooths the record.
  /// \param tau   that the base parameters are fitted to, weighted
  /// \param calm  width of the Gaussian over that of the sample
  [[nodiscard]] Eigen::MatrixXd model_slopes(const Eigen::VectorXd& tau, const Eigen::MatrixXd& lag, double calm) const {
    const Index B = rows_.drives.front().Y.cols();
    const Eigen::VectorXd beta = (qr_.solve(tau).array() / column_norm_.array()).head(B);
    const std::vector<double> none(static_cast<std::size_t>(logs_), 0.0);
    Eigen::MatrixXd out(total_, 2);
    Index row = 0;
    for (int j = 0; j < drives_; ++j) {
      std::vector<Eigen::VectorXd> model;
      for (const auto& Y : rows_.Y_of_points) model.emplace_back(Y[static_cast<std::size_t>(j)] * beta);
      model = behind_low_pass(model, -lag.col(j).cwiseAbs());
      const Index count = places_count(j);
      out.middleRows(row, count) =
          weight_(j) * values_at(sample_, model, places(j), none, 2, calm * sample_.sigma_s).rightCols(2);
      row += count;
    }
    return out;
  }

  /// Weighted torque with delay and lag taken out; columns of `slopes`: by delay and by lag.
  Eigen::VectorXd torque(const Eigen::MatrixXd& delay, const Eigen::MatrixXd& lag, Eigen::MatrixXd& slopes,
                         bool with_slopes) const {
    Eigen::VectorXd tau(total_);
    if (with_slopes) slopes.resize(total_, 2);
    Index row = 0;
    for (int j = 0; j < drives_; ++j) {
      const Index count = places_count(j);
      std::vector<double> shift(static_cast<std::size_t>(logs_));
      for (int l = 0; l < logs_; ++l) shift[static_cast<std::size_t>(l)] = std::clamp(delay(l, j), -kFarthest_s, kFarthest_s);
      const std::vector<Eigen::VectorXd>& recorded = recorded_[static_cast<std::size_t>(j)];
      const bool lead = (lag.col(j).array() < 0).any();
      const Eigen::MatrixXd t = weight_(j) * values_at(sample_, recorded, places(j), shift, with_slopes ? 2 : 1, sample_.sigma_s);
      Eigen::MatrixXd once, twice;
      if (lead) {
        const std::vector<Eigen::VectorXd> y = behind_low_pass(recorded, lag.col(j));
        once = weight_(j) * values_at(sample_, y, places(j), shift, 1, sample_.sigma_s);
        if (with_slopes)
          twice = weight_(j) * values_at(sample_, behind_low_pass(y, lag.col(j)), places(j), shift, 1, sample_.sigma_s);
      }
      for (Index k = 0; k < count; ++k) {
        const int log = sample_.stretches[static_cast<std::size_t>(places(j)[static_cast<std::size_t>(k)].stretch)].file;
        const double T = lag(log, j);
        tau(row + k) = T < 0 ? once(k, 0) : t(k, 0) + T * t(k, 1);
        if (!with_slopes) continue;
        slopes(row + k, 0) = T < 0 ? once(k, 1) : t(k, 1) + T * t(k, 2);
        slopes(row + k, 1) = T < 0 ? twice(k, 1) : t(k, 1);
      }
      row += count;
    }
    return tau;
  }

  /// Columns behind a first-order low pass with the time constant -lag of their log; as they are where the lag is not negative.
  [[nodiscard]] std::vector<Eigen::VectorXd> behind_low_pass(const std::vector<Eigen::VectorXd>& columns,
                                                             const Eigen::VectorXd& lag_of_log) const {
    std::vector<Eigen::VectorXd> out;
    for (std::size_t s = 0; s < columns.size(); ++s) {
      const Stretch& stretch = sample_.stretches[s];
      const double T = -lag_of_log(stretch.file);
      out.push_back(T > 0 ? first_order_low_pass(columns[s], stretch.step_s, T) : columns[s]);
    }
    return out;
  }

  void project_out(Eigen::MatrixXd& columns) const { columns -= basis_ * (basis_.transpose() * columns); }

  /// Residual r(theta), its slopes J and instruments Z for them, base parameters eliminated.
  void linearise(const Freedom& free, const Eigen::VectorXd& theta, Eigen::VectorXd& r, Eigen::MatrixXd& J,
                 Eigen::MatrixXd& Z) const {
    Eigen::MatrixXd delay = Eigen::MatrixXd::Zero(logs_, drives_), lag = delay, slopes;
    spread(free, theta, delay, lag);
    const int G = free.parameters;
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(total_, 1 + 2 * G);
    const Eigen::VectorXd tau = torque(delay, lag, slopes, true);
    all.col(0) = tau;
    // The noise of a recorded torque is orthogonal to its own derivative: a delay alone needs no instrument.
    const bool lags = std::any_of(free.lag.begin(), free.lag.end(), [](int k) { return k >= 0; });
    const Eigen::VectorXd model = lags ? Eigen::VectorXd(model_slopes(tau, lag, kCalm).col(0)) : Eigen::VectorXd(slopes.col(0));
    Index row = 0;
    for (int j = 0; j < drives_; ++j) {
      for (const Place& place : places(j)) {
        const int log = sample_.stretches[static_cast<std::size_t>(place.stretch)].file;
        const auto at = static_cast<std::size_t>(log * drives_ + j);
        for (const auto& [parameter, kind] : {std::pair(free.delay[at], 0), std::pair(free.lag[at], 1)}) {
          if (parameter < 0) continue;
          all(row, 1 + parameter) = slopes(row, kind);
          all(row, 1 + G + parameter) = model(row);
        }
        ++row;
      }
    }
    project_out(all);
    r = all.col(0);
    J = all.middleCols(1, G);
    Z = all.rightCols(G);
  }

  double scan() const {
    const auto steps = static_cast<int>(std::lround(2 * kLongestDelay_s / kScanStep_s));
    Eigen::MatrixXd tau(total_, steps + 1), slopes;
    const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(logs_, drives_);
    for (int k = 0; k <= steps; ++k) {
      const double delay = -kLongestDelay_s + k * kScanStep_s;
      tau.col(k) = torque(Eigen::MatrixXd::Constant(logs_, drives_, delay), none, slopes, false);
    }
    project_out(tau);
    Index best = 0;
    tau.colwise().squaredNorm().minCoeff(&best);
    return -kLongestDelay_s + static_cast<double>(best) * kScanStep_s;
  }

  /// Memory of a residual, mean over the drives.
  [[nodiscard]] double memory_of(const Eigen::VectorXd& r) const {
    double memory = 0;
    Index row = 0;
    for (int j = 0; j < drives_; ++j) {
      const Index count = places_count(j);
      const Eigen::Array<bool, Eigen::Dynamic, 1> all = Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(count, true);
      memory += noise_correlation(r.segment(row, count), all, 20) / drives_;
      row += count;
    }
    return memory;
  }

  /// Weights by the residual at a common delay, and the memory of that residual.
  void reweigh(double delay) {
    Eigen::MatrixXd slopes;
    const Eigen::MatrixXd lag = Eigen::MatrixXd::Zero(logs_, drives_);
    Eigen::MatrixXd r = torque(Eigen::MatrixXd::Constant(logs_, drives_, delay), lag, slopes, false);
    const Eigen::VectorXd tau = r;
    project_out(r);
    Index row = 0;
    memory_ = std::max(1.0, memory_of(r.col(0)));
    Eigen::VectorXd weight = weight_;
    for (int j = 0; j < drives_; ++j) {
      const Index count = places_count(j);
      const Eigen::VectorXd one = r.col(0).segment(row, count);
      // Noise-free logs: the filters' own error stays.
      const double floor = 1e-6 * tau.segment(row, count).norm();
      weight(j) *= std::sqrt(static_cast<double>(count)) / std::max({one.norm(), floor, 1e-300});
      row += count;
    }
    weight_ = weight;
    make_basis();
  }

  /// Of the step (Z^T J)^-1 Z^T r: the larger one of the deviation by the noise and that by a jackknife over parts of the rows. What
  /// the model lacks is no white noise, but it differs from part to part.
  [[nodiscard]] Eigen::VectorXd deviations(const Eigen::VectorXd& r, const Eigen::MatrixXd& J, const Eigen::MatrixXd& Z) const {
    const double variance = r.squaredNorm() / static_cast<double>(std::max<Index>(1, total_ - basis_.cols()));
    const Eigen::MatrixXd inverse = (Z.transpose() * J).completeOrthogonalDecomposition().pseudoInverse();
    const Eigen::MatrixXd covariance =
        inverse * (Z.transpose() * Z) * inverse.transpose() * (std::max(variance, 1e-30) * memory_);
    const Index Q = basis_.cols(), G = J.cols();
    // [basis Z]^T [basis J r] by part; leaving one out and solving again is cheap.
    std::vector<Eigen::MatrixXd> part(kParts, Eigen::MatrixXd::Zero(Q + G, Q + G + 1));
    Eigen::MatrixXd total = Eigen::MatrixXd::Zero(Q + G, Q + G + 1);
    Index row = 0;
    for (int j = 0; j < drives_; ++j) {
      const Index count = places_count(j);
      for (int p = 0; p < kParts; ++p) {
        const Index from = count * p / kParts, rows = count * (p + 1) / kParts - from;
        Eigen::MatrixXd left(rows, Q + G), right(rows, Q + G + 1);
        left << basis_.middleRows(row + from, rows), Z.middleRows(row + from, rows);
        right << basis_.middleRows(row + from, rows), J.middleRows(row + from, rows), r.segment(row + from, rows);
        part[static_cast<std::size_t>(p)].noalias() += left.transpose() * right;
      }
      row += count;
    }
    for (const Eigen::MatrixXd& one : part) total += one;
    Eigen::MatrixXd shifts(G, kParts);
    for (int p = 0; p < kParts; ++p) {
      const Eigen::MatrixXd rest = total - part[static_cast<std::size_t>(p)];
      const Eigen::MatrixXd H = rest.leftCols(Q + G);
      const Eigen::VectorXd solution = H.partialPivLu().solve(rest.col(Q + G));
      shifts.col(p) = -solution.tail(G);
    }
    const Eigen::VectorXd mean = shifts.rowwise().mean();
    const Eigen::VectorXd jackknife =
        ((shifts.colwise() - mean).rowwise().squaredNorm() * (static_cast<double>(kParts - 1) / kParts)).cwiseSqrt();
    return covariance.diagonal().cwiseMax(0.0).cwiseSqrt().cwiseMax(jackknife);
  }

  const Sample& sample_;
  const Rows& rows_;
  int logs_, drives_;
  Index total_ = 0;
  Eigen::VectorXd weight_;
  double memory_ = 1;
  Eigen::MatrixXd basis_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_;
  Eigen::VectorXd column_norm_;
  std::vector<std::vector<Eigen::VectorXd>> recorded_;  ///< torque of each drive in each stretch
};

/// Are values that a model tells apart really different, beyond chance and beyond what matters?
bool differ(const Eigen::VectorXd& value, const Eigen::VectorXd& std, double least) {
  const Eigen::VectorXd w = std.cwiseMax(1e-9).array().square().inverse();
  const double mean = w.dot(value) / w.sum();
  const double spread = (value.array() - mean).square().matrix().dot(w);
  return spread > kWorth + static_cast<double>(value.size()) && (value.array() - mean).abs().maxCoeff() > least;
}

bool stands_out(const Solution& s, double least) {
  return ((s.theta.cwiseAbs().array() > kSigmas * s.std.array()) && (s.theta.cwiseAbs().array() > least)).any();
}

/// Sizes of free delays or lags, common or split.
Solution fit(const TimingProblem& problem, bool delay, const std::function<int(int, int)>& group, double start) {
  const Freedom f = freedom(problem.logs(), problem.drives(), delay, !delay, group);
  return problem.solve(f, Eigen::VectorXd::Constant(f.parameters, start));
}

std::pair<double, double> curvature_of(const TimingProblem& problem, const Solution& s) {
  Eigen::MatrixXd delay, lag;
  problem.expand(s, delay, lag);
  return problem.curvature(delay, lag);
}

/// Does the delay differ from drive to drive, or from log to log? Then that solution, else `common`.
Solution split_if_different(const TimingProblem& problem, const Solution& common, bool delay, double least) {
  std::vector<std::function<int(int, int)>> finer = {[](int, int j) { return j; }};
  if (problem.logs() > 1) finer.emplace_back([](int l, int) { return l; });
  Solution best = common;
  for (const auto& group : finer) {
    Solution split = fit(problem, delay, group, common.theta(0));
    const double gain = common.chi2 - split.chi2;
    if (!split.converged || split.chi2 > best.chi2 || gain < kShareOfSplit * common.chi2) continue;
    if (gain < kWorth * std::min(1.0, problem.noise_unit(split))) continue;
    problem.add_deviations(split);
    if (differ(split.theta, split.std, least)) best = split;
  }
  return best;
}

/// A delay and a lag of all drives in series, for a record that neither of them explains alone. The sum of both is known from the
/// first derivative of the torque, their difference from the second.
Solution both_at_once(const TimingProblem& problem, const Solution& delay, double curvature) {
  const double T = (curvature < 0 ? -1 : 1) * std::sqrt(2 * std::abs(curvature));
  Solution best = problem.solve(freedom(problem.logs(), problem.drives(), true, true, [](int, int) { return 0; }),
                                (Eigen::VectorXd(2) << delay.theta(0) - T, T).finished());
  problem.add_deviations(best);
  return best;
}

/// The simplest timing that explains the torque about as well as any other.
Solution choose(const TimingProblem& problem, double start, double least) {
  const auto same = [](int, int) { return 0; };
  const Solution none = problem.solve(freedom(problem.logs(), problem.drives(), false, false, same), Eigen::VectorXd());
  const Solution delay = fit(problem, true, same, start);
  const Solution lag = fit(problem, false, same, std::clamp(delay.theta(0), -kLongestLag_s, kLongestLag_s));
  const auto [bend_delay, std_delay] = curvature_of(problem, delay);
  const auto [bend_lag, std_lag] = curvature_of(problem, lag);
  const double off_delay = std::abs(bend_delay) / std_delay, off_lag = std::abs(bend_lag) / std_lag;
  // A delay is the simpler one: it must clearly fail before a lag takes its place.
  const bool is_delay = !lag.converged || off_delay <= std::max(off_lag, kFails);
  Solution best = split_if_different(problem, is_delay ? delay : lag, is_delay, least);
  if (best.free.parameters == 1 && std::min(off_delay, off_lag) > kSigmas) {
    const Solution both = both_at_once(problem, delay, bend_delay);
    if (both.converged && (both.theta.cwiseAbs().array() > kSigmas * both.std.array()).all() &&
        both.theta.cwiseAbs().minCoeff() > least) {
      best = both;
    }
  }
  problem.add_deviations(best);
  if (best.converged && stands_out(best, least) && best.explained > std::max(kWorth, kShare * none.chi2)) return best;
  // What was looked for and not found still has an uncertainty.
  Solution nothing = none;
  nothing.std = best.std;
  return nothing;
}

}  // namespace

Timing estimate_timing(const Sample& sample, const Rows& rows, const std::vector<double>& least_s) {
  Timing out;
  TimingProblem problem(sample, rows, static_cast<int>(least_s.size()));
  const auto logs = static_cast<Index>(least_s.size());
  const auto drives = static_cast<Index>(rows.drives.size());
  for (Eigen::MatrixXd* m : {&out.delay_s, &out.lag_s, &out.delay_std, &out.lag_std}) m->setZero(logs, drives);
  if (!problem.solvable()) return out;
  const double start = problem.prepare();
  const double least = *std::max_element(least_s.begin(), least_s.end());
  const Solution best = choose(problem, start, least);
  out.rms_before = problem.relative_rms(out.delay_s, out.lag_s);
  if (best.free.parameters == 0) {
    out.delay_std.setConstant(best.std.size() > 0 ? best.std(0) : 0.0);
    out.rms_after = out.rms_before;
    return out;
  }
  problem.expand(best, out.delay_s, out.lag_s);
  problem.expand_std(best, out.delay_std, out.lag_std);
  out.significant = true;
  // Drives whose own share is within chance, or too small to matter, keep their torque as it is.
  for (Index l = 0; l < logs; ++l) {
    for (Index j = 0; j < drives; ++j) {
      const double floor = least_s[static_cast<std::size_t>(l)];
      if (std::abs(out.delay_s(l, j)) < std::max(kSigmas * out.delay_std(l, j), floor)) out.delay_s(l, j) = 0;
      if (std::abs(out.lag_s(l, j)) < std::max(kSigmas * out.lag_std(l, j), floor)) out.lag_s(l, j) = 0;
    }
  }
  out.significant = out.delay_s.cwiseAbs().maxCoeff() > 0 || out.lag_s.cwiseAbs().maxCoeff() > 0;
  out.rms_after = problem.relative_rms(out.delay_s, out.lag_s);
  return out;
}

LogDelays delays_of_logs(const Sample& sample, const Rows& rows, int logs) {
  LogDelays out;
  TimingProblem problem(sample, rows, logs);
  if (!problem.solvable()) return out;
  const double start = problem.prepare();
  const Solution common = fit(
      problem, true, [](int, int) { return 0; }, start);
  Solution own = fit(
      problem, true, [](int l, int) { return l; }, common.theta(0));
  if (!own.converged) return out;
  Eigen::MatrixXd delay, lag;
  problem.expand(common, delay, lag);
  out.rms_before = problem.relative_rms(delay, lag);
  problem.expand(own, delay, lag);
  out.rms_after = problem.relative_rms(delay, lag);
  out.delay_s = own.theta;
  return out;
}

}  // namespace deltadyn::gate
