#pragma once

/// \file
/// Trajectories as CSV: `t_s, x_m, y_m, z_m, psi_rad`, their first and second derivatives (`xd_m_s`, `xdd_m_s2`, ...),
/// and `q1_rad`, `qd1_rad_s`, `qdd1_rad_s2`, ... of the drives (prismatic: `q1_m`, ...).

#include <string>

#include "deltadyn/trajectory/samples.hpp"

namespace deltadyn {

/// Reads a trajectory of `robot`, columns in any order, unknown ones ignored; drives also in degrees as in a log.
///
/// What the file does not hold is computed: task space from the drives and the other way round; rates and accelerations
/// that are nowhere in the file by central differences of sixth order of the positions (one-sided at the ends), which
/// needs even sampling. Where both task space and drives are there, both are taken as they are. Throws Error(bad_input)
/// with file, line and column: missing columns, times that do not increase, numbers that are not finite, poses the
/// robot cannot take.
[[nodiscard]] TrajectorySamples read_trajectory(const std::string& path, const Robot& robot);

/// Writes all columns; numbers read back exactly.
/// \param note  a comment line at the top, without the '#'; empty: none
/// Throws Error(bad_input) if the disk is full; then nothing is left behind.
void write_trajectory(const std::string& path, const TrajectorySamples& samples, const RobotDescription& robot,
                      const std::string& note = "");

}  // namespace deltadyn
