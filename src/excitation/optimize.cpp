#include "deltadyn/excitation/optimize.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <mutex>
#include <optional>
#include <random>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/in_parallel.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/trajectory/motion_plan.hpp"

#include "design_problem.hpp"
#include "search.hpp"

namespace deltadyn {

using detail::DesignProblem;
using detail::ProblemSettings;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kFeasibleMargin = 1e-4;  // kept from every limit, so that run-in and finer grids find it kept, too
constexpr int kVerifySamples = 4000;      // of a period
constexpr int kRankSamples = 600;         // of a period, to compare starts
constexpr double kLargestStretch = 1.1;   // the smooth limits of the search lie inside the true ones
constexpr int kSearchEvaluations = 250;   // of a start
// If the time runs out, a part of it is still left for kicks and for polishing.
constexpr double kRandomUntil = 0.6, kKicksUntil = 0.85;
constexpr int kUsualEvaluations = 130;   // that a start takes in the mean
constexpr int kPolishEvaluations = 250;  // of a motion that is polished
constexpr int kPolished = 4;
constexpr double kKickedShare = 0.4;    // of the starts that begin near the best of the others
constexpr double kNominalRate = 14000;  // samples a second and thread that a desktop machine differentiates
// Time for the last check of a segment, in units of that of its first motion
constexpr double kChecksKept = 2.5;
constexpr double kPreparation_s = 2;        // before the starts and after them
constexpr double kShareOfTime = 0.6;        // of the time limit that the starts may plan for
constexpr double kTimeForTwoRounds_s = 10;  // a segment: with less time it is not taken up a second time

constexpr double kAwayRoom = 0.03;  // the smooth share away from reversals differs from the true one by about as much

int search_samples(int harmonics) {
  return std::max(60, 20 * harmonics);
}

class Clock {
 public:
  explicit Clock(const ExcitationOptions& options) : options_(options) {}
  [[nodiscard]] double seconds() const {
    return options_.elapsed_s + std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  [[nodiscard]] bool interrupted() const { return options_.stop != nullptr && options_.stop->load(); }
  [[nodiscard]] bool over() const { return over(options_.time_limit_s); }
  [[nodiscard]] bool over(double deadline_s) const { return interrupted() || seconds() > deadline_s; }

 private:
  const ExcitationOptions& options_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Numbers of which each takes two draws, whatever was drawn before (Box, Muller 1958).
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : random_(seed) {}
  double uniform() { return unit_of_53_bits(random_) + 0x1.0p-54; }  // in (0, 1)
  double normal() { return std::sqrt(-2 * std::log(uniform())) * std::cos(2 * std::numbers::pi * uniform()); }

 private:
  std::mt19937_64 random_;
};

std::uint64_t mixed(std::uint64_t seed, std::uint64_t number) {
  std::uint64_t x = seed + 0x9E3779B97F4A7C15U * (number + 1);  // splitmix64
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

double margin_of(const DesignSpace& space, const MotionLimits& limits, const FourierSeries& series, int samples) {
  return check_limits(*space.robot, limits, one_period(series), samples).margin();
}

/// The largest factor on the deviations from the centre, up to `most`, with which the limits are kept; none if not even
/// small motions keep them.
std::optional<FourierSeries> fitted(const DesignSpace& space, const MotionLimits& limits, const FourierSeries& series,
                                    double most, int samples) {
  const VectorXd centre = space.states.centre;
  const auto room_at = [&](double factor) {
    return margin_of(space, limits, series.scaled(centre, factor), samples) - kFeasibleMargin;
  };
  double low = 0, high = most, room_high = room_at(most);
  if (room_high >= 0) return series.scaled(centre, most);
  double room_low = room_at(0.0);
  if (room_low < 0) return std::nullopt;
  // Regula falsi with the weight of an end that stays halved (Illinois), which needs a third of the looks that halving
  // takes; every third step halves, because the room jumps where the robot cannot reach.
  constexpr int kSteps = 40;
  constexpr double kEnough = 1e-8;
  int side = 0;
  double room_best = room_low;
  for (int k = 0; k < kSteps && room_best > kEnough && high - low > kEnough * most; ++k) {
    double middle = (low * room_high - high * room_low) / (room_high - room_low);
    if (k % 3 == 2 || !(middle > low && middle < high)) middle = (low + high) / 2;
    const double room = room_at(middle);
    if (room >= 0) {
      low = middle;
      room_low = room_best = room;
      if (side == 1) room_high /= 2;
      side = 1;
    } else {
      high = middle;
      room_high = room;
      if (side == -1) room_low /= 2;
      side = -1;
    }
  }
  if (low <= 0) return std::nullopt;
  return series.scaled(centre, low);
}

/// The limits as the search takes them, which the final check agrees with: Coulomb friction always on the side of the
/// rest of the torque, as if it took its share of the limit away.
MotionLimits without_friction(const Robot& robot, MotionLimits limits) {
  if (limits.parameters.size() == 0) return limits;
  for (const Index k : coulomb_columns(robot)) {
    const int drive = robot.parameter_ids()[static_cast<std::size_t>(k)].number - 1;
    const double friction = std::abs(limits.parameters(k));
    if (drive >= 0 && limits.tau(drive) > friction) limits.tau(drive) -= friction;
    limits.parameters(k) = 0;
  }
  return limits;
}

struct RunCount {
  int planned = 1;
  int done = 0, cut = 0;  ///< searches that ran; those of them that were ended early
  int left_out = 0;       ///< for lack of time
  long evaluations = 0;
};

struct Candidate {
  FourierSeries series;
  double value = -std::numeric_limits<double>::infinity();  ///< of the criterion with the other segments, true signs
};

}  // namespace

MatrixXd series_information(const DesignSpace& space, const FourierSeries& series, int samples) {
  const Index p = space.base_parameters(), n = space.regressor->drives();
  const VectorXd phases = even_phases(samples);
  const MatrixXd z = series.at_phases(phases, 0), zd = series.at_phases(phases, 1), zdd = series.at_phases(phases, 2);
  MatrixXd rows(n * samples, p), A(n, p);
  VectorXd x(3 * n);
  for (Index i = 0; i < samples; ++i) {
    x << z.row(i).transpose(), zd.row(i).transpose(), zdd.row(i).transpose();
    if (space.weighted_columns(x, A) != Status::ok) A.setZero();
    rows.middleRows(n * i, n) = A;
  }
  MatrixXd M = MatrixXd::Zero(p, p);
  M.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose(), 1.0 / samples);
  return M.selfadjointView<Eigen::Lower>();
}

namespace {

/// The search for one segment beside the others.
class SegmentSearch {
 public:
  SegmentSearch(const DesignSpace& space, const MotionLimits& limits, const ExcitationOptions& options,
                const Clock& clock, MatrixXd other_information, double share)
      : space_(space),
        limits_(limits),
        search_limits_(without_friction(*space.robot, limits)),
        options_(options),
        clock_(clock),
        other_(std::move(other_information)),
        share_(share) {}

