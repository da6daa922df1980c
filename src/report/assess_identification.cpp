#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/model/inertial_parameters.hpp"
#include "deltadyn/report/format.hpp"

#include "assessment_limits.hpp"
#include "assessment_parts.hpp"
#include "drive_names.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;

std::vector<DriveFigures> figures_of(const Identification& identification, const std::vector<double>& torque_noise) {
  std::vector<DriveFigures> out;
  for (std::size_t j = 0; j < identification.drives.size(); ++j) {
    const DriveReport& drive = identification.drives[j];
    const auto rows = static_cast<double>(drive.rows + drive.masked_rows);
    out.push_back({drive.rms, drive.rms_torque, drive.reversal_ratio,
                   rows > 0 ? static_cast<double>(drive.masked_rows) / rows : 0.0,
                   out.size() < torque_noise.size() ? torque_noise[out.size()] : 0.0,
                   j < identification.presliding.size() && identification.presliding[j].displacement > 0});
  }
  return out;
}

/// A solver that stopped early or left a gap unproven may still have found what there is: the data then cannot tell its
/// parameters from the base parameters, which need no search.
void judge_unproven(const ConsistentFitSummary& fit, Check& check) {
  if (fit.agrees_with_least_squares()) {
    check.figure += ", but as good as the base parameters";
    check.meaning +=
        fmt::format(" χ² is above that of the base parameters by {}, which is no more than noise makes of it.",
                    format_number(std::max(fit.data_cost - fit.data_cost_free, 0.0), 2));
    return;
  }
  const bool slight = fit.converged && fit.certificate.gap < kNoiseInChiSquare;
  check.verdict = slight ? Verdict::caution : Verdict::bad;
}

Check check_solver(const ConsistentFitSummary& fit) {
  Check check{"Best possible fit", "", Verdict::good, ""};
  if (!fit.converged) {
    check.figure = "not converged";
    check.meaning =
        "The solver stopped before it was done: " + fit.message + ". Allow more iterations, or check the prior.";
    judge_unproven(fit, check);
  } else if (!fit.certificate.available) {
    check.figure = "converged, no proof";
    check.meaning =
        "This metric is not convex: a better set of parameters may exist. The metrics 'relative' and 'bregman' give a "
        "proof.";
  } else if (fit.certificate.passed) {
    check.figure = "proven";
    check.meaning = fmt::format(
        "No physically consistent parameters fit data and prior better by more than {} in χ² (a change of 1 would be "
        "within the noise).",
        format_number(std::max(fit.certificate.gap, 0.0), 2));
  } else {
    check.figure = "not proven";
    check.meaning = fmt::format(
        "Parameters that fit better by up to {} in χ² may exist (weakest at {}). Try the full parameter set or another "
        "prior.",
        format_number(fit.certificate.gap, 2), fit.certificate.min_dual_name);
    judge_unproven(fit, check);
  }
  return check;
}

Check check_consistency(const Identification& identification) {
  double ratio = 1;
  int drive = 0;
  for (std::size_t j = 0; j < identification.drives.size(); ++j) {
    const DriveReport& report = identification.drives[j];
    // Below this share of the torque a residual is the rounding of a noise-free log, and its rise means nothing.
    constexpr double kRounding = 1e-9;
    const bool counts = report.rms_base > 0 && report.rms > kRounding * report.rms_torque;
    const double r = counts ? report.rms / report.rms_base : 1.0;
    if (r > ratio) {
      ratio = r;
      drive = static_cast<int>(j);
    }
  }
  Check check{"Price of physical consistency", "", grade(ratio, kCheapConsistency, kDearConsistency), ""};
  check.figure =
      ratio - 1 < 5e-4 ? "none" : fmt::format("residual +{} ({})", format_percent(ratio - 1, 2), drive_name(drive));
  if (check.verdict != Verdict::good && identification.fit.agrees_with_least_squares()) {
    check.verdict = Verdict::good;
    check.meaning = "Free base parameters fit better by no more than the noise of torque and encoders makes of it.";
  } else if (check.verdict == Verdict::good) {
    check.meaning = "Parameters that a real machine can have explain the data as well as free base parameters do.";
  } else {
    check.meaning =
        "Free base parameters fit better than any that a real machine near the prior can have: look for a wrong "
        "length, a wrong prior with too much weight, or an effect that the model lacks.";
  }
  return check;
}

