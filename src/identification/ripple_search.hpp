#pragma once

/// \file
/// Ripple of the drives' torque over their position, found from the residual: waves that repeat over the position
/// whatever the speed.

#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/log_processing.hpp"

namespace deltadyn {

/// Waves whose amplitude, fitted together with all base parameters, takes clearly more off the squared residual than
/// chance does, and that either half of the log predicts of the other. Slow ones (fewer than four over the range of the
/// drive) are left to gravity and lengths, fast ones that the pass band hides nearly always are not looked for. Rows
/// near velocity reversals tell nothing: any wave slows down there, and one of thousands fits what friction leaves at
/// the few places where a motion turns back.
/// \param processing  with the cut-off and the presliding of the fit; its ripples are not used
/// \returns drive by drive, the strongest first; phases and sizes at the positions of the logs
/// Throws deltadyn::Error as prepare_log does.
[[nodiscard]] std::vector<Ripple> find_ripples(const Robot& robot, const BaseParameters& base,
                                               const std::vector<Log>& logs, const ProcessingOptions& processing);

}  // namespace deltadyn