  [[nodiscard]] ProblemSettings settings(bool polish) const {
    ProblemSettings out{options_,
                        search_samples(options_.harmonics) * (polish ? 2 : 1),
                        polish ? 6 : 4,
                        polish ? 300.0 : 150.0,
                        polish ? 0.01 : 0.02,
                        other_,
                        share_};
    out.least_away += kAwayRoom;
    return out;
  }

  /// Of the criterion as it is reported: true signs, many samples.
  [[nodiscard]] double value(const FourierSeries& series) const {
    ProblemSettings s = settings(true);
    s.samples = kRankSamples;
    s.sign_share = 0;
    const DesignProblem problem(space_, limits_, s);
    DesignProblem::Evaluation e;
    problem.evaluate(problem.variables_of(series), false, e);
    // A motion that lacks rows away from reversals falls behind one that has them, whatever else it shows.
    const double price = 2.0 * space_.base_parameters() * detail::kPriceOfReversals * e.lacks_away;
    return e.regular ? e.value - price : -std::numeric_limits<double>::infinity();
  }

  [[nodiscard]] std::optional<FourierSeries> random_start(std::uint64_t seed) const {
    Normal random(seed);
    const DesignProblem problem(space_, limits_, settings(false));
    for (int attempt = 0; attempt < 20; ++attempt) {
      VectorXd v(problem.variables());
      constexpr double kSpread = 0.3;  // of the coefficients, in units of the largest single amplitudes
      for (Index k = 0; k < v.size(); ++k) v(k) = kSpread * random.normal();
      // Information grows with speed, and so do reversals.
      const double lowest = options_.reversal_reach_s > 0 ? 0.0 : 0.5;
      v(v.size() - 1) = lowest + (1 - lowest) * random.uniform();
      FourierSeries series = problem.series(v);
      series.coefficients.row(0) = space_.states.centre.transpose();
      if (auto found = fitted(space_, limits_, series, 1.0, kRankSamples)) return found;
    }
    return std::nullopt;
  }