Check check_torque_knowledge(const Robot& robot, const IdentificationEvidence& evidence) {
  const TorqueUncertainty& known = evidence.in_workspace;
  Index worst = 0;
  (known.std.array() / known.rms_torque.array().max(1e-300)).maxCoeff(&worst);
  const double relative = known.worst_relative();
  Check check{"Torque on other motions", "", grade(relative, kWellKnownTorque, kKnownTorque), ""};
  // What was recorded is known: the model serves there, and says where it does not.
  if (check.verdict == Verdict::bad && evidence.on_logs.worst_relative() <= kWellKnownTorque)
    check.verdict = Verdict::caution;
  check.figure =
      fmt::format("± {} {} ({})", format_percent(1.96 * relative, 2), "at 95 %", drive_name(static_cast<int>(worst)));
  const std::string where = robot.description().parts.empty() ? "over the axis" : "over the whole workspace";
  if (check.verdict == Verdict::good) {
    check.meaning = fmt::format(
        "The uncertainty of the base parameters leaves the torque of fast motions {} this well known.", where);
  } else {
    check.meaning = fmt::format(
        "On the recorded logs the torque is known to ± {}, but not on fast motions {}: record a log that reaches "
        "further and accelerates harder, and trust the model only near the recorded motions.",
        format_percent(1.96 * evidence.on_logs.worst_relative(), 2), where);
  }
  return check;
}

Check check_excitation(const Identification& identification) {
  const double condition = identification.base_estimate.condition_number;
  const Eigen::VectorXd std = identification.base_estimate.std();
  Index poor = 0;
  for (Index k = 0; k < std.size(); ++k)
    poor += std(k) > kPoorlySeen * std::abs(identification.base_estimate.value(k)) ? 1 : 0;
  Check check{"Excitation by the logs", "", condition > kHighCondition ? Verdict::caution : Verdict::good, ""};
  check.figure =
      fmt::format("condition {}, {} of {} base parameters hardly seen", format_number(condition, 3), poor, std.size());
  if (condition <= kGoodCondition) {
    check.meaning = "The motion shows the base parameters well apart.";
  } else if (condition <= kHighCondition) {
    check.meaning =
        "The motion shows the base parameters, some only in sums; an optimised excitation would sharpen them.";
  } else {
    check.meaning =
        "The motion hardly tells some base parameters apart: record one that moves all drives, fast and slow, over the "
        "workspace.";
  }
  return check;
}

Check check_mass_matrix(const Robot& robot, const MassMatrixSurvey& survey) {
  const bool good = survey.positive_definite();
  const std::string count = format_count(survey.states);
  return {"Mass matrix",
          fmt::format("smallest eigenvalue {}", format_number(survey.min_eigenvalue, inertia_unit_of(robot), 3)),
          good ? Verdict::good : Verdict::bad,
          good ? fmt::format("Positive definite at all {} poses tried: the model can be simulated and inverted.", count)
               : fmt::format("Not positive definite at {} of {} poses: simulation and model-based control with it can "
                             "become unstable.",
                             format_count(survey.not_positive), count)};
}

Check check_prior(const ConsistentFitSummary& fit, const std::vector<Visibility>& visibility,
                  const std::vector<PriorGap>& gaps) {
  std::vector<DecidedBy> sources;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    if (fit.fitted[i]) sources.push_back(decided_by(fit, visibility[i], static_cast<Index>(i)));
  }
  const auto count = [&sources](DecidedBy source) { return std::ranges::count(sources, source); };
  const auto sums = count(DecidedBy::sums), prior = count(DecidedBy::prior), neither = count(DecidedBy::neither);
  const bool motion_lacks = std::ranges::any_of(gaps, &PriorGap::by_motion);
  Check check{"Data against prior", "", motion_lacks ? Verdict::caution : Verdict::good, ""};
  check.figure =
      fmt::format("{} of {} fitted parameters from the data, {} from both, {} known only in sums, {} from the prior",
                  count(DecidedBy::data), sources.size(), count(DecidedBy::both), sums, prior);
  if (neither > 0) check.figure += fmt::format(", {} from neither", neither);
  if (motion_lacks) {
    check.meaning = "Some parameters that a motion can show were not shown by these logs; the report names them.";
  } else if (prior + sums + neither > 0) {
    check.meaning =
        "All but the first act on the drives in sums with others, or hardly: the torque is right, the single values "
        "are not measured.";
  } else {
    check.meaning = "No value rests on the prior.";
  }
  return check;
}

