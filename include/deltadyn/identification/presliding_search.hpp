#pragma once

/// \file
/// How friction builds up after a reversal: displacement and damping of each joint's bristles, found from the rows near
/// reversals. With them these rows take part in the fit instead of being left out (effects/bristle.hpp holds the law
/// and its source).

#include <Eigen/Core>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/log_processing.hpp"

namespace deltadyn {

/// What the search found in one joint with friction.
struct PreslidingJoint {
  double displacement = 0;   ///< [rad | m]; 0: Coulomb's law does as well
  double std = 0;            ///< of the displacement
  double gain = 0;           ///< fall of the squared residual against Coulomb's law, in units of the noise
  double damping_s = 0;      ///< of the bristles; 0: the logs show none
  double damping_std_s = 0;  ///< at the displacement found
};

/// One value a joint with friction: drives, then the inner joint. The first pass rests on rows away from reversals, the
/// next ones on all rows; amplitudes and base parameters are fitted along.
/// \param processing  with the cut-off of the fit; its presliding is not used
/// Throws deltadyn::Error as prepare_log and estimate_base_parameters do.
[[nodiscard]] std::vector<PreslidingJoint> find_presliding(const Robot& robot, const BaseParameters& base,
                                                           const std::vector<Log>& logs,
                                                           const ProcessingOptions& processing, int threads = 0);

/// The displacements alone, as ProcessingOptions::presliding takes them.
[[nodiscard]] Eigen::VectorXd displacements(const std::vector<PreslidingJoint>& joints);
/// The dampings alone, as ProcessingOptions::presliding_damping_s takes them.
[[nodiscard]] Eigen::VectorXd bristle_dampings(const std::vector<PreslidingJoint>& joints);

}  // namespace deltadyn