  /// All coordinates a little to and fro about the centre, each in its own time.
  [[nodiscard]] FourierSeries slight_motion() const {
    constexpr double kSlight = 1e-6;
    FourierSeries series{options_.highest_hz, MatrixXd::Zero(1 + 2 * options_.harmonics, space_.regressor->drives())};
    series.coefficients.row(0) = space_.states.centre.transpose();
    for (Index i = 0; i < series.coefficients.cols(); ++i) {
      const double phase = static_cast<double>(i);
      series.coefficients(1, i) = kSlight * space_.coordinate_scale(i) * std::cos(phase);
      series.coefficients(2, i) = kSlight * space_.coordinate_scale(i) * std::sin(phase);
    }
    return series;
  }

  [[nodiscard]] FourierSeries kicked(const FourierSeries& series, std::uint64_t seed) const {
    Normal random(seed);
    const DesignProblem problem(space_, limits_, settings(false));
    VectorXd v = problem.variables_of(series);
    const double size = 0.02 + 0.15 * random.uniform();
    for (Index k = 0; k + 1 < v.size(); ++k) v(k) += size * random.normal();
    return problem.series(v);
  }

  /// Local search from a series, then made to keep the true limits. Nothing if that cannot be.
  [[nodiscard]] std::optional<Candidate> improve(const FourierSeries& start, bool polish, double deadline_s,
                                                 long& evaluations) const {
    const DesignProblem problem(space_, search_limits_, settings(polish));
    const detail::SearchResult found =
        detail::local_search(problem, problem.variables_of(start), polish ? kPolishEvaluations : kSearchEvaluations,
                             [&] { return clock_.over(deadline_s); });
    evaluations += found.evaluations;
    const auto series = fitted(space_, limits_, on_grid(problem.series(found.best)), kLargestStretch, kRankSamples);
    if (!series) return std::nullopt;
    return Candidate{*series, value(*series)};
  }

  [[nodiscard]] FourierSeries on_grid(const FourierSeries& series) const {
    FourierSeries result = on_sample_grid(series, options_.rate_hz);
    // The next lower frequency may lie below the range; then the next higher one.
    if (result.base_frequency_hz < options_.lowest_hz * (1 - 1e-9))
      result.base_frequency_hz = options_.rate_hz / std::floor(options_.rate_hz / options_.lowest_hz + 1e-6);
    return result;
  }

  /// All stages: random starts, kicks of the best, polishing.
  [[nodiscard]] std::optional<Candidate> all_stages(double slice_end_s, int starts, std::uint64_t seed,
                                                    const std::optional<FourierSeries>& incumbent, RunCount& run,
                                                    const std::function<void(const Candidate&)>& first) const;

 private:
  const DesignSpace& space_;
  const MotionLimits& limits_;
  MotionLimits search_limits_;
  const ExcitationOptions& options_;
  const Clock& clock_;
  MatrixXd other_;
  double share_;
};

/// Best first; ties by number, so that the order does not depend on the threads.
std::vector<std::size_t> ranked(const std::vector<std::optional<Candidate>>& candidates) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < candidates.size(); ++k)
    if (candidates[k] && std::isfinite(candidates[k]->value)) order.push_back(k);
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return candidates[a]->value > candidates[b]->value; });
  return order;
}

}  // namespace

