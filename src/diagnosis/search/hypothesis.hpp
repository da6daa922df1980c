#pragma once

/// \file
/// What could be missing: every effect of the catalogue at every place of the robot, with the start values of its
/// shape.

#include <algorithm>
#include <string>
#include <vector>

#include "../evidence/log_rows.hpp"

namespace deltadyn {

/// One effect at one place.
struct Hypothesis {
  EffectId id;
  int joint;                      ///< drive from 0, or -1
  std::vector<VectorXd> shapes;   ///< start values, at least one (possibly without entries)
  Index amplitudes = 1;           ///< columns a shape
  double largest_torque = 1e300;  ///< of its joint in the logs [N m | N]: no force amplitude is larger

  [[nodiscard]] const EffectKind& kind() const { return effect_kind(id); }
  [[nodiscard]] std::string name() const { return std::string(kind().name); }
  [[nodiscard]] std::string joint_name() const { return effect_joint_name(id, joint); }
  /// Largest size of an amplitude that makes sense.
  [[nodiscard]] double largest(std::size_t amplitude) const {
    const AmplitudeTraits& one = kind().amplitudes[amplitude];
    return one.unit == "{F}" ? std::min(one.largest, largest_torque) : one.largest;
  }
  /// Parameters that a fit would spend on it.
  [[nodiscard]] int freedom() const {
    return static_cast<int>(amplitudes) + static_cast<int>(kind().shapes.size()) - (kind().tied ? 1 : 0);
  }
};

/// An effect with the shape that it has.
[[nodiscard]] Hypothesis hypothesis_of(const Effect& effect);

/// Does the search move this shape parameter between its start values? Choices (a log's number, a kind, most exponents)
/// stay.
[[nodiscard]] bool shape_is_free(EffectId id, std::size_t parameter, const VectorXd& shape);

/// All hypotheses for a robot, with shapes that suit the motion of the logs. Effects that the base model holds already
/// (an offset that is a parameter, a rotor inertia of its own) and those in `known` are left out.
[[nodiscard]] std::vector<Hypothesis> all_hypotheses(const Robot& robot, const std::vector<LogRows>& logs,
                                                     const std::vector<Effect>& known);

/// Rows of all shapes of a hypothesis in one log: for each drive rows x (shapes x amplitudes), empty for drives it does
/// not reach.
[[nodiscard]] std::vector<MatrixXd> hypothesis_rows(const EffectModel& model, const LogRows& log,
                                                    const EffectSignals& signals, const Hypothesis& hypothesis);
/// The same in several logs with the signals that they have.
[[nodiscard]] PerLogAndDrive<MatrixXd> hypothesis_rows(const EffectModel& model, const std::vector<LogRows>& logs,
                                                       const Hypothesis& hypothesis);

}  // namespace deltadyn
