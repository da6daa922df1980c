#pragma once

/// \file
/// Effects with known amplitudes as torque over a log, and their amplitudes estimated together with the base
/// parameters.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/identification/effect_columns.hpp"
#include "deltadyn/identification/identify.hpp"
#include "deltadyn/identification/validate.hpp"

namespace deltadyn {

/// Torque of the effects at every sample of a log, N x drives [N m | N].
[[nodiscard]] Eigen::MatrixXd effect_torque(const EffectModel& model, const EffectSignals& signals,
                                            const std::vector<Effect>& effects, int log_number);

/// The logs with the effects' torque taken off, so that everything made for a model without effects serves.
/// \param p          parameters for the effects that need the model's torque
/// \param cutoff_hz  of the motion that the effects are computed from; 0: the log's own q, qd and qdd
[[nodiscard]] std::vector<Log> without_effects(const Robot& robot, const std::vector<Log>& logs,
                                               const Eigen::VectorXd& p, const std::vector<Effect>& effects,
                                               double cutoff_hz);

/// Amplitudes (and their standard deviations) by weighted least squares together with all base parameters. Shapes stay;
/// so do the amplitudes of effects whose shape is their amplitude. Amplitudes that physics keeps positive do not become
/// negative: one that would be 0 then, the others are those of the fit without it, and its standard deviation is that
/// of the fit without bounds.
/// \param used  the parameters p were found with its processing and its rows: the amplitudes are, too, so that both
///              belong together
/// \returns the effects with their new amplitudes
[[nodiscard]] std::vector<Effect> estimate_amplitudes(const Robot& robot, const std::vector<Log>& logs,
                                                      const Eigen::VectorXd& p, const std::vector<Effect>& effects,
                                                      const Identification& used);

/// identify() for a model with effects: amplitudes first, together with the base parameters, then the consistent
/// parameters of what is left, twice, as some effects need the model's torque. `effects` gets the new amplitudes.
[[nodiscard]] Identification identify_with_effects(const Robot& robot, const std::vector<Log>& logs,
                                                   const Eigen::VectorXd& prior, const Eigen::VectorXd& prior_std,
                                                   const IdentificationOptions& options, std::vector<Effect>& effects);

/// validate() for a model with effects: measured torque and model both hold the torque of the effects.
/// Throws deltadyn::Error as prepare_log() does.
[[nodiscard]] Validation validate_with_effects(const Robot& robot, const std::vector<Log>& logs,
                                               const std::vector<Effect>& effects, const Eigen::VectorXd& p,
                                               const ProcessingOptions& processing, int threads = 0);

}  // namespace deltadyn