void ExcitationOptions::validate() const {
  const auto refuse = [](const std::string& what, const std::string& flag, const std::string& mend) {
    throw Error(what, flag, mend, ExitCode::usage);
  };
  if (harmonics < 1 || harmonics > 50) refuse(fmt::format("{} harmonics", harmonics), "--harmonics", "give 1 to 50");
  if (!(lowest_hz > 0) || !(highest_hz >= lowest_hz) || !std::isfinite(highest_hz))
    refuse(fmt::format("the base frequency range {} to {} Hz is empty", lowest_hz, highest_hz), "--base-frequency-hz",
           "give lower,upper with 0 < lower <= upper");
  if (!(rate_hz >= 20 * harmonics * highest_hz) || !std::isfinite(rate_hz))
    refuse(fmt::format("{} Hz is too slow for {} harmonics of {} Hz", rate_hz, harmonics, highest_hz), "--rate-hz",
           fmt::format("give at least {} Hz, twenty samples in the fastest harmonic", 20 * harmonics * highest_hz));
  if (!(time_limit_s > 0)) refuse("the time limit must be positive", "--time-limit-s", "give seconds, e.g. 60");
  if (starts < 0)
    refuse("the number of starts is negative", "--starts", "give 1 or more, or 0 for as many as the time allows");
  if (!(reversal_reach_s >= 0) || !(least_away >= 0 && least_away < 1))
    refuse(fmt::format("a share of {} away from velocity reversals cannot be", least_away), "--away-from-reversals",
           "give 0 to 0.9; 0 leaves reversals out of account");
  if (!(velocity_weight >= 0) || !std::isfinite(velocity_weight))
    refuse("the velocity weight is negative", "--velocity-weight", "give 0 or more");
  if (speeds.empty()) refuse("there is no segment", "--segments", "give 1 or more");
  for (const double speed : speeds)
    if (!(speed > 0 && speed <= 1))
      refuse(fmt::format("the speed {} of a segment is not in (0, 1]", speed), "--segment-speeds",
             "give shares such as 0.3,1");
}

double Excitation::margin() const {
  double margin = 1;
  for (const Segment& segment : segments) margin = std::min(margin, segment.check.margin());
  return margin;
}

std::string Excitation::brief_report() const {
  return fmt::format(
      "D-efficiency {:.3f}, condition number {:.4g}, margin {:.2e}, {} of {} starts, {} evaluations in {:.1f} s{}",
      d_efficiency, condition_number, margin(), finished_starts, starts, evaluations, total_time_s,
      interrupted ? ", interrupted" : (out_of_time ? ", stopped by the time limit" : ""));
}

FourierSeries random_feasible_series(const DesignSpace& space, const MotionLimits& limits,
                                     const ExcitationOptions& options, std::uint64_t seed) {
  const Clock clock(options);
  const SegmentSearch search(space, limits, options, clock, MatrixXd(), 1.0);
  auto series = search.random_start(seed);
  if (series) series = fitted(space, limits, search.on_grid(*series), 1.0, kVerifySamples);
  if (!series) throw Error("no random motion keeps the limits", "limits", "widen the limits", ExitCode::no_convergence);
  return *series;
}

