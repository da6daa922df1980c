#include "timing_problem.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/signal/torque_timing_mend.hpp"

#include "../least_squares.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;

constexpr double kScanStep_s = 0.002;  // fine enough for Gauss-Newton to start in the right valley
constexpr double kLongestDelay_s = 0.04;
constexpr double kFarthest_s = 0.048;  // the rows leave this margin to the ends of their stretch
// Times the Gaussian of the sample: instruments see the motion, not the encoders' noise
constexpr double kCalm = 3.0;
constexpr int kParts = 10;             // of the rows for the jackknife
constexpr double kMostOfDelay = 1e-6;  // s; Gauss-Newton ends below this step

}  // namespace

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

TimingProblem::TimingProblem(const Sample& sample, const Rows& rows, int logs)
    : sample_(sample), rows_(rows), logs_(logs), drives_(static_cast<int>(rows.drives.size())) {
  for (int j = 0; j < drives_; ++j) {
    first_.push_back(total_);
    total_ += rows.drives[static_cast<std::size_t>(j)].count();
    recorded_.push_back(recorded_torque(sample, j));
  }
  weight_.setOnes(drives_);
}

bool TimingProblem::solvable() const {
  return std::all_of(rows_.drives.begin(), rows_.drives.end(), [](const DriveRows& d) { return d.count() >= 20; }) &&
         total_ > 3 * (rows_.drives.front().Y.cols() + drives_);
}

double TimingProblem::prepare() {
  for (int j = 0; j < drives_; ++j) {
    const Eigen::VectorXd tau =
        values_at(sample_, recorded_[static_cast<std::size_t>(j)], places(j), {}, 0, sample_.sigma_s);
    weight_(j) = std::sqrt(static_cast<double>(tau.size()) / std::max(tau.squaredNorm(), 1e-300));
  }
  make_basis();
  double delay = scan();
  reweigh(delay);
  delay = scan();
  reweigh(delay);
  return delay;
}

double TimingProblem::relative_rms(const Shifts& shifts) const {
  const Eigen::VectorXd tau = torque(shifts), r = tau - basis_ * (basis_.transpose() * tau);
  double sum = 0;
  for (int j = 0; j < drives_; ++j) {
    const auto [row, count] = stacked(j);
    sum += r.segment(row, count).squaredNorm() / std::max(tau.segment(row, count).squaredNorm(), 1e-300);
  }
  return std::sqrt(sum / drives_);
}

