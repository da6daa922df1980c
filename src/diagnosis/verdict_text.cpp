#include <fmt/format.h>

#include "diagnosis_steps.hpp"

namespace deltadyn::detail {

namespace {

constexpr double kLeftOver = 1.05;      // rms over floor from which structure that is left is worth a word
constexpr double kParametersOff = 1.2;  // rms of the given parameters over that of the fitted ones

std::string amplitude_text(const NamedEffect& one, const RobotDescription& robot) {
  const EffectKind& kind = effect_kind(one.effect.id);
  std::string text;
  for (std::size_t k = 0; k < kind.amplitudes.size(); ++k) {
    const auto at = static_cast<Index>(k);
    const double std = one.effect.amplitude_std.size() > at ? one.effect.amplitude_std(at) : 0.0;
    text += fmt::format("{}{} {:.4g} +- {:.2g} {} (95 %)", text.empty() ? "" : ", ", kind.amplitudes[k].name,
                        one.effect.amplitude(at), 1.96 * std,
                        effect_unit(kind.amplitudes[k].unit, one.effect.joint, robot));
  }
  return text;
}

/// A user's own parameters can be off although nothing is missing: the search fits them anew.
void say_parameters_are_off(const SearchContext& context, Diagnosis& out) {
  for (std::size_t j = 0; j < out.drives.size(); ++j) {
    const DriveFit& drive = out.drives[j];
    if (!(drive.rms_given > kParametersOff * drive.rms)) continue;
    const char* unit = unit_of_drive(context.robot, static_cast<int>(j));
    out.lines.push_back(fmt::format(
        "But the parameters are off: at drive {} they leave {:.3g} {} of these logs, fitted anew {:.3g} {}.", j + 1,
        drive.rms_given, unit, drive.rms, unit));
    out.next.insert(out.next.begin(), "Fit the parameters to these logs with delta-identify before you use the model.");
    return;
  }
}

/// Where more is left than noise, in words; empty where nothing is.
std::string structure_left(const SearchContext& context, const Diagnosis& out) {
  for (std::size_t j = 0; j < out.drives.size(); ++j) {
    const DriveFit& drive = out.drives[j];
    if (drive.p_left >= kStructureChance || drive.rms_after < kLeftOver * drive.floor) continue;
    return fmt::format(
        "of drive {} {:.3g} {} are left where noise alone leaves {:.3g}, but no effect of the catalogue explains that "
        "on every log",
        j + 1, drive.rms_after, unit_of_drive(context.robot, static_cast<int>(j)), drive.floor);
  }
  return "";
}

/// Squares of the hold-out residual beside the names, each drive in units of `scale`'s residual without them.
double left_of_holdout(const Diagnosis& diagnosis, const Diagnosis& scale) {
  double sum = 0;
  for (std::size_t j = 0; j < diagnosis.holdout_figures.size(); ++j) {
    const double given = scale.holdout_figures[j].rms_given, written = diagnosis.holdout_figures[j].rms_written;
    if (given > 0) sum += written * written / (given * given);
  }
  return sum;
}

}  // namespace

bool turns(const Robot& robot, int drive) {
  return robot.description().kind_of_drive(drive) == DriveKind::revolute;
}

const char* unit_of_drive(const Robot& robot, int drive) {
  return turns(robot, drive) ? "N m" : "N";
}

void say(const SearchContext& context, Diagnosis& out) {
  const RobotDescription& robot = context.robot.description();
  switch (out.verdict) {
    case DiagnosisVerdict::nothing_missing:
      out.headline = structure_left(context, out).empty()
                         ? "Nothing is missing: what the model leaves is noise as far as these logs can show."
                         : "Nothing is named: " + structure_left(context, out) + ".";
      out.next.push_back(
          "Use the model. The table of all effects says how large each would have to be to show in these logs.");
      say_parameters_are_off(context, out);
      return;
    case DiagnosisVerdict::not_testable:
      if (!out.next.empty()) return;  // the judge knows what is wanted
      out.next.push_back(context.holdout != nullptr
                             ? "Record training logs that cover the speeds, accelerations and poses of the hold-out "
                               "log, fast and slow."
                             : "Record a motion that excites the dynamics, fast and slow: delta-excite plans one.");
      return;
    case DiagnosisVerdict::unknown_structure:
      out.headline = "Something is missing that no effect of the catalogue explains: " + out.region + ".";
      out.next.push_back(
          "Look at the maps of the residual: which coordinate does it follow? Check the machine at that place.");
      out.next.push_back("Repeat the motion once: a residual that does not repeat is no property of the robot.");
      return;
    default: break;
  }
  for (const NamedEffect& one : out.named) {
    const EffectKind& kind = effect_kind(one.effect.id);
    const std::string shape = effect_shape_text(one.effect, robot);
    out.lines.push_back(fmt::format("{}: {}. Size: {}{}.", one.at_joint(), kind.meaning, amplitude_text(one, robot),
                                    shape.empty() ? "" : "; " + shape));
    if (!one.confusable.empty()) {
      const std::string others = listed(one.confusable, ", ");
      out.lines.push_back("These logs cannot tell it from " + others + ": " + one.confusable.front().why + ".");
      out.next.push_back("To tell " + one.name + " from " + others +
                         ", record a motion that separates them: --plan-next FILE writes one.");
    }
    out.next.push_back(fmt::format("{}: {}.", one.name, kind.remedy));
  }
  out.headline =
      fmt::format("Missing: {}{}.", listed(out.named, " and "),
                  out.verdict == DiagnosisVerdict::named ? "" : ", or an effect that these logs cannot tell from it");
  out.next.push_back(context.options.identify
                         ? "Go on with the improved parameters and the effect file."
                         : "Write the model with the effect by --params-out and --effects-out, and go on with it.");
}

bool explains_more(const Diagnosis& one, const Diagnosis& other) {
  const bool name = gives_a_name(one.verdict), other_name = gives_a_name(other.verdict);
  if (!name || !other_name) return name && !other_name;
  const bool held = !one.holdout_figures.empty() && one.holdout_figures.size() == other.holdout_figures.size();
  if (held) return left_of_holdout(one, other) < left_of_holdout(other, other);
  return one.explained_share > other.explained_share;
}

}  // namespace deltadyn::detail
