#pragma once

/// \file
/// What can be measured of one recorded channel: quantisation step, noise, how often it repeats.

#include <Eigen/Core>

namespace deltadyn::checks {

struct ChannelQuality {
  double step = 0;          ///< quantisation: nearly all changes are multiples of it; 0 if there is none
  double smallest = 0;      ///< the smallest change that is no rounding; the step, if the channel is quantised
  double noise = 0;         ///< standard deviation of white noise, the quantisation's included
  double repeat_share = 0;  ///< of the rows that have the value of the row before
  double range = 0;         ///< largest minus smallest value
  double travel = 0;        ///< the same without the outermost thousandths, which may be spoilt
};

/// Missing numbers (NaN) are passed over.
[[nodiscard]] ChannelQuality measure_channel(const Eigen::Ref<const Eigen::VectorXd>& values);

}  // namespace deltadyn::checks
