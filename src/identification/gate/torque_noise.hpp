#pragma once

/// \file
/// How much of a residual the noise of the torque record makes by itself.

#include <vector>

#include "deltadyn/signal/log.hpp"

#include "sample.hpp"

namespace deltadyn::gate {

/// White noise of the recorded torques (the floor of their spectra) under the sample's Gaussian, over the torques under
/// it: rms over the drives, as Timing::rms_after counts.
[[nodiscard]] double relative_torque_noise(const std::vector<Log>& logs, const Sample& sample);

}  // namespace deltadyn::gate
