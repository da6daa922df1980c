#include "describe.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>

namespace deltadyn::detail {

namespace {

// Of a signature's square: less is left beside the base model than any noise allows to see
constexpr double kHidden = 0.002;
constexpr double kAlikeSignatures = 0.97;  // |cosine| of two signatures from which on their names should not be trusted
constexpr std::size_t kMostAlike = 4;

/// A shape in the middle of the start values stands for the hypothesis.
std::size_t middle_shape(const Hypothesis& hypothesis, const Signature& signature) {
  std::size_t best = hypothesis.shapes.size() / 2;
  if (!(signature.gram.size() > best) || !(signature.gram[best].trace() > 0)) best = 0;
  return best;
}

/// Detectable and distinguishable: from the motion alone, before the torque has a say (step 11).
void what_the_logs_show(const SearchContext& context, const SearchResult& found,
                        std::vector<ConsideredEffect>& considered) {
  const auto& hypotheses = context.search.hypotheses();
  const EffectSearch::State state = context.search.state(without_memory(found.noise), {}, nullptr);
  std::vector<WhiteColumns> one(hypotheses.size());
  std::vector<MatrixXd> gram(hypotheses.size());
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    const Signature& signature = state.signatures[h];
    const std::size_t shape = middle_shape(hypotheses[h], signature);
    const Index k = hypotheses[h].amplitudes;
    considered[h].kept = std::ranges::max(signature.kept);
    if (signature.white.cols() == 0) continue;
    one[h] = signature.white.part(static_cast<Index>(shape) * k, k);
    gram[h] = signature.gram[shape];
  }
  for (std::size_t a = 0; a < one.size(); ++a) {
    std::vector<std::pair<double, std::string>> alike;
    for (std::size_t b = 0; b < one.size(); ++b) {
      // One column each: the angle between spans of several would need its own words.
      if (a == b || one[a].cols() != 1 || one[b].cols() != 1) continue;
      const double size = std::sqrt(gram[a](0, 0) * gram[b](0, 0));
      if (!(size > 0)) continue;
      const double cosine = std::abs(cross_gram(one[a], one[b])(0, 0)) / size;
      if (cosine > kAlikeSignatures)
        alike.emplace_back(cosine, fmt::format("{} at {} ({:.3f})", considered[b].name, considered[b].joint, cosine));
    }
    std::sort(alike.rbegin(), alike.rend());
    for (std::size_t k = 0; k < std::min(kMostAlike, alike.size()); ++k) considered[a].like.push_back(alike[k].second);
  }
}

/// Ruling on hypothesis h, of which all but the ruling is known.
void rule_on(const SearchContext& context, const SearchResult& found, std::size_t h, ConsideredEffect& one) {
  for (const Fit& fit : found.fits) {
    if (fit.hypothesis == h) {
      one.ruling = fit.hygiene ? Ruling::about_a_sample : Ruling::found;
      return;
    }
    if (std::ranges::any_of(fit.set, [&](const EffectCandidate& other) { return one.is(other); })) {
      one.ruling = Ruling::like_another;
      one.other = effect_kind(fit.effect.id).name;
      return;
    }
  }
  const double alpha = context.options.false_naming_rate;
  const bool wrong_sign =
      found.before.scores[h].gain <= 0 && effect_kind(context.search.hypotheses()[h].id).amplitudes.front().positive();
  if (one.kept < kHidden) {
    one.ruling = Ruling::absorbed;
  } else if (one.p_left <= alpha) {
    one.ruling = Ruling::left_by_form;
  } else if (one.p_alone <= alpha && !found.fits.empty()) {
    const Fit& first = *std::ranges::max_element(found.fits, {}, &Fit::gain);
    one.ruling = Ruling::beside_nothing;
    one.other = effect_kind(first.effect.id).name;
    one.other_share = one.gain_alone / first.gain;
  } else if (one.p_alone <= alpha) {
    one.ruling = Ruling::trace;
  } else {
    one.ruling = wrong_sign ? Ruling::wrong_sign : Ruling::no_evidence;
  }
}

/// Of the training logs, then of the hold-out log.
std::vector<RowCount> row_counts(const SearchContext& context, std::size_t drive) {
  std::vector<RowCount> out;
  const auto add = [&](const LogRows& log) {
    out.push_back({log.usable[drive].count(), (log.present[drive] && !log.usable[drive]).count(), log.rows()});
  };
  for (const LogRows& log : context.logs) add(log);
  if (context.holdout != nullptr) add(*context.holdout);
  return out;
}

}  // namespace

void settle_rulings(Diagnosis& out) {
  const bool names = gives_a_name(out.verdict);
  for (ConsideredEffect& one : out.considered) {
    const auto same = [&](const EffectCandidate& other) { return one.is(other); };
    const auto set = std::ranges::find_if(
        out.named, [&](const NamedEffect& named) { return std::ranges::any_of(named.confusable, same); });
    if (names && std::ranges::any_of(out.named, same)) {
      one.ruling = Ruling::found;
    } else if (names && set != out.named.end()) {
      one.ruling = Ruling::like_another;
      one.other = set->name;
    } else if (one.ruling == Ruling::found || (names && one.ruling == Ruling::like_another)) {
      const bool denied =
          out.reason == VerdictReason::written_model_refused || out.reason == VerdictReason::not_borne_out;
      one.ruling = denied ? Ruling::holdout_denies : Ruling::not_confirmed;
    }
  }
}

