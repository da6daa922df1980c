#include "deltadyn/report/assessment.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/model/inertial_parameters.hpp"
#include "deltadyn/report/format.hpp"
#include "deltadyn/runtime/dense.hpp"

#include "assessment_limits.hpp"
#include "assessment_parts.hpp"
#include "drive_figures.hpp"
#include "drive_names.hpp"

namespace deltadyn {

std::vector<Visibility> parameter_visibility(const BaseParameters& base) {
  constexpr double kZero = 1e-6;  // B is exact to rounding times its condition
  const Eigen::Index parameters = base.B.cols();
  std::vector<Visibility> out(static_cast<std::size_t>(parameters), Visibility::hidden);
  const Eigen::MatrixXd Q = dense::q_factor(base.B.transpose());
  const double largest = base.B.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < parameters; ++i) {
    if (base.B.col(i).cwiseAbs().maxCoeff() < kZero * largest) continue;
    // Seen alone: the unit vector lies in the row space of B.
    const double outside = 1.0 - Q.row(i).squaredNorm();
    out[static_cast<std::size_t>(i)] = outside < kZero ? Visibility::alone : Visibility::combined;
  }
  return out;
}

Source source_of(double data_share) {
  if (data_share >= kDataDecides) return Source::data;
  return data_share >= kPriorDecides ? Source::both : Source::prior;
}

namespace {

/// What would show a parameter to the drives.
std::string motion_advice(const ParameterId& id) {
  const std::string owner = owner_in_words(id);
  switch (id.kind) {
    case ParameterKind::viscous: return "record longer stretches at high speed of " + owner;
    case ParameterKind::coulomb: return "record slow stretches of " + owner + " in both directions";
    case ParameterKind::rotor_inertia:
      return "take it from the data sheet of the motor, or record stronger accelerations of " + owner;
    case ParameterKind::offset: return "record " + owner + " at the same positions in both directions";
    default: return "record stronger accelerations and wider motions that move the " + owner;
  }
}

}  // namespace

bool held_by_prior(const ConsistentFitSummary& fit, Eigen::Index i) {
  const double moved = std::abs(fit.p(i) - fit.prior(i));
  return moved <= kHeldByPrior * fit.std(i) && moved <= kPoorlySeen * std::abs(fit.prior(i));
}

DecidedBy decided_by(const ConsistentFitSummary& fit, Visibility visibility, Eigen::Index i) {
  const Source source = source_of(fit.data_share(i));
  const bool sums = visibility == Visibility::combined, vague = fit.std(i) > kPoorlySeen * std::abs(fit.p(i));
  if (source == Source::prior) {
    if (held_by_prior(fit, i)) return DecidedBy::prior;
    return sums ? DecidedBy::sums : DecidedBy::neither;
  }
  if (sums && vague) return DecidedBy::sums;
  return source == Source::data ? DecidedBy::data : DecidedBy::both;
}

bool is_measured(const ConsistentFitSummary& fit, Visibility visibility, Eigen::Index i) {
  return decided_by(fit, visibility, i) == DecidedBy::data && fit.std(i) <= kWellSeen * std::abs(fit.p(i));
}

