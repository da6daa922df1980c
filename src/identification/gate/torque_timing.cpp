#include "torque_timing.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "timing_problem.hpp"

namespace deltadyn::gate {

namespace {

constexpr double kLongestLag_s = 0.02;
constexpr double kSigmas = 4.5;  // a delay within this many of its standard deviations is chance
constexpr double kWorth = 25.0;  // fall of chi^2 that pays for a further parameter: five standard deviations
// Of the residual's mean square: a delay that explains less is no matter to the fit
constexpr double kShare = 0.01;
constexpr double kShareOfSplit = 0.03;  // the same for delays that differ between drives or logs
constexpr double kFails = 3.0;          // standard deviations

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

/// A delay and a lag of all drives in series, for a record that neither of them explains alone. The sum of both is
/// known from the first derivative of the torque, their difference from the second.
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
  const auto [bend_delay, std_delay] = problem.curvature(problem.expand(delay.free, delay.theta));
  const auto [bend_lag, std_lag] = problem.curvature(problem.expand(lag.free, lag.theta));
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
  out.shift = out.std = problem.all_alike(0);
  if (!problem.solvable()) return out;
  const double start = problem.prepare();
  const double least = *std::max_element(least_s.begin(), least_s.end());
  const Solution best = choose(problem, start, least);
  out.rms_before = problem.relative_rms(out.shift);
  if (best.free.parameters == 0) {
    out.std.delay.setConstant(best.std.size() > 0 ? best.std(0) : 0.0);
    out.rms_after = out.rms_before;
    return out;
  }
  out.shift = problem.expand(best.free, best.theta);
  out.std = problem.expand(best.free, best.std);
  // Drives whose own share is within chance, or too small to matter, keep their torque as it is.
  const Eigen::ArrayXXd floor =
      Eigen::Map<const Eigen::ArrayXd>(least_s.data(), std::ssize(least_s)).replicate(1, problem.drives());
  for (const auto& [value, std] : {std::pair(&out.shift.delay, &out.std.delay), {&out.shift.lag, &out.std.lag}}) {
    *value = (value->array().abs() < (kSigmas * std->array()).max(floor)).select(0, *value);
  }
  out.significant = !out.shift.delay.isZero(0) || !out.shift.lag.isZero(0);
  out.rms_after = problem.relative_rms(out.shift);
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
  out.rms_before = problem.relative_rms(problem.expand(common.free, common.theta));
  out.rms_after = problem.relative_rms(problem.expand(own.free, own.theta));
  out.delay_s = own.theta;
  return out;
}

}  // namespace deltadyn::gate
