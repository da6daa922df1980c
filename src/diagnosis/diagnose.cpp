#include "deltadyn/diagnosis/diagnose.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <set>

#include "deltadyn/diagnosis/effect_search.hpp"
#include "deltadyn/identification/cutoff_scan.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/reversal_mask.hpp"

#include "diagnosis_steps.hpp"

namespace deltadyn {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const char* verdict_name(DiagnosisVerdict verdict) {
  switch (verdict) {
    case DiagnosisVerdict::nothing_missing: return "nothing-missing";
    case DiagnosisVerdict::named: return "named";
    case DiagnosisVerdict::confusable: return "confusable";
    case DiagnosisVerdict::unknown_structure: return "unknown-structure";
    case DiagnosisVerdict::not_testable: return "not-testable";
  }
  return "";
}

void DiagnosisOptions::validate() const {
  const auto refuse = [](const char* field, const char* range) {
    throw Error(std::string("the option is out of range; ") + range, field, "choose a value in the range", ExitCode::usage);
  };
  processing.validate();
  if (!(false_naming_rate > 0 && false_naming_rate < 0.5)) refuse("--false-naming-rate", "it must be above 0 and below 0.5");
  if (max_effects < 1 || max_effects > 6) refuse("--max-effects", "it must be 1 to 6");
  if (null_runs < 20 || null_runs > 100000) refuse("--null-runs", "it must be 20 to 100000");
  if (!processing.filter) {
    throw Error("the diagnosis filters every log alike, whatever columns it has", "--no-filter", "leave the flag out",
                ExitCode::usage);
  }
}

namespace {

constexpr double kMotionOverPass = 2.0;  // cut-off of the motion in units of the one that identification uses: then the
constexpr double kPassOverMotion = 0.6;  // low pass of regressor and torque, not that of the motion, bounds the band
constexpr double kGoodScore = 1.03;
constexpr double kLeastCutoff_hz = 20;      // below, nothing of a reversal would be left out but everything
constexpr double kMostCutoff_hz = 25;       // above, encoder noise in the accelerations outweighs what is gained beside reversals
constexpr double kSettled = 0.1;            // change of an amplitude that least squares without noise model may make
constexpr double kRestFloor = 0.03;         // share of a log's largest rate below which friction is that of rest
constexpr double kRestOfAll = 0.03;         // share of the largest rate in all logs for which the same holds ...
constexpr double kMostRest = 0.12;          // ... but no more than this share of a slow log's own, which must show something
constexpr int kMostPasses = 3;              // of the search with parameters that are better each time ...
constexpr double kSameSize = 0.003;         // ... until no amplitude changes by more than this share
constexpr double kUsualNoise = 0.01;        // of a drive's torque
constexpr double kFewestRowsPerBase = 4.0;  // rows of a drive in units of base parameters a drive

/// Positions and torques of every sample, to be compared as they are.
std::set<std::vector<double>> samples_of(const Log& log) {
  std::set<std::vector<double>> out;
  for (Index k = 0; k < log.samples(); ++k) {
    std::vector<double> one(log.q.row(k).begin(), log.q.row(k).end());
    one.insert(one.end(), log.tau.row(k).begin(), log.tau.row(k).end());
    out.insert(std::move(one));
  }
  return out;
}

/// Is most of the second log in the first? Single samples may be alike by chance, at rest.
bool holds_most_of(const Log& log, const Log& part) {
  if (log.q.cols() != part.q.cols()) return false;
  const std::set<std::vector<double>> samples = samples_of(log), of_part = samples_of(part);
  const auto shared = std::count_if(of_part.begin(), of_part.end(), [&](const auto& one) { return samples.count(one) > 0; });
  return 2 * shared > static_cast<std::ptrdiff_t>(of_part.size());
}

/// The highest cut-off that is as good as the best one: smooth motions leave the choice open, and a narrow band widens every reversal.
double widest_good_cutoff_hz(const std::vector<CutoffPoint>& points) {
  double best = std::numeric_limits<double>::infinity(), cutoff_hz = 0;
  for (const CutoffPoint& point : points) best = std::min(best, point.score);
  for (const CutoffPoint& point : points) {
    if (point.score <= kGoodScore * best) cutoff_hz = std::max(cutoff_hz, point.cutoff_hz);
  }
  return std::max(cutoff_hz, kLeastCutoff_hz);
}

/// What the diagnosis leaves out beside the user's choice.
ProcessingOptions without_rest(ProcessingOptions options) {
  options.periods = Periods::ignore;
  options.reversal_floor = std::max(options.reversal_floor, kRestFloor);
  return options;
}

ProcessingOptions diagnosis_processing(const std::vector<Log>& logs, ProcessingOptions out, double cutoff_hz) {
  double rate_hz = 1e12;
  for (const Log& log : logs) rate_hz = std::min(rate_hz, 1.0 / log.sample_time_s());
  out.cutoff_hz = std::min(kMotionOverPass * cutoff_hz, 0.35 * rate_hz);
  out.motion_over_pass = 1;
  out.torque_cutoff_ratio = kPassOverMotion;
  // An even stride lets simulated motions be thinned.
  const double pass_hz = std::min(kPassOverMotion * out.cutoff_hz, 0.4 * rate_hz);
  const int stride = std::max(1, static_cast<int>(0.4 * rate_hz / pass_hz));
  out.stride = stride >= 4 ? stride - stride % 4 : (stride >= 2 ? 2 : 1);
  return out;
}

/// Takes a row off either end, so that a thinned motion has a sample to spare.
PreparedLog prepared(const Robot& robot, const Log& log, const ProcessingOptions& options) {
  PreparedLog out = prepare_log(robot, log, options);
  out.rest.resize(0, 0);  // leave_rest_out() has a measure of its own for all logs together
  if (out.rows > 10) {
    out.first += out.stride;
    out.rows -= 2;
  }
  return out;
}

/// Rows of the drive of which least is known in all logs, less the directions that reversals take.
double fewest_rows(const std::vector<LogRows>& logs) {
  double fewest = 1e12;
  for (std::size_t j = 0; j < logs.front().usable.size(); ++j) {
    double rows = 0;
    for (const LogRows& log : logs) {
      const auto tau = log.tau.col(static_cast<Index>(j));
      NoiseModel noise;
      noise.std = std::max(kUsualNoise * std::sqrt(tau.squaredNorm() / static_cast<double>(tau.size())), 1e-12);
      rows += static_cast<double>(Whitener(noise, log.present[j], log.unknown[j]).freedom());
    }
    fewest = std::min(fewest, rows);
  }
  return fewest;
}

/// Rates of the joints that have friction, samples x joints.
MatrixXd friction_rates(const Robot& robot, const PreparedLog& log) {
  MatrixXd rates(log.t_s.size(), robot.friction_joints());
  VectorXd v(robot.friction_joints());
  for (Index k = 0; k < rates.rows(); ++k) {
    if (robot.friction_joint_rates(log.q.row(k).transpose(), log.qd.row(k).transpose(), v) != Status::ok) v.setZero();
    rates.row(k) = v.transpose();
  }
  return rates;
}

/// Leaves friction at rest out of slow logs, too: what is slow is measured by the fastest log.
void leave_rest_out(const Robot& robot, std::vector<PreparedLog*> logs) {
  std::vector<MatrixXd> rates;
  VectorXd largest = VectorXd::Zero(robot.friction_joints());
  for (const PreparedLog* log : logs) {
    rates.push_back(friction_rates(robot, *log).cwiseAbs());
    largest = largest.cwiseMax(rates.back().colwise().maxCoeff().transpose());
  }
  const auto limbs = static_cast<Index>(robot.description().limbs.size());
  for (std::size_t l = 0; l < logs.size(); ++l) {
    const VectorXd own = rates[l].colwise().maxCoeff().transpose();
    for (Index joint = 0; joint < largest.size(); ++joint) {
      const double threshold = std::min(kRestOfAll * largest(joint), kMostRest * own(joint));
      for (Index k = 0; k < rates[l].rows(); ++k) {
        if (rates[l](k, joint) >= threshold) continue;
        if (joint < robot.drives()) {
          logs[l]->reversal(k, joint) = true;
        } else {
          logs[l]->reversal.row(k).head(limbs) = true;  // the telescope bar's friction acts on the limbs' drives
        }
      }
    }
  }
}

/// Have two searches found the same effects, in the same sizes?
bool settled(const detail::SearchResult& last, const detail::SearchResult& found) {
  if (last.fits.size() != found.fits.size()) return false;
  for (std::size_t k = 0; k < found.fits.size(); ++k) {
    const Effect &before = last.fits[k].effect, &now = found.fits[k].effect;
    if (before.id != now.id || before.joint != now.joint) return false;
    if ((before.amplitude - now.amplitude).norm() > kSameSize * now.amplitude.norm()) return false;
  }
  return true;
}

/// Amplitudes from the same least squares as the parameters, so that both belong together; where encoder noise in the column makes
/// them come out small, those of the search stay.
void settle_amplitudes(const Robot& robot, const std::vector<Log>& logs, const VectorXd& p, const Identification& used,
                       Diagnosis& out) {
  const std::vector<Effect> settled = estimate_amplitudes(robot, logs, p, out.effects, used);
  for (std::size_t k = 0; k < settled.size(); ++k) {
    Effect& effect = out.effects[k];
    const VectorXd change = settled[k].amplitude - effect.amplitude;
    if (change.norm() > kSettled * effect.amplitude.norm()) continue;
    effect.amplitude = settled[k].amplitude;
    if (effect_kind(effect.id).tied) effect.shape(0) = effect.amplitude(0);
    if (effect.amplitude_std.size() == change.size()) effect.amplitude_std = effect.amplitude_std.cwiseMax(change.cwiseAbs());
    for (NamedEffect& one : out.named) {
      if (one.effect.id == effect.id && one.effect.joint == effect.joint) one.effect = effect;
    }
  }
}

}  // namespace

Diagnosis diagnose(const Robot& robot, const std::vector<Log>& all_logs, const Log* holdout, const VectorXd& p,
                   const VectorXd& p_std, const std::vector<Effect>& all_known, const DiagnosisOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  options.validate();
  if (all_logs.empty()) throw Error("there is no log", "", "give at least one log file", ExitCode::usage);
  if (holdout != nullptr) {
    for (const Log& log : all_logs) {
      if (holds_most_of(log, *holdout)) {
        throw Error("the hold-out log is one of the training logs (" + log.file + ") or cut from it", holdout->file,
                    "hold out a log that takes no part in the search, else it proves nothing", ExitCode::usage);
      }
    }
  }
  const auto report = [&](double share) {
    if (options.progress) options.progress(share);
  };
  Diagnosis out;
  out.null_runs = options.null_runs;
  out.effects = all_known;
  out.gap_shrink = out.gap_low = out.gap_high = std::numeric_limits<double>::quiet_NaN();
  const auto finish = [&]() {
    out.total_time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    report(1);
    return out;
  };

  // Known effects whose shape is their amplitude are taken off at once, the others are fitted along.
  std::vector<Effect> known, fixed;
  for (const Effect& effect : all_known) (effect_kind(effect.id).tied ? fixed : known).push_back(effect);
  std::vector<Log> logs = all_logs;
  std::optional<Log> held_log;
  if (holdout != nullptr) held_log = *holdout;
  if (!fixed.empty()) {
    double cutoff_hz = options.processing.cutoff_hz;
    if (options.choose_cutoff) cutoff_hz = widest_good_cutoff_hz(scan_cutoffs(robot, logs, options.processing, options.threads));
    logs = without_effects(robot, logs, p, fixed, kMotionOverPass * cutoff_hz);
    if (held_log) held_log = without_effects(robot, {*held_log}, p, fixed, kMotionOverPass * cutoff_hz).front();
  }

  double length = 0;
  for (const Log& log : logs) length += static_cast<double>(log.samples()) * log.sample_time_s();
  const BaseParameters base = find_base_parameters(robot);
  ProcessingOptions processing;
  std::vector<LogRows> rows, held;
  const ProcessingOptions wanted = without_rest(options.processing);
  if (options.processing.periods == Periods::given)
    out.notes.push_back("periods are not averaged here: every log is used as it is");
  try {
    const double widest_hz =
        options.choose_cutoff ? widest_good_cutoff_hz(scan_cutoffs(robot, logs, wanted, options.threads)) : wanted.cutoff_hz;
    report(0.05);
    out.cutoff_hz = options.choose_cutoff ? std::min(widest_hz, kMostCutoff_hz) : widest_hz;
    processing = diagnosis_processing(logs, wanted, out.cutoff_hz);
    std::vector<PreparedLog> ready;
    for (const Log& log : logs) ready.push_back(prepared(robot, log, processing));
    if (held_log) ready.push_back(prepared(robot, *held_log, processing));
    std::vector<PreparedLog*> each;
    for (PreparedLog& log : ready) each.push_back(&log);
    leave_rest_out(robot, each);
    for (std::size_t l = 0; l < logs.size(); ++l)
      rows.push_back(make_log_rows(robot, base, std::move(ready[l]), static_cast<int>(l) + 1));
    if (held_log) held.push_back(make_log_rows(robot, base, std::move(ready.back()), 0));
  } catch (const Error& error) {
    if (std::string(error.problem()).find("too short") == std::string::npos) throw;
    detail::say_too_short(length, std::max(10.0, 4 * length), out);
    return finish();
  }
  // Rows enough to fit the base model and still see something beside it?
  const double fewest = fewest_rows(rows);
  const double needed = std::max(120.0, kFewestRowsPerBase * base.count());
  if (fewest < needed) {
    detail::say_too_short(length, 1.2 * length * needed / std::max(fewest, 1.0), out);
    return finish();
  }

  const EffectModel model(robot);
  VectorXd p_fit = refit_parameters(base, rows, p);
  const auto fill_signals = [&] {
    for (std::vector<LogRows>* group : {&rows, &held}) {
      for (LogRows& log : *group) log.signals = model.signals(log.log, p_fit);
    }
  };
  fill_signals();
  GenericBasis basis = make_generic_basis(rows, held);
  auto search = std::make_unique<EffectSearch>(model, rows, basis, known);
  report(0.15);
  PerLogAndDrive<double> position_noises;
  for (const Log& log : logs) {
    position_noises.emplace_back();
    for (Index j = 0; j < log.q.cols(); ++j) position_noises.back().push_back(position_noise(log.q.col(j)));
  }
  const auto context_of = [&] {
    detail::SearchContext context{robot, model, base, rows, basis, *search, options, processing, p_fit};
    context.holdout = held.empty() ? nullptr : &held.front();
    context.position_noise = position_noises;
    return context;
  };
  detail::SearchResult found = detail::search_effects(context_of(), out);
  // Loads, torques and tilts were those of a model that had to make up for what is missing: again with the better one.
  for (int pass = 0; pass < kMostPasses && !found.accepted.empty(); ++pass) {
    p_fit = closest_parameters(base, found.after.problem->beta.head(base.count()), p);
    fill_signals();
    basis = make_generic_basis(rows, held);
    search = std::make_unique<EffectSearch>(model, rows, basis, known);
    const detail::SearchResult last = std::move(found);
    found = detail::search_effects(context_of(), out, &last);
    if (settled(last, found)) break;
  }
  const detail::SearchContext context = context_of();
  report(0.9);

  detail::describe_drives(context, found, p, known, out);
  detail::judge(context, found, known, out);
  if (options.identify && !out.named.empty()) {
    try {
      IdentificationOptions identification;
      identification.processing = options.processing;
      identification.processing.cutoff_hz = out.cutoff_hz;
      identification.choose_cutoff = false;
      identification.threads = options.threads;
      const auto improve = [&] {
        const double motion_hz = identification.processing.motion_over_pass * out.cutoff_hz;
        out.improved = identify(robot, without_effects(robot, all_logs, p_fit, out.effects, motion_hz), p, p_std, identification);
      };
      improve();
      settle_amplitudes(robot, all_logs, p_fit, *out.improved, out);
      improve();
    } catch (const Error& error) {
      out.notes.push_back(std::string("the consistent parameters of the improved model could not be fitted: ") + error.problem());
    }
  }
  detail::say(context, out);
  return finish();
}

}  // namespace deltadyn