std::vector<PriorGap> prior_gaps(const ConsistentFitSummary& fit, const BaseParameters& base,
                                 const Eigen::VectorXd& effect) {
  const std::vector<Visibility> visibility = parameter_visibility(base);
  std::vector<PriorGap> gaps;
  struct Missing {
    bool mass = false, centre = false, inertia = false;
  };
  std::vector<Missing> missing;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const double share = fit.data_share(static_cast<Eigen::Index>(i));
    if (!fit.fitted[i] || visibility[i] == Visibility::hidden || source_of(share) != Source::prior) continue;
    const ParameterId& id = fit.parameters[i];
    const double acts = effect(static_cast<Eigen::Index>(i));
    const bool alone = visibility[i] == Visibility::alone, negligible = alone && acts < kNegligibleEffect,
               by_motion = alone && !negligible;
    auto found = std::find_if(gaps.begin(), gaps.end(), [&](const PriorGap& gap) {
      return gap.first.same_owner(id) && gap.by_motion == by_motion && gap.negligible == negligible;
    });
    if (found == gaps.end()) {
      gaps.push_back({id, share, {}, by_motion, negligible, by_motion ? motion_advice(id) : ""});
      missing.emplace_back();
      found = gaps.end() - 1;
    }
    found->parameters.push_back(fmt::format("{} ({:.0f} %)", quantity_name(id), 100 * share));
    Missing& what = missing[static_cast<std::size_t>(found - gaps.begin())];
    if (id.kind != ParameterKind::inertial) continue;
    what.mass |= id.entry == inertial::kM;
    what.centre |= id.entry >= inertial::kMcx && id.entry <= inertial::kMcz;
    what.inertia |= id.entry >= inertial::kIxx;
  }
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    if (gaps[k].by_motion) continue;
    if (gaps[k].negligible) {
      gaps[k].advice =
          fmt::format("nothing: it makes less than {} of any drive's torque", format_percent(kNegligibleEffect, 1));
      continue;
    }
    const Missing& what = missing[k];
    std::vector<std::string> steps;
    if (what.mass) steps.push_back("weigh the " + owner_in_words(gaps[k].first));
    if (what.centre)
      steps.emplace_back(what.mass ? "balance it on an edge for its centre of mass"
                                   : "find its centre of mass (balance it on an edge, or CAD)");
    if (what.inertia) steps.emplace_back("take its moments of inertia from CAD or a swing test");
    gaps[k].advice = steps.empty() ? "take it from the data sheet" : join_words(steps);
  }
  return gaps;
}

IdentificationEvidence gather_evidence(const Robot& robot, const Identification& identification,
                                       const Validation& training) {
  IdentificationEvidence evidence;
  evidence.structure = structure_left(training);
  for (const ValidatedDrive& drive : training.drives) evidence.torque_noise.push_back(drive.torque_noise);
  const BaseEstimate& estimate = identification.base_estimate;
  evidence.on_logs =
      torque_uncertainty_on_logs(robot, identification.base, estimate.covariance, identification.fit.p, training);
  evidence.in_workspace =
      torque_uncertainty_in_workspace(robot, identification.base, estimate.covariance, identification.fit.p);
  evidence.parameter_effect = parameter_effect(robot, identification.fit.p);
  return evidence;
}

// ---- parts that both judgements share -------------------------------------------------------------------------------

Verdict grade(double value, double good, double usable) {
  if (!(value > good)) return std::isnan(value) ? Verdict::bad : Verdict::good;
  return value <= usable ? Verdict::caution : Verdict::bad;
}

Verdict grade_residual(double relative) {
  return grade(relative, kGoodResidual, kUsableResidual);
}

KeyFigure residual_figure(const Robot& robot, int drive, double rms, double relative) {
  return {"residual, " + drive_name(drive), format_number(rms, units_of(robot, drive).torque, 3),
          fmt::format("{} of the {}", format_percent(relative, 2), units_of(robot, drive).effort),
          tone_of(grade_residual(relative))};
}