DiagnosisTrace trace_of(const LogRows& log) {
  DiagnosisTrace out;
  out.file = log.log.file;
  out.t_s = log.t_s;
  out.q = log.q;
  out.qd = log.qd;
  out.torque = log.tau;
  if (log.ripple.size() > 0) out.torque += log.ripple;
  for (MatrixXd* residual : {&out.before, &out.after}) residual->resize(log.rows(), log.tau.cols());
  out.usable.resize(log.rows(), log.tau.cols());
  for (std::size_t j = 0; j < log.usable.size(); ++j) out.usable.col(static_cast<Index>(j)) = log.usable[j];
  return out;
}

void describe_drives(const SearchContext& context, const SearchResult& found, const VectorXd& p,
                     const std::vector<Effect>& model, Diagnosis& out) {
  const auto& logs = context.logs;
  const Index n = context.robot.drives();
  const std::vector<LogRows> corrected = context.search.corrected(found.fits);
  const PerLogAndDrive<MatrixXd> known = context.search.extra({}), all = context.search.extra(found.fits);
  const VectorXd &beta0 = found.before.problem->beta, &beta1 = found.after.problem->beta;
  VectorXd beta_given(beta0.size());
  beta_given << context.base.B * p, amplitudes_of(model);
  std::vector<double> count(static_cast<std::size_t>(n), 0), white_rows = count;
  out.drives.resize(count.size());
  for (std::size_t l = 0; l < logs.size(); ++l) {
    DiagnosisTrace trace = trace_of(logs[l]);
    for (Index j = 0; j < n; ++j) {
      const auto drive = static_cast<std::size_t>(j);
      DriveFit& squares = out.drives[drive];
      const MatrixXd& Y = logs[l].Y[drive];
      const RowMask& usable = logs[l].usable[drive];
      trace.before.col(j) = without_model(logs[l].tau.col(j), Y, known[l][drive], beta0);
      trace.after.col(j) = without_model(corrected[l].tau.col(j), Y, all[l][drive], beta1);
      const auto rows = static_cast<double>(usable.count());
      squares.rms += usable.select(trace.before.col(j).array(), 0.0).square().sum();
      squares.rms_after += usable.select(trace.after.col(j).array(), 0.0).square().sum();
      const VectorXd e = without_model(logs[l].tau.col(j), Y, known[l][drive], beta_given);
      squares.rms_given += usable.select(e.array(), 0.0).square().sum();
      squares.floor += rows * found.floor[l][drive] * found.floor[l][drive];
      count[drive] += rows;
    }
    out.traces.push_back(std::move(trace));
  }
  for (const WhiteSegment& segment : found.before.problem->segments)
    white_rows[segment.drive] += static_cast<double>(segment.whitener.freedom());
  for (std::size_t j = 0; j < static_cast<std::size_t>(n); ++j) {
    const auto at = static_cast<Index>(j);
    DriveFit& drive = out.drives[j];
    drive.rows = row_counts(context, j);
    for (double* figure : {&drive.rms, &drive.rms_after, &drive.rms_given, &drive.floor})
      *figure = std::sqrt(*figure / std::max(1.0, count[j]));
    const double chance = found.null.omnibus[j].quantile(0.5);
    const double excess = std::max(0.0, found.structure_before(at) - chance);
    drive.structure = excess / std::max(1.0, excess + white_rows[j]);
    drive.p_value = found.null.omnibus[j].p_value(found.structure_before(at));
    drive.p_left = found.null.omnibus[j].p_value(found.structure_after(at));
    drive.follows = found.omnibus_before.by_coordinate(*found.before.problem, j);
    std::ranges::sort(drive.follows, std::greater(), &std::pair<std::string, double>::second);
    const double largest = drive.follows.empty() ? 0.0 : drive.follows.front().second;
    for (auto& [name, gain] : drive.follows) gain /= std::max(largest, 1e-300);
  }
}

void list_considered(const SearchContext& context, const SearchResult& found, Diagnosis& out) {
  const auto& hypotheses = context.search.hypotheses();
  const double material = context.policy().material * rows_per_drive(context, *found.before.problem);
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    ConsideredEffect one;
    one.name = hypotheses[h].name();
    one.effect_class = effect_class_name(hypotheses[h].kind().effect_class);
    one.joint = hypotheses[h].joint_name();
    one.unit =
        effect_unit(hypotheses[h].kind().amplitudes.front().unit, hypotheses[h].joint, context.robot.description());
    one.gain_alone = found.before.scores[h].gain;
    one.p_alone = found.null.hypotheses.p_value(h, one.gain_alone);
    one.gain_left = found.after.scores[h].gain;
    one.p_left = found.null.hypotheses.p_value(h, one.gain_left);
    const double threshold = std::max(
        material,
        found.null.hypotheses[h].quantile(context.options.false_naming_rate / static_cast<double>(hypotheses.size())));
    double strongest = 0;
    for (const MatrixXd& gram : found.before.signatures[h].gram) strongest = std::max(strongest, gram(0, 0));
    one.detectable = strongest > 0 ? std::sqrt(threshold / strongest) : std::numeric_limits<double>::infinity();
    out.considered.push_back(std::move(one));
  }
  what_the_logs_show(context, found, out.considered);
  for (std::size_t h = 0; h < hypotheses.size(); ++h) rule_on(context, found, h, out.considered[h]);
}

}  // namespace deltadyn::detail