namespace {

std::optional<Candidate> SegmentSearch::all_stages(double slice_end_s, int starts, std::uint64_t seed,
                                                   const std::optional<FourierSeries>& incumbent, RunCount& run,
                                                   const std::function<void(const Candidate&)>& first) const {
  const double begin = clock_.seconds();
  const int random_starts = std::max(1, static_cast<int>(std::lround((1 - kKickedShare) * starts)));
  std::vector<std::optional<Candidate>> found(static_cast<std::size_t>(starts + kPolished) + 1);
  if (incumbent) found.back() = Candidate{*incumbent, value(*incumbent)};
  std::mutex counting;
  const auto count = [&](long evaluations, double deadline_s) {
    const std::lock_guard<std::mutex> lock(counting);
    run.evaluations += evaluations;
    ++run.done;
    run.cut += clock_.over(deadline_s) ? 1 : 0;
    if (options_.progress)
      options_.progress(
          std::max(static_cast<double>(run.done) / run.planned, clock_.seconds() / options_.time_limit_s));
  };
  const auto no_time = [&](double deadline_s) {
    if (!clock_.over(deadline_s)) return false;
    const std::lock_guard<std::mutex> lock(counting);
    ++run.left_out;
    return true;
  };
  const auto attempt = [&](std::size_t k, const std::optional<FourierSeries>& start, bool polish, double deadline_s) {
    long evaluations = 0;
    if (start) {
      auto better = improve(*start, polish, deadline_s, evaluations);
      const double before = value(*start);
      if (better && better->value > before) {
        found[k] = std::move(better);
      } else if (std::isfinite(before) && margin_of(space_, limits_, on_grid(*start), kRankSamples) >= 0) {
        found[k] = Candidate{on_grid(*start), before};
      }
    }
    count(evaluations, deadline_s);
  };

  // A feasible answer before anything else. How long its check takes tells what to keep for that of the result.
  if (auto start = random_start(mixed(seed, 0))) {
    const double before_check = clock_.seconds();
    const auto safe = fitted(space_, limits_, on_grid(*start), 1.0, kVerifySamples);
    if (safe) first(Candidate{*safe, value(*safe)});
    slice_end_s = std::max(begin, slice_end_s - kChecksKept * (clock_.seconds() - before_check));
  }
  const double time = std::max(0.0, slice_end_s - begin);
  in_parallel(random_starts, [&](int k) {
    // The first start is always made, so that there is an answer however short the time.
    if (k > 0 && no_time(begin + kRandomUntil * time)) return;
    attempt(static_cast<std::size_t>(k), random_start(mixed(seed, static_cast<std::uint64_t>(k))), false,
            begin + kRandomUntil * time);
  });
  const std::vector<std::size_t> parents = ranked(found);
  if (!parents.empty()) {
    const std::vector<std::optional<Candidate>> before = found;
    in_parallel(starts - random_starts, [&](int k) {
      if (no_time(begin + kKicksUntil * time)) return;
      const std::size_t parent = parents[static_cast<std::size_t>(k) % std::min<std::size_t>(3, parents.size())];
      const auto number = static_cast<std::size_t>(random_starts + k);
      attempt(number, kicked(before[parent]->series, mixed(seed, number)), false, begin + kKicksUntil * time);
    });
  }
  const std::vector<std::size_t> best = ranked(found);
  const std::vector<std::optional<Candidate>> before = found;
  in_parallel(static_cast<int>(std::min<std::size_t>(kPolished, best.size())), [&](int k) {
    if (no_time(slice_end_s)) return;
    attempt(static_cast<std::size_t>(starts + k), before[best[static_cast<std::size_t>(k)]]->series, true, slice_end_s);
  });
  for (const std::size_t k : ranked(found)) {
    // Checked more finely, the room between the samples turns out larger.
    const auto safe = fitted(space_, limits_, found[k]->series, kLargestStretch, kVerifySamples);
    if (safe) return Candidate{*safe, value(*safe)};
  }
  return std::nullopt;
}

double planned_time(const ExcitationOptions& options) {
  return options.planned_time_s > 0 ? options.planned_time_s : options.time_limit_s;
}

/// How often every segment is searched: once, and again beside what the others have become.
int planned_rounds(const ExcitationOptions& options) {
  const auto segments = static_cast<double>(options.speeds.size());
  return segments > 1 && planned_time(options) >= kTimeForTwoRounds_s * segments ? 2 : 1;
}

int planned_starts(const DesignSpace& space, const ExcitationOptions& options) {
  if (options.starts > 0) return options.starts;
  // A state of N drives is differentiated in 3 N directions at about N joints.
  const double n = space.regressor->drives();
  const double rate = kNominalRate * (4 / n) * (4 / n);
  const double work = static_cast<double>(search_samples(options.harmonics)) * kUsualEvaluations;
  const double searches = planned_rounds(options) * static_cast<double>(options.speeds.size());
  const double seconds = kShareOfTime * std::max(0.0, planned_time(options) - kPreparation_s) * 2;
  const double polish = 2.0 * kPolished;  // in units of starts: twice the samples
  return std::clamp(static_cast<int>(rate * seconds / work / searches - polish), 4, 400);
}

}  // namespace