Check check_residual_size(const Robot& robot, const std::vector<DriveFigures>& drives) {
  std::size_t worst = 0;
  for (std::size_t j = 1; j < drives.size(); ++j) {
    if (drives[j].relative() > drives[worst].relative()) worst = j;
  }
  const double relative = drives.empty() ? 0.0 : drives[worst].relative();
  const auto drive = static_cast<int>(worst);
  Check check{"Size of the residual", "", grade_residual(relative), ""};
  check.figure = fmt::format("{} of the rms {} ({})", format_percent(relative, 2), units_of(robot, drive).effort,
                             drive_name(drive));
  const double noise = drives.empty() ? 0.0 : drives[worst].torque_noise;
  if (check.verdict == Verdict::bad && drives[worst].rms < kNoiseOfRecord * noise) {
    check.verdict = Verdict::caution;
    check.meaning = fmt::format(
        "The torque record itself has noise of {} rms in these rows: what the model lacks may hide in it. Trust "
        "parameters as far as their intervals say, and record the torque faster or through a low pass.",
        format_number(noise, units_of(robot, drive).torque, 3));
    return check;
  }
  switch (check.verdict) {
    case Verdict::good: check.meaning = "Small: as feed-forward the model leaves little to the feedback loop."; break;
    case Verdict::caution:
      check.meaning =
          "Usable as feed-forward, but not for forces estimated from the drive currents. The report shows what the "
          "residual follows.";
      break;
    case Verdict::bad:
      check.meaning =
          "Too large to be measurement noise. Check the lengths in the robot file, the signs and units of the torques, "
          "the gear ratios, and that position and torque belong to the same instant.";
      break;
  }
  return check;
}

std::string worst_dependence(const ResidualStructure& structure, DependenceOnMotion& found) {
  const std::pair<const char*, const DependenceOnMotion*> all[] = {{"velocity", &structure.on_velocity},
                                                                   {"position", &structure.on_position},
                                                                   {"acceleration", &structure.on_acceleration}};
  std::string name;
  for (const auto& [coordinate, dependence] : all) {
    if (dependence->p_value > kRareByChance || dependence->share < kNotableShare) continue;
    if (name.empty() || dependence->share > found.share) {
      name = coordinate;
      found = *dependence;
    }
  }
  return name;
}

std::string meaning_of_dependence(const std::string& coordinate) {
  if (coordinate == "velocity")
    return "friction there is more than Coulomb and viscous (Stribeck, a load-dependent part, a gear)";
  if (coordinate == "position")
    return "a spring, a cable, an unbalance or a wrong length acts there, or the gear has a ripple";
  if (coordinate == "time")
    return "other drives, the temperature, the pose of the plate or a slow sensor may be behind it; see its spectrum";
  return "inertia is missing there (a rotor), or torque and position are not of the same instant (a lag)";
}

bool worth_acting_on(const StructureLeft& structure) {
  return structure.of_torque > kRelevantStructure || structure.of_torque_there > kGoodResidual;
}

std::string structure_in_words(const StructureLeft& structure) {
  const std::string what = structure.coordinate == "time" ? "slow waves that follow none of its coordinates"
                                                          : "following its " + structure.coordinate;
  std::string text = fmt::format("structure is left in the residual of {} ({}), {}: {} of the torque in this log",
                                 drive_name(structure.drive), short_name(structure.file), what,
                                 format_percent(structure.of_torque, 2));
  if (structure.of_torque_there > 0) {
    text += fmt::format(", at speeds of {} to {} (SI) {} of the torque there", format_number(structure.speed_low, 2),
                        format_number(structure.speed_high, 2), format_percent(structure.of_torque_there, 2));
  }
  if (!worth_acting_on(structure)) text += "; small: delta-diagnose may name it, the model can do without";
  return text;
}

Check check_residual_shape(const std::optional<StructureLeft>& structure) {
  Check check{"Shape of the residual", "like noise", Verdict::good, ""};
  if (!structure) {
    check.meaning =
        "It follows neither position, velocity nor acceleration: the model lacks nothing that these logs could show.";
    return check;
  }
  const std::string drive = drive_name(structure->drive), log = short_name(structure->file);
  check.figure = structure->coordinate == "time"
                     ? fmt::format("slow waves in {} ({})", drive, log)
                     : fmt::format("{} of it follows the {} of {} ({})", format_percent(structure->share, 2),
                                   structure->coordinate, drive, log);
  check.verdict = worth_acting_on(*structure) ? Verdict::caution : Verdict::good;
  check.meaning = structure_in_words(*structure) + ". Behind it: " + meaning_of_dependence(structure->coordinate) + ".";
  check.meaning.front() = 'S';
  return check;
}

