#pragma once

/// \file
/// A small delay between torque and position beside friction that builds up after reversals. The gate before the fit
/// knows Coulomb's law only and must not take the one for the other; once bristles and ripples are known, a fraction of
/// a sample shows. Left in, it is friction that is some per cent off.

#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/log_processing.hpp"

namespace deltadyn {

struct FineDelay {
  double delay_s = 0;  ///< of the torque of all drives and logs, positive: late
  double std_s = 0;
  bool certain = false;  ///< beyond chance, alike in all drives, and of a log that the model explains but for noise
};

/// Delay, displacement and damping of every bristle and all base parameters together, by Gauss and Newton. Nothing is
/// looked for where `processing` holds no presliding: there the gate has spoken.
/// \param processing  as of the fit, with presliding and ripples
/// \param known       parameters of a finished model: then nothing but the delay is free; null: everything is
/// Throws deltadyn::Error as prepare_log does.
[[nodiscard]] FineDelay find_fine_delay(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                                        const ProcessingOptions& processing, const Eigen::VectorXd* known = nullptr);

/// The logs with such a delay taken out; samples for which there then is no torque are marked as left out.
[[nodiscard]] std::vector<Log> without_delay(std::vector<Log> logs, double delay_s);

}  // namespace deltadyn
