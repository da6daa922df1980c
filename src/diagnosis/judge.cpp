#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <optional>

#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/reversal_mask.hpp"

#include "holdout_proof.hpp"
#include "ranking.hpp"

namespace deltadyn::detail {

namespace {

constexpr double kResonance = 0.8;  // of the cut-off: a spring's law holds below the resonance only
constexpr double kInterval = 1.96;  // standard deviations on either side hold 95 %
constexpr double kExplained = 0.8;  // of the structure that names must explain
// ... from which less says that the name is wrong, even if the hold-out log does not show it
constexpr double kHardlyExplained = 0.4;
// ... and that several must: together they can follow much that is none of them
constexpr double kExplainedByMany = 0.985;
constexpr double kOvertStructure = 1.0;  // of the noise variance: too much to be slow noise that the basis follows
constexpr double kSlowOverNoise = 10;    // of a drive's residual; slow noise of all drives comes to 20, hence ...
constexpr double kSlowOverOthers = 5;    // ... times so much more than the others, and ...
constexpr double kSlowOverBoth = 175;    // ... the product of the two
// Of an amplitude, its standard deviation from which a law's course counts as open
constexpr double kUnsureCourse = 0.15;
constexpr double kSlowLogs = 0.25;  // of a drive's velocity limit: training logs below it are slow
// Times the rate over which friction bends: training logs that show where the bend ends
constexpr double kCourse = 3.5;
// Ratio of the largest rates of training logs from which they hold each other's course
constexpr double kTwoSpeeds = 1.5;
// Times the training logs' largest rate: a hold-out log that tries the course beyond ...
constexpr double kFaster = 1.5;
constexpr double kMetBeyond = 0.9;     // ... and the share of its gap that the name must close there
constexpr double kRepeated = 0.05;     // of the hold-out residual's square that structure must explain to count
constexpr double kCarriesOver = 0.5;   // of the hold-out gap that an effect must close ...
constexpr double kLeastClosed = 0.25;  // ... and of one that is hardly larger than the floor
// Rms of the hold-out log over that of training from which the machine itself may differ
constexpr double kOtherMachine = 2.0;
// Rms over floor from which a hold-out log contradicts a model that fits the training logs
constexpr double kHoldoutGap = 1.4;

/// Drives that bear at least a twentieth of the effect.
std::vector<int> drives_of(const SearchContext& context, const WhiteProblem& problem, const Fit& fit) {
  VectorXd energy = VectorXd::Zero(context.robot.drives());
  for (std::size_t s = 0; s < fit.white.blocks.size(); ++s) {
    if (fit.white.blocks[s].size() > 0)
      energy(static_cast<Index>(problem.segments[s].drive)) +=
          (fit.white.blocks[s] * fit.effect.amplitude).squaredNorm();
  }
  std::vector<int> out;
  for (Index j = 0; j < energy.size(); ++j) {
    if (energy(j) > 0.05 * energy.sum()) out.push_back(static_cast<int>(j));
  }
  return out;
}

/// Where the effect does its work: the rates that hold four fifths of it.
std::string region_of(const SearchContext& context, const Fit& fit, const WhiteProblem& problem,
                      const std::vector<int>& drives) {
  if (drives.empty()) return "";
  const auto drive = static_cast<std::size_t>(drives.front());
  const VectorXd s = remaining_torque(problem, fit);
  std::vector<std::pair<double, double>> by_rate;  // |rate|, energy
  double whole = 0;
  for (const WhiteSegment& segment : problem.segments) {
    if (segment.drive != drive) continue;
    const auto& source = segment.whitener.source();
    for (std::size_t k = 0; k < source.size(); ++k) {
      const double e = s(segment.offset + static_cast<Index>(k));
      by_rate.emplace_back(std::abs(context.logs[segment.log].qd(source[k], static_cast<Index>(drive))), e * e);
      whole += e * e;
    }
  }
  std::sort(by_rate.begin(), by_rate.end());
  double sum = 0, low = 0, high = 0;
  for (const auto& [rate, e] : by_rate) {
    if (sum < 0.1 * whole) low = rate;
    if (sum < 0.9 * whole) high = rate;
    sum += e;
  }
  std::string names;
  for (const int j : drives) names += (names.empty() ? "drive " : ", ") + std::to_string(j + 1);
  return fmt::format("{}; 80 % of it at {:.3g} to {:.3g} {} of drive {}", names, low, high,
                     turns(context.robot, drives.front()) ? "rad/s" : "m/s", drives.front() + 1);
}

std::string place_of(const Diagnosis& out, std::size_t drive) {
  std::string text = fmt::format("drive {}", drive + 1);
  const auto& follows = out.drives[drive].follows;
  if (!follows.empty()) text += ", follows " + follows[0].first;
  if (follows.size() > 1 && follows[1].second > 0.5) text += " and " + follows[1].first;
  return text;
}

/// Why the course of friction that bends is open beyond the speeds of the logs; and the rate of the drive that a log
/// should reach.
struct OpenCourse {
  std::string reason;
  double needed_rate = 0;
};

/// Friction that bends keeps its course beyond the logs' speeds only if they show where the bend ends. Nothing for
/// other effects, and for logs that are fast for the drive.
/// \param gap_shrink  on the hold-out log; NaN without one
std::optional<OpenCourse> open_course(const SearchContext& context, const NamedEffect& one, double gap_shrink) {
  const EffectKind& kind = effect_kind(one.effect.id);
  const Course course = kind.course != nullptr ? kind.course(one.effect.shape.data()) : Course::not_by_rate;
  if (course == Course::not_by_rate) return std::nullopt;
  const Index j = one.effect.joint;
  double training = 0, slowest = std::numeric_limits<double>::infinity();
  for (const LogRows& log : context.logs) {
    const double largest = log.qd.col(j).cwiseAbs().maxCoeff();
    training = std::max(training, largest);
    slowest = std::min(slowest, largest);
  }
  const bool one_speed = training < kTwoSpeeds * slowest;
  const double there = context.holdout != nullptr ? context.holdout->qd.col(j).cwiseAbs().maxCoeff() : 0.0;
  double wanted = context.robot.description().limits[static_cast<std::size_t>(j)].velocity;
  if (!std::isfinite(wanted)) wanted = there;
  if (training >= kSlowLogs * wanted) return std::nullopt;
  const double unsure = one.effect.amplitude_std(0) / std::abs(one.effect.amplitude(0));
  std::string reason;
  if (unsure > kUnsureCourse) {
    reason = fmt::format("with an uncertainty of {:.0f} % of its size", 100 * unsure);
  } else if (there > kFaster * training && gap_shrink < kMetBeyond) {
    reason = fmt::format("but closes {:.0f} % of the gap on the faster hold-out log only", 100 * gap_shrink);
  } else if (one_speed && course == Course::endless) {
    reason = "but as a power of the rate, which never ends";
  } else if (one_speed && course == Course::ends_at_rate && training < kCourse * one.effect.shape(0)) {
    reason = fmt::format("but the logs end at {:.2g} times the rate of the bend, before it is over",
                         training / one.effect.shape(0));
  } else {
    return std::nullopt;
  }
  return OpenCourse{reason, kSlowLogs * wanted};
}

/// Does the 95 % interval of every amplitude hold zero?
bool may_be_nothing(const Effect& effect) {
  return effect.amplitude_std.size() == effect.amplitude.size() &&
         (effect.amplitude.cwiseAbs().array() <= kInterval * effect.amplitude_std.array()).all();
}

/// Why a fit is none that a machine can have; empty if it may be one.
std::string no_effect(const Effect& effect, double cutoff_hz) {
  if (may_be_nothing(effect)) return "its size may be zero within its 95 % interval";
  const EffectKind& kind = effect_kind(effect.id);
  if (kind.resonance_hz == nullptr) return "";
  const double resonance_hz = kind.resonance_hz(effect.amplitude.data());
  if (resonance_hz > kResonance * cutoff_hz) return "";
  return fmt::format("its resonance of {:.2g} Hz would show as such in logs that are used up to {:.3g} Hz",
                     resonance_hz, cutoff_hz);
}

/// An accepted effect and its set, without those that no machine can have, which are noted.
std::vector<EffectCandidate> possible_ones(const SearchContext& context, const SearchResult& found, std::size_t k,
                                           Diagnosis& out) {
  std::vector<EffectCandidate> all = {candidate_of(context, found, found.fits[k])};
  all.insert(all.end(), found.sets[k].begin(), found.sets[k].end());
  std::erase_if(all, [&](const EffectCandidate& one) {
    const std::string reason = no_effect(one.effect, out.cutoff_hz);
    if (!reason.empty()) out.notes.push_back(fmt::format("{} fits, but {}: not named", one.at_joint(), reason));
    return !reason.empty();
  });
  return all;
}

/// Takes out what would be a guess beyond the logs' speeds, and says what a log should show. If no name is left,
/// nothing can be said.
void leave_out_open_courses(const SearchContext& context, Diagnosis& out) {
  std::vector<NamedEffect> kept;
  std::string headline, region;
  for (const NamedEffect& one : out.named) {
    const std::optional<OpenCourse> open = open_course(context, one, out.gap_shrink);
    if (!open) {
      kept.push_back(one);
      continue;
    }
    const bool alone = out.named.size() == 1;
    out.lines.push_back(
        fmt::format("{} fits {}, {}: as a term of the model it would be a guess{}.", one.name, one.joint, open->reason,
                    alone ? "" : ", and is left out of it (the figures before and after still hold it)"));
    out.next.push_back(fmt::format("Record {} at {:.2g} {} or more, too, and give that log beside the slow one.",
                                   one.joint, open->needed_rate,
                                   turns(context.robot, one.effect.joint) ? "rad/s" : "m/s"));
    headline = fmt::format(
        "Not testable: the friction of {} is no straight line at low speed, but these logs are too slow to tell its "
        "course at higher speeds.",
        one.joint);
    region = one.region;
  }
  out.named = std::move(kept);
  if (!out.named.empty()) {
    out.verdict = verdict_of(out.named);
    return;
  }
  out.verdict = DiagnosisVerdict::not_testable;
  out.headline = headline;
  out.region = region;
  forget_gap(out);
}

/// A drive whose residual is far above the noise of its own torque signal and, for the size of its torque, above that
/// of the other drives: the noise model can follow anything slow, but such a residual is not noise. Returns the drive
/// or nothing.
std::optional<std::size_t> drive_with_slow_residual(const SearchContext& context, const Diagnosis& out) {
  const double pass_hz = context.processing.torque_cutoff_ratio * context.processing.cutoff_hz;
  std::vector<double> over_noise, over_torque;
  for (std::size_t j = 0; j < out.drives.size(); ++j) {
    double noise = 0, torque = 0;
    for (const LogRows& log : context.logs) {
      const auto tau = log.log.tau.col(static_cast<Index>(j));
      noise += position_noise(tau) * std::sqrt(std::min(1.0, 2 * pass_hz / log.log.rate_hz)) /
               static_cast<double>(context.logs.size());
      torque = std::max(torque, tau.cwiseAbs().maxCoeff());
    }
    over_noise.push_back(out.drives[j].rms_after / std::max(noise, 1e-300));
    over_torque.push_back(out.drives[j].rms_after / std::max(torque, 1e-300));
  }
  if (over_torque.size() < 2) return std::nullopt;
  const auto place = std::ranges::max_element(over_torque) - over_torque.begin();
  const auto worst = static_cast<std::size_t>(place);
  std::vector<double> others = over_torque;
  others.erase(others.begin() + place);
  const double over_others = over_torque[worst] / std::max(upper_median(std::move(others)), 1e-300);
  const bool slow = over_noise[worst] > kSlowOverNoise && over_others > kSlowOverOthers &&
                    over_noise[worst] * over_others > kSlowOverBoth;
  return slow ? std::optional<std::size_t>(worst) : std::nullopt;
}

}  // namespace

DiagnosisVerdict verdict_of(const std::vector<NamedEffect>& named) {
  const bool set = std::ranges::any_of(named, [](const NamedEffect& one) { return !one.confusable.empty(); });
  return set ? DiagnosisVerdict::confusable : DiagnosisVerdict::named;
}

std::vector<int> reached_drives(const std::vector<NamedEffect>& named) {
  std::vector<int> out;
  for (const NamedEffect& one : named) {
    for (const int j : one.drives) {
      if (std::ranges::count(out, j) == 0) out.push_back(j);
    }
  }
  return out;
}

double rms_over(const std::vector<int>& drives, const VectorXd& rms) {
  return root_mean_square(rms(drives));
}

void forget_gap(Diagnosis& out) {
  out.gap_shrink = out.gap_low = out.gap_high = std::numeric_limits<double>::quiet_NaN();
}

bool is_overt(const Diagnosis& out, double largest_share) {
  const auto above = [](const DriveFit& drive) { return drive.rms / std::max(drive.floor, 1e-300) > kOvertFloor; };
  return largest_share > kMaterialStructure && std::ranges::any_of(out.drives, above);
}

double judge(const SearchContext& context, const SearchResult& found, const std::vector<Effect>& known,
             Diagnosis& out) {
  const Index n = context.robot.drives();
  const LogRows* holdout = context.holdout;
  std::optional<HoldoutProof> proof;
  if (holdout != nullptr) proof = prove(context, found, *holdout, known);

  // What the generic basis still sees.
  double left = 0, worst = 0;
  std::size_t worst_drive = 0;
  bool unexplained = false;
  for (Index j = 0; j < n; ++j) {
    const auto drive = static_cast<std::size_t>(j);
    left += std::max(0.0, found.structure_after(j) - found.null.omnibus[drive].quantile(0.5));
    if (found.null.omnibus[drive].p_value(found.structure_after(j)) >= kStructureChance) continue;
    const VectorXd clear = found.omnibus_after.clear_part(*found.after.problem, drive);
    PerLogAndDrive<MatrixXd> columns(context.logs.size(), std::vector<MatrixXd>(static_cast<std::size_t>(n)));
    for (std::size_t l = 0; l < context.logs.size(); ++l) columns[l][drive] = context.basis.columns[l][drive];
    const Remainder structure = remainder_of(context, *found.after.problem, columns, clear);
    const double share = noise_shares(context, structure, found.floor)(j);
    double repeated = 1;  // share of the hold-out log's residual that the same function explains there
    if (holdout != nullptr) {
      const VectorXd there = without_model(context.basis.columns.back()[drive] * clear, holdout->Y[drive],
                                           proof->effects[drive], structure.beta);
      const VectorXd e = proof->after.col(j);
      const double before = root_mean_square(e, holdout->usable[drive]),
                   after = root_mean_square(e - there, holdout->usable[drive]);
      repeated = 1 - after * after / std::max(before * before, 1e-300);
    }
    if (share > worst) {
      worst = share;
      worst_drive = drive;
    }
    unexplained |= share > kOvertStructure || (share > kMaterialStructure && repeated > kRepeated);
  }
  const double gain = std::max(0.0, found.before.problem->r.squaredNorm() - found.after.problem->r.squaredNorm());
  out.explained_share = gain > 0 ? gain / (gain + left) : 0.0;

  double largest_share = 0, largest_gain = 0;  // share of the noise variance, by a named effect
  for (const Fit& fit : found.fits) {
    if (!fit.hygiene) largest_gain = std::max(largest_gain, fit.gain);
  }
  for (std::size_t k = 0; k < found.fits.size(); ++k) {
    const Fit& fit = found.fits[k];
    const Hypothesis& hypothesis = context.search.hypotheses()[fit.hypothesis];
    if (fit.hygiene) {
      if (near_rest(context, fit)) {
        out.notes.push_back(fmt::format(
            "{}: friction near rest (below {:.2g} of its rate) is not Coulomb's; allowed for, not counted as an effect",
            hypothesis.joint_name(), fit.effect.shape(0)));
      } else {
        out.notes.push_back(
            fmt::format("torque and positions of {} are {:.2g} ms apart, at most about one sample: allowed for in the "
                        "search, not counted as an effect",
                        hypothesis.joint_name(), 1e3 * fit.effect.shape(0)));
      }
      continue;
    }
    if (holdout != nullptr && fit.gain < largest_gain && !carries_over(context, found, *proof, fit)) {
      out.notes.push_back(fmt::format("{} at {} fits the training logs, but not the hold-out log: a trace, not named",
                                      hypothesis.name(), hypothesis.joint_name()));
      continue;
    }
    const std::vector<EffectCandidate> possible = possible_ones(context, found, k, out);
    if (possible.empty()) continue;
    NamedEffect one;
    static_cast<EffectCandidate&>(one) = possible.front();
    one.why.clear();
    // An effect that was taken in beside others can have gained more alone than all of them together.
    const Remainder torque = remainder_of(context, *found.before.problem, fit.rows, fit.effect.amplitude);
    largest_share = std::max(largest_share, noise_shares(context, torque, found.floor).maxCoeff());
    one.explained_share = fit.gain / std::max({gain + left, fit.gain, 1e-300});
    one.confusable.assign(possible.begin() + 1, possible.end());
    one.drives = drives_of(context, *found.before.problem, fit);
    one.region = region_of(context, fit, *found.before.problem, one.drives);
    out.named.push_back(std::move(one));
  }
  std::ranges::sort(out.named, std::greater(), &NamedEffect::gain);
  out.p_value = out.named.empty() ? found.null.omnibus_p(found.structure_before) : out.named.front().p_value;
  if (!out.named.empty()) out.verdict = verdict_of(out.named);
  const double must_explain = out.named.size() > 1 ? kExplainedByMany : kHardlyExplained;
  const bool too_little = !out.named.empty() && worst > kMaterialFurther && out.explained_share < must_explain;
  const bool unknown = too_little || (unexplained && (out.named.empty() || out.explained_share < kExplained));
  if (unknown) {
    out.verdict = DiagnosisVerdict::unknown_structure;
    out.region = place_of(out, worst_drive);
    if (!out.named.empty()) {
      out.lines.push_back(fmt::format(
          "The best of the catalogue, {}{}, explains {:.0f} % of the structure only; a name for the rest "
          "would be a guess.",
          out.named.front().at_joint(), out.named.size() > 1 ? " and others" : "", 100 * out.explained_share));
    }
  }

  if (holdout != nullptr) {
    DiagnosisTrace trace = trace_of(*holdout);
    trace.holdout = true;
    trace.before = proof->before;
    trace.after = proof->after;
    out.traces.push_back(std::move(trace));
    for (Index j = 0; j < n; ++j) {
      out.drives[static_cast<std::size_t>(j)].rms_holdout = proof->rms_before(j);
      out.drives[static_cast<std::size_t>(j)].floor_holdout = proof->floor(j);
    }
    const std::vector<int> touched = reached_drives(out.named);
    for (NamedEffect& one : out.named) {
      one.rms_before = rms_over(one.drives, proof->rms_before);
      one.rms_after = rms_over(one.drives, proof->rms_after);
      one.rms_floor = rms_over(one.drives, proof->floor);
    }
    if (!touched.empty()) {
      shrink_of(*proof, *holdout, touched, context.options.seed, out);
      double gap = 0;
      for (const int j : touched) gap = std::max(gap, proof->rms_before(j) / std::max(proof->floor(j), 1e-300));
      const bool worse = out.gap_shrink < 0;  // then even a small gap speaks against the name
      if (out.verdict != DiagnosisVerdict::unknown_structure &&
          (worse || out.gap_shrink < (gap > 1.05 ? kCarriesOver : kLeastClosed))) {
        const std::string line =
            fmt::format("{} fits the training logs, but {} on the hold-out log: it is not what is missing.",
                        out.named.front().at_joint(),
                        worse ? std::string("makes the model worse")
                              : fmt::format("closes {:.0f} % of the gap only", 100 * out.gap_shrink));
        if (is_overt(out, largest_share)) {
          out.verdict = DiagnosisVerdict::unknown_structure;
          out.region = place_of(out, static_cast<std::size_t>(touched.front()));
          out.lines.push_back(line);
          for (NamedEffect& one : out.named) one.why = "the hold-out log does not confirm it";
          const auto drive = static_cast<std::size_t>(touched.front());
          if (proof->rms_before(touched.front()) > kOtherMachine * out.drives[drive].rms) {
            out.next.push_back(
                fmt::format("The hold-out log leaves {:.3g} {} at drive {} where the training logs leave {:.3g}: was "
                            "anything changed in between (load, hose, robot)?",
                            proof->rms_before(touched.front()), unit_of_drive(context.robot, touched.front()),
                            drive + 1, out.drives[drive].rms));
          }
        } else {
          // Chance, or a trace of no use to anybody.
          out.verdict = DiagnosisVerdict::nothing_missing;
          out.notes.push_back(line);
          out.named.clear();
          forget_gap(out);
        }
      }
    }
    if (out.verdict == DiagnosisVerdict::nothing_missing) {
      for (Index j = 0; j < n; ++j) {
        const DriveFit& training = out.drives[static_cast<std::size_t>(j)];
        const double here = proof->rms_before(j) / std::max(proof->floor(j), 1e-300);
        // What noise has left open in the parameters shows in every other log. And slow noise makes the floor of one
        // log look low: the residual itself must be larger than in training, too.
        const double expected = std::hypot(std::max(training.rms, proof->floor(j)), proof->unsure(j));
        const bool larger = proof->rms_before(j) > kHoldoutGap * expected;
        const double there =
            std::hypot(training.rms / std::max(training.floor, 1e-300), proof->unsure(j) / proof->floor(j));
        if (larger && here > kHoldoutGap * std::max(1.0, there)) {
          out.verdict = DiagnosisVerdict::not_testable;
          out.region = fmt::format("drive {}", j + 1);
          out.headline = fmt::format(
              "Not testable: drive {} misses the hold-out log ({:.3g} times its floor), but the training logs cannot "
              "show why.",
              j + 1, here);
          out.lines.push_back(
              "The hold-out log moves where the training logs did not: from these alone a name would be luck.");
        }
      }
    }
  } else {
    for (NamedEffect& one : out.named) {
      const auto j = static_cast<std::size_t>(one.drives.empty() ? 0 : one.drives.front());
      one.rms_before = out.drives[j].rms;
      one.rms_after = out.drives[j].rms_after;
      one.rms_floor = out.drives[j].floor;
    }
    out.notes.push_back(
        "no hold-out log: before and after are those of the training logs, which prove less (--holdout)");
  }
  if (gives_a_name(out.verdict)) leave_out_open_courses(context, out);
  if (out.verdict == DiagnosisVerdict::nothing_missing || out.verdict == DiagnosisVerdict::not_testable) {
    if (const std::optional<std::size_t> slow = drive_with_slow_residual(context, out)) {
      out.verdict = DiagnosisVerdict::unknown_structure;
      out.region = fmt::format("drive {}, a slow torque of {:.3g} rms that the motion does not explain", *slow + 1,
                               out.drives[*slow].rms_after);
    }
  }
  if (found.before.problem->Q.cols() < context.base.count() + amplitude_count(known) &&
      out.verdict == DiagnosisVerdict::nothing_missing) {
    out.verdict = DiagnosisVerdict::not_testable;
    out.headline =
        "Not testable: the motion does not even show all base parameters, so that an effect could hide behind them.";
  }
  if (gives_a_name(out.verdict)) {
    for (const NamedEffect& one : out.named) out.effects.push_back(one.effect);
  } else {
    // A candidate that does not suffice, or that the hold-out log contradicts, is shown, not added.
    for (NamedEffect& one : out.named) {
      if (one.why.empty()) one.why = "it does not explain enough";
    }
  }
  for (ConsideredEffect& one : out.considered) {
    const bool added = std::ranges::any_of(
        out.named, [&](const NamedEffect& named) { return is_of(one, named) && named.why.empty(); });
    if (one.ruling == kFound && !added) one.ruling = "fits, but is not confirmed";
  }
  return largest_share;
}

}  // namespace deltadyn::detail
