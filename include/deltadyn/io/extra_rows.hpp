#pragma once

/// \file
/// Rows of a parameter file that are no columns of the regressor: presliding, damping of bristles and ripple of the
/// torque over the position. `drive1.presliding` [rad | m]; `drive1.presliding_damping` [s]; `drive1.ripple1.waves`
/// [waves/turn | waves/m] with `drive1.ripple1.cosine` and `.sine` [N m | N].

#include <Eigen/Core>
#include <string>
#include <vector>

#include "deltadyn/identification/ripple.hpp"
#include "deltadyn/io/parameter_file.hpp"

namespace deltadyn {

/// Displacement over which the friction of each joint builds up after a reversal [rad | m], drives first, then the
/// telescope; 0 where the file says nothing. Throws Error(bad_input) for a joint that the robot does not have and for a
/// negative displacement.
[[nodiscard]] Eigen::VectorXd presliding_of(const ParameterTable& table, const RobotDescription& robot);
/// Name of that row.
[[nodiscard]] std::string presliding_name(const RobotDescription& robot, int joint);

/// Damping of the bristles of each joint [s], drives first, then the inner joint; 0 where the file says nothing.
/// Throws Error(bad_input) for a joint that the robot does not have and for a negative damping.
[[nodiscard]] Eigen::VectorXd presliding_damping_of(const ParameterTable& table, const RobotDescription& robot);
/// Name of that row.
[[nodiscard]] std::string presliding_damping_name(const RobotDescription& robot, int joint);

/// The ripples of all drives. Throws Error(bad_input) for a drive that the robot does not have, for waves that are not
/// above 0, and for a missing row of the three.
[[nodiscard]] std::vector<Ripple> ripples_of(const ParameterTable& table, const RobotDescription& robot);
/// Their rows.
[[nodiscard]] std::vector<ParameterEntry> ripple_rows(const std::vector<Ripple>& ripples,
                                                      const RobotDescription& robot);

}  // namespace deltadyn
