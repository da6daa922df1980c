#pragma once

/// \file
/// What the steps of coarse encoders make of the base parameters. Where few steps pass, their error follows the motion
/// and averages out less than the residual tells; so the motion is recorded again, by encoders turned by a part of a
/// step (a parametric bootstrap: Efron, Tibshirani 1993, chapter 6).

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "deltadyn/signal/log.hpp"

namespace deltadyn {

/// Do so few steps of an encoder pass in a sample that their error lies about the turning points of the motion?
[[nodiscard]] bool has_coarse_encoders(const std::vector<Log>& logs);

/// Covariance of the base parameters over the phases of the encoders; empty where all steps are too fine to matter.
/// \param motion_hz  -3 dB point of the filter whose output stands for the motion
/// \param estimate   base parameters from logs like the given ones
[[nodiscard]] Eigen::MatrixXd encoder_covariance(
    const std::vector<Log>& logs, double motion_hz,
    const std::function<Eigen::VectorXd(const std::vector<Log>&)>& estimate);

}  // namespace deltadyn
