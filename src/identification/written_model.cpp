#include "deltadyn/identification/written_model.hpp"

#include <algorithm>
#include <utility>

#include "deltadyn/identification/effect_torque.hpp"
#include "deltadyn/identification/log_gate.hpp"
#include "deltadyn/identification/model_band.hpp"

namespace deltadyn {

bool holds_timing(const std::vector<Effect>& effects) {
  return std::any_of(effects.begin(), effects.end(),
                     [](const Effect& one) { return effect_kind(one.id).effect_class == EffectClass::phase; });
}

double written_cutoff_hz(const Robot& robot, const std::vector<Log>& logs, const WrittenModel& model,
                         const ProcessingOptions& processing, bool keep_delay, int threads) {
  // A delay that is left in the logs must not end the band in which the model holds.
  const bool delayed = keep_delay || holds_timing(model.effects);
  const std::vector<Log> mended = delayed ? examine_logs(robot, logs, {}, {}).logs : std::vector<Log>();
  return choose_model_cutoff(robot, find_base_parameters(robot), delayed ? mended : logs, processing, threads)
      .cutoff_hz;
}

WrittenValidation validate_written(const Robot& robot, std::vector<Log> logs, const WrittenModel& model,
                                   ProcessingOptions processing, bool choose_cutoff, bool keep_delay, int threads) {
  if (processing.filter && choose_cutoff)
    processing.cutoff_hz = written_cutoff_hz(robot, logs, model, processing, keep_delay, threads);
  processing.presliding = model.presliding;
  processing.presliding_damping_s = model.presliding_damping_s;
  processing.ripples = model.ripples;
  WrittenValidation out;
  if (model.effects.empty() && !keep_delay) {
    const FineDelay found = find_fine_delay(robot, find_base_parameters(robot), logs, processing, &model.p);
    if (found.certain) {
      logs = without_delay(std::move(logs), found.delay_s);
      out.fine_delay = found;
    }
  }
  out.validation = validate_with_effects(robot, logs, model.effects, model.p, processing, threads);
  out.logs = std::move(logs);
  return out;
}

}  // namespace deltadyn
