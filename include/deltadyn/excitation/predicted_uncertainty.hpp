#pragma once

/// \file
/// How well a motion will show each base parameter, before it is run.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/excitation/design_space.hpp"
#include "deltadyn/trajectory/samples.hpp"

namespace deltadyn {

/// Standard deviations of the base parameters from one run of the samples, with white torque noise of standard
/// deviation `torque_noise` [N m | N], one a drive. Infinite where the motion does not show the parameter.
/// \param every  only every k-th sample is evaluated and counts for k; 1 takes all
[[nodiscard]] Eigen::VectorXd predicted_std(const Robot& robot, const std::vector<int>& base_columns,
                                            const TrajectorySamples& samples, const Eigen::VectorXd& torque_noise,
                                            int every = 1);

}  // namespace deltadyn
