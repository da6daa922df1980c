#pragma once

/// \file
/// Coefficients of Fourier series, paper (8), as CSV.

#include <string>
#include <vector>

#include "deltadyn/runtime/robot_description.hpp"
#include "deltadyn/trajectory/fourier_series.hpp"

namespace deltadyn {

/// Columns `segment,harmonic,frequency_hz`, then for every task coordinate the coefficient a of the sine and b of the
/// cosine: `x_sin_m,x_cos_m,...`. Row `harmonic` 0 holds the means b_0 in the cosine columns; `frequency_hz` is
/// harmonic times base frequency, that of row 0 the base frequency itself. Numbers are written exactly. Throws
/// Error(bad_input) if the disk is full; then nothing is left behind.
void write_coefficients(const std::string& path, const std::vector<FourierSeries>& segments,
                        const RobotDescription& robot);

}  // namespace deltadyn
