#pragma once

#include <string>
#include <vector>

#include "deltadyn/report/assessment.hpp"

namespace deltadyn {

/// What both judgements need of one drive.
struct DriveFigures {
  double rms = 0;             ///< residual without rows near reversals [N m | N]
  double rms_torque = 0;      ///< over the same rows
  double reversal_ratio = 1;  ///< residual near reversals over that elsewhere
  double masked_share = 0;    ///< rows near reversals that were left out, of all
  double torque_noise = 0;    ///< white noise of the torque record, rms in the same rows
  bool bristles = false;      ///< the model holds how friction builds up after a reversal

  [[nodiscard]] double relative() const { return rms_torque > 0 ? rms / rms_torque : (rms > 0 ? 1.0 : 0.0); }
};

/// Good up to and including `good`, caution up to `usable`, else bad.
[[nodiscard]] Verdict grade(double value, double good, double usable);
/// Of a residual over the rms torque.
[[nodiscard]] Verdict grade_residual(double relative);
[[nodiscard]] Check check_residual_size(const Robot& robot, const std::vector<DriveFigures>& drives);
[[nodiscard]] Check check_residual_shape(const std::optional<StructureLeft>& structure);
[[nodiscard]] Check check_reversals(const std::vector<DriveFigures>& drives);
/// The first of the checks with the worst verdict.
[[nodiscard]] const Check& worst_of(const std::vector<Check>& checks);
/// The colour of a verdict in a report.
[[nodiscard]] inline Tone tone_of(Verdict verdict) {
  return verdict == Verdict::good ? Tone::good : verdict == Verdict::caution ? Tone::caution : Tone::bad;
}
/// Of a residual over the rms torque, for the top of a report.
[[nodiscard]] KeyFigure residual_figure(const Robot& robot, int drive, double rms, double relative);
/// How a headline begins.
struct Headlines {
  std::string good;     ///< the whole of it
  std::string caution;  ///< the check that asks for care follows
  std::string bad;      ///< the check that failed follows
};
/// Verdict, headline and a line for every check that is not good, from the checks in `out`.
void conclude(const Headlines& headlines, Assessment& out);
/// The last lines: what the checks of the residual's shape and of the reversals found, where that is no cause for care.
void remark_on_rest(const Check& shape, const Check& reversals, Assessment& out);

/// Coordinate that the residual follows most, empty if none.
[[nodiscard]] std::string worst_dependence(const ResidualStructure& structure, DependenceOnMotion& found);
/// What is behind a residual that follows "velocity", "position" or "acceleration".
[[nodiscard]] std::string meaning_of_dependence(const std::string& coordinate);

}  // namespace deltadyn