Check check_reversals(const std::vector<DriveFigures>& drives) {
  Check check{"Velocity reversals", "no worse than elsewhere", Verdict::good,
              "Coulomb friction describes the reversals well enough."};
  std::vector<std::string> worse, used;
  double ratio = 1, masked = 0;
  bool bristles = !drives.empty();
  for (std::size_t j = 0; j < drives.size(); ++j) {
    const DriveFigures& drive = drives[j];
    masked = std::max(masked, drive.masked_share);
    bristles = bristles && drive.bristles;
    // A few rows about the start of a log, where nobody knows the state of the friction, are no matter.
    if (drive.reversal_ratio < kOtherLaw || (drive.masked_share > 0 && drive.masked_share < kNoMatterMasked)) continue;
    (drive.masked_share > 0 ? worse : used).push_back(drive_name(static_cast<int>(j)));
    ratio = std::max(ratio, drive.reversal_ratio);
  }
  const auto larger = [ratio](const std::vector<std::string>& who) {
    return fmt::format("residual there up to {:.1f} times that elsewhere ({})", ratio, join_words(who));
  };
  if (!worse.empty()) {
    check.figure = larger(worse);
    check.meaning =
        "Friction near standstill that does not follow Coulomb's law, or what is missing in another drive and shows in "
        "these rows only. They are left out of all other figures; in the first instants after a reversal the model's "
        "torque is off by that much more.";
  } else if (!used.empty()) {
    check.figure = larger(used);
    check.meaning =
        "These rows are used all the same (--reversals keep) and pull at the friction: compare with --reversals auto.";
  } else if (masked >= kNoMatterMasked) {
    check.figure = fmt::format("left out, at most {} of a drive's rows", format_percent(masked, 2));
    check.meaning =
        "The sign of the velocity is uncertain there. The model predicts these rows about as well as the others.";
  } else if (bristles) {
    check.figure = "rows there are used";
    check.meaning = "The model holds how friction builds up after a reversal.";
  }
  if (masked > kFewMasked) {
    check.verdict = Verdict::caution;
    if (!worse.empty()) check.figure += fmt::format("; {} of a drive's rows are left out", format_percent(masked, 2));
    check.meaning +=
        " The logs reverse so often that they say little about slow motion: record one with longer strokes.";
  }
  return check;
}

const Check& worst_of(const std::vector<Check>& checks) {
  return *std::ranges::max_element(checks, {}, &Check::verdict);
}

std::vector<std::string> Assessment::told() const {
  std::vector<std::string> out = lines;
  // A result that is not to be trusted has measured nothing.
  if (verdict != Verdict::bad && !measured.empty()) out.insert(out.begin(), measured);
  return out;
}

void conclude(const Headlines& headlines, Assessment& out) {
  const Check& worst = worst_of(out.checks);
  out.verdict = worst.verdict;
  std::string subject = worst.subject;
  subject[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(subject[0])));
  out.headline = out.verdict == Verdict::good
                     ? headlines.good
                     : fmt::format("{}: {} ({}).", out.verdict == Verdict::bad ? headlines.bad : headlines.caution,
                                   subject, worst.figure);
  for (const Verdict level : {Verdict::bad, Verdict::caution}) {
    for (const Check& check : out.checks) {
      if (check.verdict == level)
        out.lines.push_back(fmt::format("{}: {}. {}", check.subject, check.figure, check.meaning));
    }
  }
}

void remark_on_rest(const Check& shape, const Check& reversals, Assessment& out) {
  if (shape.verdict == Verdict::good) {
    out.lines.emplace_back(shape.figure == "like noise" ? "What the model leaves over looks like measurement noise."
                                                        : fmt::format("Residual: {}. {}", shape.figure, shape.meaning));
  }
  if (reversals.verdict == Verdict::good && reversals.figure.starts_with("residual there")) {
    out.lines.push_back(fmt::format("Near velocity reversals: {}. {}", reversals.figure, reversals.meaning));
  }
}

}  // namespace deltadyn