/// Names of parameters that are measured, friction in one word where it is all there.
std::string trusted_values(const ConsistentFitSummary& fit, const std::vector<Visibility>& visibility) {
  const auto measured = [&](std::size_t i) {
    return fit.fitted[i] && is_measured(fit, visibility[i], static_cast<Index>(i));
  };

  std::vector<std::string> names;
  const auto& all = fit.parameters;
  std::size_t friction = 0, friction_from_data = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    friction += all[i].is_friction() ? 1 : 0;
    friction_from_data += all[i].is_friction() && measured(i) ? 1 : 0;
  }
  const bool all_friction = friction > 0 && friction == friction_from_data;
  if (all_friction) names.emplace_back("friction of all joints");
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (measured(i) && !(all_friction && all[i].is_friction())) names.push_back(parameter_name(all[i]));
  }
  constexpr std::size_t kNamed = 8;  // more do not fit a line; all stand in the table
  if (names.size() > kNamed) {
    const std::size_t others = names.size() - kNamed;
    names.resize(kNamed);
    names.push_back(fmt::format("{} more", others));
  }
  return join_words(names);
}

/// The gaps that are worth a place in the verdict: those that a motion can close, then bodies whose mass is from the
/// prior.
std::vector<std::string> urgent_gaps(const std::vector<PriorGap>& gaps) {
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> lines;
  for (const bool by_motion : {true, false}) {
    for (const PriorGap& gap : gaps) {
      if (gap.by_motion != by_motion || gap.negligible || lines.size() == kNamed) continue;
      if (!by_motion && (gap.first.kind != ParameterKind::inertial || gap.first.entry != inertial::kM)) continue;
      lines.push_back(fmt::format("{} {} (data share {:.0f} %): {}.", parameter_name(gap.first),
                                  by_motion ? "hardly shows in these logs" : "comes from the prior",
                                  100 * gap.first_share, gap.advice));
    }
  }
  return lines;
}

}  // namespace

Assessment assess_identification(const Robot& robot, const Identification& identification,
                                 const MassMatrixSurvey& survey, const IdentificationEvidence& evidence) {
  const std::vector<DriveFigures> drives = figures_of(identification, evidence.torque_noise);
  const std::vector<PriorGap> gaps = prior_gaps(identification.fit, identification.base, evidence.parameter_effect);
  const std::vector<Visibility> visibility = parameter_visibility(identification.base);
  Assessment out;
  out.structure = evidence.structure;
  const Check size = check_residual_size(robot, drives), shape = check_residual_shape(evidence.structure);
  out.checks = {size,
                shape,
                check_torque_knowledge(robot, evidence),
                check_mass_matrix(robot, survey),
                check_prior(identification.fit, visibility, gaps),
                check_consistency(identification),
                check_solver(identification.fit),
                check_excitation(identification),
                check_reversals(drives)};
  conclude({fmt::format("The model can be trusted on motions like the recorded ones: the residual is {}.", size.figure),
            "Usable with care", "Do not use this model yet"},
           out);
  const std::string trusted = trusted_values(identification.fit, visibility);
  if (!trusted.empty()) out.measured = "Measured by these logs: " + trusted + ".";
  const std::vector<std::string> urgent = urgent_gaps(gaps);
  out.lines.insert(out.lines.end(), urgent.begin(), urgent.end());
  remark_on_rest(shape, out.checks.back(), out);
  return out;
}

}  // namespace deltadyn
