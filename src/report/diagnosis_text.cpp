#include "deltadyn/report/diagnosis_text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "drive_names.hpp"

namespace deltadyn {

namespace {

constexpr double kWorthAWord = 1.05;    // rms over floor of a drive, from which structure that is left is mentioned
constexpr double kParametersOff = 1.2;  // rms of the given parameters over that of the fitted ones
constexpr double kAlikeTorques = 0.5;   // |cosine| from which it is what makes two effects hard to tell apart
constexpr double kOrdered = 0.002;      // chance on clean logs below which what is left is not noise

std::string size_text(const NamedEffect& one, const Robot& robot) {
  const EffectKind& kind = effect_kind(one.effect.id);
  std::string text;
  for (std::size_t k = 0; k < kind.amplitudes.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const double std = one.effect.amplitude_std.size() > at ? one.effect.amplitude_std(at) : 0.0;
    text += fmt::format("{}{} {:.4g} +- {:.2g} {} (95 %)", text.empty() ? "" : ", ", kind.amplitudes[k].name,
                        one.effect.amplitude(at), 1.96 * std,
                        effect_unit(kind.amplitudes[k].unit, one.effect.joint, robot.description()));
  }
  return text;
}

/// "drive 1, follows speed and load"
std::string follows_text(const Diagnosis& d, int drive) {
  std::string text = fmt::format("drive {}", drive + 1);
  const auto& follows = d.drives[static_cast<std::size_t>(drive)].follows;
  if (!follows.empty()) text += ", follows " + follows[0].first;
  if (follows.size() > 1 && follows[1].second > 0.5) text += " and " + follows[1].first;
  return text;
}

/// Where more is left than noise; empty where nothing is.
std::string structure_left_text(const Robot& robot, const Diagnosis& d) {
  for (std::size_t j = 0; j < d.drives.size(); ++j) {
    const DriveFit& drive = d.drives[j];
    if (drive.p_left >= kOrdered || drive.rms_after < kWorthAWord * drive.floor) continue;
    return fmt::format(
        "of drive {} {:.3g} {} are left where noise alone leaves {:.3g}, but no effect of the catalogue explains that "
        "on every log",
        j + 1, drive.rms_after, units_of(robot, static_cast<int>(j)).torque, drive.floor);
  }
  return "";
}

/// A user's own parameters can be off although nothing is missing: the search fits them anew.
void say_parameters_are_off(const Robot& robot, const Diagnosis& d, DiagnosisText& out) {
  for (std::size_t j = 0; j < d.drives.size(); ++j) {
    const DriveFit& drive = d.drives[j];
    if (!(drive.rms_given > kParametersOff * drive.rms)) continue;
    const char* unit = units_of(robot, static_cast<int>(j)).torque;
    out.lines.push_back(fmt::format(
        "But the parameters are off: at drive {} they leave {:.3g} {} of these logs, fitted anew {:.3g} {}.", j + 1,
        drive.rms_given, unit, drive.rms, unit));
    out.next.insert(out.next.begin(), "Fit the parameters to these logs with delta-identify before you use the model.");
    return;
  }
}

void say_open_course(const Robot& robot, const Diagnosis& d, const Remark& remark, DiagnosisText& out) {
  std::string why;
  switch (remark.kind) {
    case Remark::Kind::course_unsure:
      why = fmt::format("with an uncertainty of {:.0f} % of its size", 100 * remark.other);
      break;
    case Remark::Kind::course_missed_beyond:
      why = fmt::format("but closes {:.0f} % of the gap on the faster hold-out log only", 100 * remark.other);
      break;
    case Remark::Kind::course_is_a_power: why = "but as a power of the rate, which never ends"; break;
    default:
      why = fmt::format("but the logs end at {:.2g} times the rate of the bend, before it is over", remark.other);
  }
  out.lines.push_back(
      fmt::format("{} fits, {}: as a term of the model it would be a guess{}.", remark.who, why,
                  d.named.empty() ? "" : ", and is left out of it (the figures before and after still hold it)"));
  out.next.push_back(fmt::format("Record drive {} at {:.2g} {} or more, too, and give that log beside the slow one.",
                                 remark.drive + 1, remark.value, units_of(robot, remark.drive).velocity));
}

std::string percent(double share) {
  return fmt::format("{:.0f} %", 100 * share);
}

/// Of a remark that is a note.
std::string note_text(const Remark& r) {
  using Kind = Remark::Kind;
  switch (r.kind) {
    case Kind::periods_not_averaged: return "periods are not averaged here: every log is used as it is";
    case Kind::bristle_left_out:
      return fmt::format("rows near reversals of drive {} do not follow the known build-up of its friction: left out",
                         r.drive + 1);
    case Kind::rest_is_not_coulomb:
      return fmt::format(
          "{}: friction near rest (below {:.2g} of its rate) is not Coulomb's; allowed for, not counted as an effect",
          r.who, r.value);
    case Kind::about_a_sample:
      return fmt::format(
          "torque and positions of {} are {:.2g} ms apart, at most about one sample: allowed for in the "
          "search, not counted as an effect",
          r.who, 1e3 * r.value);
    case Kind::not_on_holdout: return r.who + " fits the training logs, but not the hold-out log: a trace, not named";
    case Kind::may_be_nothing: return r.who + " fits, but its size may be zero within its 95 % interval: not named";
    case Kind::resonance_in_band:
      return fmt::format(
          "{} fits, but its resonance of {:.2g} Hz would show as such in logs that are "
          "used up to {:.3g} Hz: not named",
          r.who, r.value, r.other);
    case Kind::no_holdout:
      return "no hold-out log: before and after are those of the training logs, which prove less (--holdout)";
    case Kind::not_identified: return "the consistent parameters of the improved model could not be fitted: " + r.who;
    default: return "";
  }
}

void say_remark(const Robot& robot, const Diagnosis& d, const Remark& r, DiagnosisText& out) {
  using Kind = Remark::Kind;
  const char* torque = r.drive >= 0 ? units_of(robot, r.drive).torque : "";
  switch (r.kind) {
    case Kind::trace_makes_worse:
    case Kind::contradicted:
      (r.kind == Kind::contradicted ? out.lines : out.notes)
          .push_back(
              fmt::format("{} fits the training logs, but {} on the hold-out log: it is not what is missing.", r.who,
                          r.value < 0 ? "makes the model worse" : "closes " + percent(r.value) + " of the gap only"));
      break;
    case Kind::explains_a_part:
      out.lines.push_back(fmt::format(
          "The best of the catalogue, {}, explains {} of the structure only; a name for the rest would be a guess.",
          r.who, percent(r.value)));
      break;
    case Kind::machine_changed:
      out.next.push_back(
          fmt::format("The hold-out log leaves {:.3g} {} at drive {} where the training logs leave {:.3g}: was "
                      "anything changed in between (load, hose, robot)?",
                      r.value, torque, r.drive + 1, r.other));
      break;
    case Kind::course_is_a_power:
    case Kind::course_ends_within:
    case Kind::course_unsure:
    case Kind::course_missed_beyond: say_open_course(robot, d, r, out); break;
    case Kind::refused:
      out.lines.push_back(
          fmt::format("{} would fit the training logs, but the model with it leaves {:.3g} {} of the hold-out log at "
                      "drive {} where "
                      "the model as given leaves {:.3g}: not named, not written.",
                      r.who, r.value, torque, r.drive + 1, r.other));
      break;
    case Kind::too_few_rows:
      out.lines.push_back(
          fmt::format("{} fits the training logs; the hold-out log has {} rows of drive {} away from "
                      "reversals, too few to bear it out.",
                      r.who, d.holdout_rows, d.place + 1));
      break;
    default: out.notes.push_back(note_text(r));
  }
}

void say_not_testable(const Robot& robot, const Diagnosis& d, DiagnosisText& out) {
  const bool held = std::ranges::any_of(d.traces, &DiagnosisTrace::holdout);
  switch (d.reason) {
    case VerdictReason::logs_too_short:
      out.headline =
          fmt::format("Not testable: {:.3g} s of log are too short to look for missing effects.", d.length_s);
      out.lines.emplace_back(
          "Too few samples are left beside velocity reversals to fit the model and still see what it misses.");
      out.next.push_back(fmt::format("Record about {:.0f} s or more in all, fast and slow, over the workspace.",
                                     std::ceil(d.needed_s.value_or(0))));
      return;
    case VerdictReason::course_open:
      out.headline = fmt::format(
          "Not testable: the friction of drive {} is no straight line at low speed, but these logs are too slow to "
          "tell "
          "its course at higher speeds.",
          d.place + 1);
      return;
    case VerdictReason::holdout_too_short:
      out.headline = "Not testable: the hold-out log is too short to bear out what the training logs show.";
      out.next.emplace_back("Give a longer hold-out log.");
      return;
    case VerdictReason::holdout_moves_elsewhere: {
      const DriveFit& drive = d.drives[static_cast<std::size_t>(d.place)];
      out.headline = fmt::format(
          "Not testable: {} misses the hold-out log ({:.3g} times its floor), but the training logs cannot show why.",
          place_text(robot, d), drive.rms_holdout / std::max(drive.floor_holdout, 1e-300));
      out.lines.emplace_back(
          "The hold-out log moves where the training logs did not: from these alone a name would be luck.");
      break;
    }
    default:
      out.headline =
          "Not testable: the motion does not even show all base parameters, so that an effect could hide behind them.";
  }
  out.next.emplace_back(held ? "Record training logs that cover the speeds, accelerations and poses of the hold-out "
                               "log, fast and slow."
                             : "Record a motion that excites the dynamics, fast and slow: delta-excite plans one.");
}

void say_names(const Robot& robot, const Diagnosis& d, DiagnosisText& out) {
  std::string names;
  for (const NamedEffect& one : d.named) {
    names += (names.empty() ? "" : " and ") + one.at_joint();
    const EffectKind& kind = effect_kind(one.effect.id);
    const std::string shape = effect_shape_text(one.effect, robot.description());
    out.lines.push_back(fmt::format("{}: {}. Size: {}{}.", one.at_joint(), kind.meaning, size_text(one, robot),
                                    shape.empty() ? "" : "; " + shape));
    if (!one.confusable.empty()) {
      std::string others;
      for (const EffectCandidate& other : one.confusable) others += (others.empty() ? "" : ", ") + other.at_joint();
      out.lines.push_back("These logs cannot tell it from " + others + ": " + set_text(one, one.confusable.front()) +
                          ".");
      out.next.push_back("To tell " + one.name + " from " + others +
                         ", record a motion that separates them: --plan-next FILE writes one.");
    }
    out.next.push_back(fmt::format("{}: {}.", one.name, kind.remedy));
  }
  out.headline =
      fmt::format("Missing: {}{}.", names,
                  d.verdict == DiagnosisVerdict::named ? "" : ", or an effect that these logs cannot tell from it");
  out.next.emplace_back(d.improved ? "Go on with the improved parameters and the effect file."
                                   : "Write the model with the effect by --params-out and --effects-out, and go on "
                                     "with it.");
}

}  // namespace

bool shows_gap(const Diagnosis& d) {
  return std::isfinite(d.gap_shrink) && d.gap_high - d.gap_low < 1;
}

std::string gap_text(const Diagnosis& d) {
  if (!std::isfinite(d.gap_shrink)) return "";
  if (!shows_gap(d))
    return "In the rows of the hold-out log that the search uses the gap between the fitted model and the noise floor "
           "is too small to say how much of it is closed.";
  return fmt::format(
      "On the hold-out log, in the rows that the search uses, {:.1f} % of the gap between the fitted "
      "model and the noise floor is closed (95 % interval {:.1f} to {:.1f} %).",
      100 * d.gap_shrink, 100 * d.gap_low, 100 * d.gap_high);
}

std::string region_text(const Robot& robot, const NamedEffect& one) {
  if (one.drives.empty()) return "";
  std::string names;
  for (const int j : one.drives) names += (names.empty() ? "drive " : ", ") + std::to_string(j + 1);
  return fmt::format("{}; 80 % of it at {:.3g} to {:.3g} {} of drive {}", names, one.low_rate, one.high_rate,
                     units_of(robot, one.drives.front()).velocity, one.drives.front() + 1);
}

std::string place_text(const Robot& robot, const Diagnosis& d) {
  if (d.place < 0 || d.drives.empty()) return "";
  if (d.reason == VerdictReason::holdout_moves_elsewhere) return fmt::format("drive {}", d.place + 1);
  if (d.reason != VerdictReason::slow_torque) return follows_text(d, d.place);
  return fmt::format("drive {}, a slow torque of {:.3g} {} rms that the motion does not explain", d.place + 1,
                     d.drives[static_cast<std::size_t>(d.place)].rms_after, units_of(robot, d.place).torque);
}

std::string ruling_text(const ConsideredEffect& one) {
  switch (one.ruling) {
    case Ruling::no_evidence: return "no evidence";
    case Ruling::found: return "found";
    case Ruling::about_a_sample: return "about a sample: corrected";
    case Ruling::like_another: return "cannot be told from " + one.other;
    case Ruling::absorbed: return "these motions cannot show it: a re-fit of the parameters absorbs it";
    case Ruling::left_by_form: return "a trace too small to matter, or what the named effect's form leaves";
    case Ruling::beside_nothing:
      return fmt::format("ruled out: alone {:.3g} % of what {} explains, beside it nothing", 100 * one.other_share,
                         one.other);
    case Ruling::trace: return "a trace, too small to matter";
    case Ruling::wrong_sign: return "ruled out: it would need the wrong sign";
    case Ruling::not_confirmed: return "fits, but is not confirmed";
    case Ruling::holdout_denies: return "fits, but the hold-out log does not bear it out";
  }
  return "";
}

std::string set_text(const NamedEffect& named, const EffectCandidate& other) {
  if (other.objection == Objection::no_better_with_more_parameters)
    return "it does not predict the hold-out log better, with more parameters";
  return fmt::format("it explains {:.1f} % of what {} explains; ", 100 * other.gain_share, named.name) +
         (other.alike > kAlikeTorques
              ? fmt::format("in these motions their torques are alike to {:.1f} %", 100 * other.alike)
              : "their torques differ, and each fits nearly as well");
}

std::string objection_text(const EffectCandidate& one) {
  switch (one.objection) {
    case Objection::none: return "";
    case Objection::explains_too_little: return "it does not explain enough";
    case Objection::holdout_denies: return "the hold-out log does not confirm it";
    case Objection::no_better_with_more_parameters: return "it does no better, with more parameters";
  }
  return "";
}

DiagnosisText diagnosis_text(const Robot& robot, const Diagnosis& d) {
  DiagnosisText out;
  for (const Remark& remark : d.remarks) say_remark(robot, d, remark, out);
  switch (d.verdict) {
    case DiagnosisVerdict::nothing_missing: {
      const std::string left = structure_left_text(robot, d);
      out.headline = left.empty() ? "Nothing is missing: what the model leaves is noise as far as these logs can show."
                                  : "Nothing is named: " + left + ".";
      out.next.emplace_back(
          "Use the model. The table of all effects says how large each would have to be to show in these logs.");
      say_parameters_are_off(robot, d, out);
      break;
    }
    case DiagnosisVerdict::not_testable: say_not_testable(robot, d, out); break;
    case DiagnosisVerdict::unknown_structure:
      out.headline = "Something is missing that no effect of the catalogue explains: " + place_text(robot, d) + ".";
      out.next.emplace_back(
          "Look at the maps of the residual: which coordinate does it follow? Check the machine at that place.");
      out.next.emplace_back("Repeat the motion once: a residual that does not repeat is no property of the robot.");
      break;
    case DiagnosisVerdict::named:
    case DiagnosisVerdict::confusable: say_names(robot, d, out);
  }
  return out;
}

}  // namespace deltadyn