Excitation optimize_excitation(const DesignSpace& space, const MotionLimits& limits, const DesignBound& bound,
                               const ExcitationOptions& options) {
  options.validate();
  const Clock clock(options);
  const std::size_t count = options.speeds.size();
  const int p = space.base_parameters();
  Excitation result;
  std::vector<MotionLimits> segment_limits;
  for (const double speed : options.speeds) segment_limits.push_back(limits.slowed(speed));
  std::vector<std::optional<FourierSeries>> series(count);
  std::vector<MatrixXd> information(count);
  std::vector<long> evaluations(count, 0);

  const int starts = planned_starts(space, options);
  const int rounds = planned_rounds(options);
  RunCount run;
  run.planned = static_cast<int>(count) * rounds * (starts + kPolished);
  const double share = 1.0 / static_cast<double>(count);
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < count; ++k) {
      if (series[k] && clock.over()) {
        ++run.left_out;
        continue;
      }
      // In the first round the segments that are still to come count as nothing.
      MatrixXd other;
      for (std::size_t j = 0; j < count; ++j) {
        if (j == k || !series[j]) continue;
        if (other.size() == 0) other = MatrixXd::Zero(p, p);
        other += share * information[j];
      }
      const SegmentSearch search(space, segment_limits[k], options, clock, other, share);
      const std::uint64_t seed = mixed(options.seed, static_cast<std::uint64_t>(round) * 1000 + k);
      // Each of the searches that are left gets its part of the time that is left.
      const auto searches_left = static_cast<double>(count * static_cast<std::size_t>(rounds - round) - k);
      const double now = clock.seconds();
      const double slice_end = now + std::max(0.0, options.time_limit_s - now) / searches_left;
      const auto first = [&](const Candidate& candidate) {
        if (result.first_feasible_time_s > 0) return;
        result.first_feasible_time_s = clock.seconds();
        result.first_feasible_efficiency =
            d_efficiency(log_determinant(series_information(space, candidate.series)), bound, p);
      };
      const long evaluations_before = run.evaluations;
      const auto found = search.all_stages(slice_end, starts, seed, series[k], run, first);
      evaluations[k] += run.evaluations - evaluations_before;
      if (!found && !series[k]) {
        const LimitCheck check =
            check_limits(*space.robot, segment_limits[k], one_period(search.slight_motion()), kRankSamples);
        const LimitUse& use = check.tightest();
        throw Error(use.load > 1
                        ? fmt::format("no motion keeps all limits: even the slightest about the pose with the most "
                                      "room breaks the limit '{}' ({:.4g} {} where {:.4g} to {:.4g} is allowed), and "
                                      "the others that were drawn break theirs further",
                                      use.limit.name, use.value, use.limit.unit, use.limit.lower, use.limit.upper)
                        : fmt::format("no motion that keeps all limits was found in time; the tightest is '{}'",
                                      use.limit.name),
                    "limits", "widen this limit, move the workspace, or give more time", ExitCode::no_convergence);
      }
      if (found) {
        series[k] = found->series;
        information[k] = series_information(space, found->series);
      }
    }
  }

  result.information = MatrixXd::Zero(p, p);
  for (std::size_t k = 0; k < count; ++k) {
    Excitation::Segment segment{*series[k], segment_limits[k], {}, information[k], evaluations[k]};
    segment.check = check_limits(*space.robot, segment.limits, one_period(segment.series), kVerifySamples);
    result.information += share * segment.information;
    result.segments.push_back(std::move(segment));
  }
  result.log_det = log_determinant(result.information);
  result.log_det_physical = result.log_det + space.log_det_of_scales();
  result.d_efficiency = d_efficiency(result.log_det, bound, p);
  const VectorXd eigenvalues = dense::eigenvalues(result.information);
  result.condition_number = std::sqrt(eigenvalues(p - 1) / eigenvalues(0));
  const CriterionValue value = evaluate(options.criterion, result.information);
  result.value = value.regular ? value.value : -std::numeric_limits<double>::infinity();
  result.evaluations = run.evaluations;
  result.starts = run.done + run.left_out;
  result.finished_starts = run.done - run.cut;
  result.interrupted = clock.interrupted();
  result.out_of_time = !result.interrupted && result.finished_starts < result.starts;
  result.total_time_s = clock.seconds();
  return result;
}

}  // namespace deltadyn
