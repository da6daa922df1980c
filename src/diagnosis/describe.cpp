#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "diagnosis_steps.hpp"

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

std::string ruling_of(const SearchContext& context, const SearchResult& found, std::size_t h,
                      const ConsideredEffect& one) {
  for (std::size_t k = 0; k < found.fits.size(); ++k) {
    if (found.fits[k].hypothesis == h) return found.fits[k].hygiene ? "about a sample: corrected" : kFound;
    if (std::ranges::any_of(found.sets[k], [&](const EffectCandidate& other) { return is_of(one, other); }))
      return kLikeAnother + std::string(effect_kind(found.fits[k].effect.id).name);
  }
  if (one.kept < kHidden) return "these motions cannot show it: a re-fit of the parameters absorbs it";
  const double alpha = context.options.false_naming_rate;
  if (one.p_left <= alpha) return "a trace too small to matter, or what the named effect's form leaves";
  if (one.p_alone <= alpha && !found.fits.empty()) {
    const Fit& first = *std::ranges::max_element(found.fits, {}, &Fit::gain);
    return fmt::format("ruled out: alone {:.3g} % of what {} explains, beside it nothing",
                       100 * one.gain_alone / first.gain, effect_kind(first.effect.id).name);
  }
  if (one.p_alone <= alpha) return "a trace, too small to matter";
  if (found.before.scores[h].gain <= 0 && effect_kind(context.search.hypotheses()[h].id).amplitudes.front().positive())
    return "ruled out: it would need the wrong sign";
  return "no evidence";
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

bool is_of(const ConsideredEffect& one, const EffectCandidate& candidate) {
  return one.name == candidate.name && one.joint == candidate.joint;
}

void settle_rulings(Diagnosis& out) {
  if (!gives_a_name(out.verdict)) return;
  for (ConsideredEffect& one : out.considered) {
    const auto same = [&](const EffectCandidate& other) { return is_of(one, other); };
    const auto set = std::ranges::find_if(
        out.named, [&](const NamedEffect& named) { return std::ranges::any_of(named.confusable, same); });
    if (std::ranges::any_of(out.named, same)) {
      one.ruling = kFound;
    } else if (set != out.named.end()) {
      one.ruling = kLikeAnother + set->name;
    } else if (one.ruling == kFound || one.ruling.starts_with(kLikeAnother)) {
      one.ruling = "fits, but is not confirmed";
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

void say_too_short(double length_s, double needed_s, Diagnosis& out) {
  out.verdict = DiagnosisVerdict::not_testable;
  out.needed_s = needed_s;
  out.headline = fmt::format("Not testable: {:.3g} s of log are too short to look for missing effects.", length_s);
  out.lines.push_back(
      "Too few samples are left beside velocity reversals to fit the model and still see what it misses.");
  out.next.push_back(
      fmt::format("Record about {:.0f} s or more in all, fast and slow, over the workspace.", std::ceil(needed_s)));
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

  const auto& hypotheses = context.search.hypotheses();
  const double material = kMaterial * rows_per_drive(context, *found.before.problem);
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    ConsideredEffect one;
    one.name = hypotheses[h].name();
    one.effect_class = effect_class_name(hypotheses[h].kind().effect_class);
    one.joint = hypotheses[h].joint_name();
    one.unit =
        effect_unit(hypotheses[h].kind().amplitudes.front().unit, hypotheses[h].joint, context.robot.description());
    one.gain_alone = found.before.scores[h].gain;
    one.p_alone = found.null.family_p(h, one.gain_alone);
    one.gain_left = found.after.scores[h].gain;
    one.p_left = found.null.family_p(h, one.gain_left);
    const double threshold = std::max(
        material,
        found.null.hypothesis[h].quantile(context.options.false_naming_rate / static_cast<double>(hypotheses.size())));
    double strongest = 0;
    for (const MatrixXd& gram : found.before.signatures[h].gram) strongest = std::max(strongest, gram(0, 0));
    one.detectable = strongest > 0 ? std::sqrt(threshold / strongest) : std::numeric_limits<double>::infinity();
    out.considered.push_back(std::move(one));
  }
  what_the_logs_show(context, found, out.considered);
  for (std::size_t h = 0; h < hypotheses.size(); ++h)
    out.considered[h].ruling = ruling_of(context, found, h, out.considered[h]);
}

}  // namespace deltadyn::detail
