#pragma once

/// \file
/// Hypothesis: all torques have another scale, or another sign, than the masses of the prior need. Gravity tells it
/// best: reflected rotor inertia, which the model need not hold, adds to the inertia but not to the weight.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "rows.hpp"

namespace deltadyn::gate {

struct Ratio {
  double value = 0;  ///< estimate over prior
  double std = 0;    ///< by the data and the prior's trust in its masses
  double data_std = 0;
  bool known = false;
};

struct TorqueScale {
  Ratio gravity;               ///< gravity torques of the limbs' drives
  std::vector<Ratio> inertia;  ///< of each drive by itself, the others at rest
  double prior_std = 0;        ///< relative, of the prior's masses taken as wrong all together
};

/// \param points     motion and torque of the log, torque already set right in time
/// \param prior      one value a parameter; std the same
[[nodiscard]] TorqueScale estimate_scale(const Robot& robot, const BaseParameters& base, const Points& points,
                                         const Eigen::VectorXd& prior, const Eigen::VectorXd& prior_std);

}  // namespace deltadyn::gate