Solution TimingProblem::solve(const Freedom& free, const Eigen::VectorXd& start) const {
  Solution out;
  out.free = free;
  out.theta = start;
  Eigen::MatrixXd J, Z;
  Eigen::VectorXd r;
  for (int pass = 0; pass < 30; ++pass) {
    linearise(free, out.theta, r, J, Z);
    if (free.parameters == 0) break;
    const Eigen::VectorXd step = dense::solve_square(Z.transpose() * J, Eigen::VectorXd(-Z.transpose() * r));
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

void TimingProblem::add_deviations(Solution& s) const {
  if (s.free.parameters == 0 || s.std.size() > 0) return;
  Eigen::VectorXd r;
  Eigen::MatrixXd J, Z;
  linearise(s.free, s.theta, r, J, Z);
  s.std = deviations(r, J, Z);
}

double TimingProblem::noise_unit(const Solution& s) const {
  Eigen::VectorXd r;
  Eigen::MatrixXd J, Z;
  linearise(s.free, s.theta, r, J, Z);
  const double variance = r.squaredNorm() / static_cast<double>(std::max<Index>(1, total_ - basis_.cols()));
  return variance * std::max(1.0, memory_of(r)) / memory_;
}

std::pair<double, double> TimingProblem::curvature(const Shifts& shifts) const {
  Eigen::MatrixXd all(total_, 5);
  const Eigen::VectorXd tau = torque(shifts);
  const Eigen::MatrixXd no_lag = Eigen::MatrixXd::Zero(logs_, drives_);
  all << tau, model_slopes(tau, no_lag, 1.0), model_slopes(tau, no_lag, kCalm);
  project_out(all);
  const Eigen::VectorXd r = all.col(0);
  const Eigen::MatrixXd J = all.middleCols(1, 2), Z = all.rightCols(2);
  const Eigen::VectorXd step = dense::solve_square(Z.transpose() * J, Eigen::VectorXd(Z.transpose() * r));
  return {step(1), deviations(r - J * step, J, Z)(1)};
}

Shifts TimingProblem::all_alike(double delay) const {
  return {Eigen::MatrixXd::Constant(logs_, drives_, delay), Eigen::MatrixXd::Zero(logs_, drives_)};
}

Shifts TimingProblem::expand(const Freedom& free, const Eigen::VectorXd& values) const {
  Shifts out = all_alike(0);
  for (int l = 0; l < logs_; ++l) {
    for (int j = 0; j < drives_; ++j) {
      const auto at = static_cast<std::size_t>(l * drives_ + j);
      if (free.delay[at] >= 0) out.delay(l, j) = values(free.delay[at]);
      if (free.lag[at] >= 0) out.lag(l, j) = values(free.lag[at]);
    }
  }
  return out;
}

void TimingProblem::make_basis() {
  const Index B = rows_.drives.front().Y.cols();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(total_, B + drives_);
  for (int j = 0; j < drives_; ++j) {
    const auto [row, count] = stacked(j);
    A.block(row, 0, count, B) = weight_(j) * rows_.drives[static_cast<std::size_t>(j)].Y;
    A.block(row, B + j, count, 1).setConstant(weight_(j));
  }
  const Eigen::VectorXd norm = A.colwise().norm().cwiseMax(1e-300).transpose();
  A *= norm.cwiseInverse().asDiagonal();
  qr_ = dense::PivotedQr(A, 1e-9);
  basis_ = qr_.basis();
  column_norm_ = norm;
}

Eigen::MatrixXd TimingProblem::model_slopes(const Eigen::VectorXd& tau, const Eigen::MatrixXd& lag, double calm) const {
  const Index B = rows_.drives.front().Y.cols();
  const Eigen::VectorXd beta = (qr_.solve(tau).array() / column_norm_.array()).head(B);
  Eigen::MatrixXd out(total_, 2);
  for (int j = 0; j < drives_; ++j) {
    std::vector<Eigen::VectorXd> model;
    for (const auto& Y : rows_.Y_of_points) model.emplace_back(Y[static_cast<std::size_t>(j)] * beta);
    model = behind_low_pass(model, -lag.col(j).cwiseAbs());
    const auto [row, count] = stacked(j);
    out.middleRows(row, count) =
        weight_(j) * values_at(sample_, model, places(j), {}, 2, calm * sample_.sigma_s).rightCols(2);
  }
  return out;
}

Eigen::VectorXd TimingProblem::torque(const Shifts& shifts, Eigen::MatrixXd* slopes) const {
  Eigen::VectorXd tau(total_);
  const bool with_slopes = slopes != nullptr;
  if (with_slopes) slopes->resize(total_, 2);
  for (int j = 0; j < drives_; ++j) {
    const auto [row, count] = stacked(j);
    const auto lag = shifts.lag.col(j);
    std::vector<double> shift;
    for (const double delay : shifts.delay.col(j)) shift.push_back(std::clamp(delay, -kFarthest_s, kFarthest_s));
    const std::vector<Eigen::VectorXd>& recorded = recorded_[static_cast<std::size_t>(j)];
    const bool lead = (lag.array() < 0).any();
    const Eigen::MatrixXd t =
        weight_(j) * values_at(sample_, recorded, places(j), shift, with_slopes ? 2 : 1, sample_.sigma_s);
    Eigen::MatrixXd once, twice;
    if (lead) {
      const std::vector<Eigen::VectorXd> y = behind_low_pass(recorded, lag);
      once = weight_(j) * values_at(sample_, y, places(j), shift, 1, sample_.sigma_s);
      if (with_slopes)
        twice = weight_(j) * values_at(sample_, behind_low_pass(y, lag), places(j), shift, 1, sample_.sigma_s);
    }
    for (Index k = 0; k < count; ++k) {
      const int log = sample_.stretches[static_cast<std::size_t>(places(j)[static_cast<std::size_t>(k)].stretch)].file;
      const double T = lag(log);
      tau(row + k) = T < 0 ? once(k, 0) : t(k, 0) + T * t(k, 1);
      if (!with_slopes) continue;
      (*slopes)(row + k, 0) = T < 0 ? once(k, 1) : t(k, 1) + T * t(k, 2);
      (*slopes)(row + k, 1) = T < 0 ? twice(k, 1) : t(k, 1);
    }
  }
  return tau;
}

std::vector<Eigen::VectorXd> TimingProblem::behind_low_pass(const std::vector<Eigen::VectorXd>& columns,
                                                            const Eigen::VectorXd& lag_of_log) const {
  std::vector<Eigen::VectorXd> out;
  for (std::size_t s = 0; s < columns.size(); ++s) {
    const Stretch& stretch = sample_.stretches[s];
    const double T = -lag_of_log(stretch.file);
    out.push_back(T > 0 ? first_order_low_pass(columns[s], stretch.step_s, T) : columns[s]);
  }
  return out;
}

void TimingProblem::linearise(const Freedom& free, const Eigen::VectorXd& theta, Eigen::VectorXd& r, Eigen::MatrixXd& J,
                              Eigen::MatrixXd& Z) const {
  const Shifts shifts = expand(free, theta);
  Eigen::MatrixXd slopes;
  const int G = free.parameters;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(total_, 1 + 2 * G);
  const Eigen::VectorXd tau = torque(shifts, &slopes);
  all.col(0) = tau;
  // The noise of a recorded torque is orthogonal to its own derivative: a delay alone needs no instrument.
  const bool lags = std::any_of(free.lag.begin(), free.lag.end(), [](int k) { return k >= 0; });
  const Eigen::VectorXd model =
      lags ? Eigen::VectorXd(model_slopes(tau, shifts.lag, kCalm).col(0)) : Eigen::VectorXd(slopes.col(0));
  for (int j = 0; j < drives_; ++j) {
    Index row = stacked(j).first;
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

double TimingProblem::scan() const {
  const auto steps = static_cast<int>(std::lround(2 * kLongestDelay_s / kScanStep_s));
  Eigen::MatrixXd tau(total_, steps + 1);
  for (int k = 0; k <= steps; ++k) tau.col(k) = torque(all_alike(-kLongestDelay_s + k * kScanStep_s));
  project_out(tau);
  Index best = 0;
  tau.colwise().squaredNorm().minCoeff(&best);
  return -kLongestDelay_s + static_cast<double>(best) * kScanStep_s;
}

double TimingProblem::memory_of(const Eigen::VectorXd& r) const {
  double memory = 0;
  for (int j = 0; j < drives_; ++j) {
    const auto [row, count] = stacked(j);
    const Eigen::Array<bool, Eigen::Dynamic, 1> all = Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(count, true);
    memory += noise_correlation(r.segment(row, count), all, 20) / drives_;
  }
  return memory;
}

void TimingProblem::reweigh(double delay) {
  const Eigen::VectorXd tau = torque(all_alike(delay)), r = tau - basis_ * (basis_.transpose() * tau);
  memory_ = std::max(1.0, memory_of(r));
  for (int j = 0; j < drives_; ++j) {
    const auto [row, count] = stacked(j);
    // Noise-free logs: the filters' own error stays.
    const double floor = 1e-6 * tau.segment(row, count).norm();
    weight_(j) *= std::sqrt(static_cast<double>(count)) / std::max({r.segment(row, count).norm(), floor, 1e-300});
  }
  make_basis();
}

Eigen::VectorXd TimingProblem::deviations(const Eigen::VectorXd& r, const Eigen::MatrixXd& J,
                                          const Eigen::MatrixXd& Z) const {
  const double variance = r.squaredNorm() / static_cast<double>(std::max<Index>(1, total_ - basis_.cols()));
  const Eigen::MatrixXd inverse = dense::pseudo_inverse(Z.transpose() * J);
  const Eigen::MatrixXd covariance =
      inverse * (Z.transpose() * Z) * inverse.transpose() * (std::max(variance, 1e-30) * memory_);
  const Index Q = basis_.cols(), G = J.cols();
  // [basis Z]^T [basis J r] by part; leaving one out and solving again is cheap.
  std::vector<Eigen::MatrixXd> part(kParts, Eigen::MatrixXd::Zero(Q + G, Q + G + 1));
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(Q + G, Q + G + 1);
  for (int j = 0; j < drives_; ++j) {
    const auto [row, count] = stacked(j);
    for (int p = 0; p < kParts; ++p) {
      const Index from = count * p / kParts, rows = count * (p + 1) / kParts - from;
      Eigen::MatrixXd left(rows, Q + G), right(rows, Q + G + 1);
      left << basis_.middleRows(row + from, rows), Z.middleRows(row + from, rows);
      right << basis_.middleRows(row + from, rows), J.middleRows(row + from, rows), r.segment(row + from, rows);
      part[static_cast<std::size_t>(p)].noalias() += left.transpose() * right;
    }
  }
  for (const Eigen::MatrixXd& one : part) total += one;
  Eigen::MatrixXd shifts(G, kParts);
  for (int p = 0; p < kParts; ++p) {
    const Eigen::MatrixXd rest = total - part[static_cast<std::size_t>(p)];
    const Eigen::MatrixXd H = rest.leftCols(Q + G);
    const Eigen::VectorXd solution = dense::solve_square(H, Eigen::VectorXd(rest.col(Q + G)));
    shifts.col(p) = -solution.tail(G);
  }
  const Eigen::VectorXd mean = shifts.rowwise().mean();
  const Eigen::VectorXd jackknife =
      ((shifts.colwise() - mean).rowwise().squaredNorm() * (static_cast<double>(kParts - 1) / kParts)).cwiseSqrt();
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt().cwiseMax(jackknife);
}

}  // namespace deltadyn::gate
