#pragma once

/// \file
/// A model as its files hold it (parameters, rows of bristles and ripples, effects) against logs: what delta-validate
/// shows, and what delta-diagnose proves.

#include <optional>
#include <vector>

#include "deltadyn/identification/fine_delay.hpp"
#include "deltadyn/identification/validate.hpp"
#include "deltadyn/runtime/effect_catalogue.hpp"

namespace deltadyn {

struct WrittenModel {
  Eigen::VectorXd p;                                 ///< in the robot's layout
  std::vector<Effect> effects;                       ///< of the effect file
  Eigen::VectorXd presliding, presliding_damping_s;  ///< as ProcessingOptions holds them
  std::vector<Ripple> ripples;
};

/// Does an effect say how torque and positions stand apart in time? Then a delay in a log is the model's to explain and
/// must stay.
[[nodiscard]] bool holds_timing(const std::vector<Effect>& effects);

struct WrittenValidation {
  Validation validation;
  std::vector<Log> logs;                ///< as used, with the torque of the effects
  std::optional<FineDelay> fine_delay;  ///< taken out of the logs
};

/// Cut-off at which logs show a model, by choose_model_cutoff(): it takes as long as a fit, and depends on the logs and
/// on whether the model holds_timing(), on nothing else.
/// \param keep_delay  as for validate_written()
/// Throws deltadyn::Error as choose_model_cutoff() does.
[[nodiscard]] double written_cutoff_hz(const Robot& robot, const std::vector<Log>& logs, const WrittenModel& model,
                                       const ProcessingOptions& processing, bool keep_delay, int threads = 0);

/// \param processing     its presliding and ripples are those of the model
/// \param choose_cutoff  by written_cutoff_hz()
/// \param keep_delay     leave a small delay that shows beside the bristles in the logs; always with effects
/// Throws deltadyn::Error as validate() and choose_model_cutoff() do.
[[nodiscard]] WrittenValidation validate_written(const Robot& robot, std::vector<Log> logs, const WrittenModel& model,
                                                 ProcessingOptions processing, bool choose_cutoff, bool keep_delay,
                                                 int threads = 0);

}  // namespace deltadyn
