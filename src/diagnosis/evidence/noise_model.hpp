#pragma once

/// \file
/// Correlated noise of a torque residual as an autoregression.
/// Without it, on noise with a correlation of 0.9, a test "finds" an effect in every clean log.

#include <vector>

#include "eigen_names.hpp"

namespace deltadyn {

using RowMask = Eigen::Array<bool, Eigen::Dynamic, 1>;

/// [log][drive]
template <class T>
using PerLogAndDrive = std::vector<std::vector<T>>;

/// e(t) = sum_k ar(k) e(t - 1 - k) + w(t), w white with standard deviation `std`.
struct NoiseModel {
  VectorXd ar;
  double std = 1;

  [[nodiscard]] Index order() const { return ar.size(); }
  /// Standard deviation of e itself.
  [[nodiscard]] double total_std() const;
};

/// White noise of the same size.
[[nodiscard]] PerLogAndDrive<NoiseModel> without_memory(PerLogAndDrive<NoiseModel> noise);

/// Burg's method over the runs of usable rows, order by the Bayesian information criterion (Schwarz 1978). Always
/// stable.
/// \param largest_order  fewer if the rows do not allow it
/// \param damping        factor on the radius of every pole, at most 1: below, the noise cannot remember for longer
///                       than a row over 1 - damping, and what is slower (an offset, a trend) stays a residual instead
///                       of becoming noise
[[nodiscard]] NoiseModel fit_noise_model(const Eigen::Ref<const VectorXd>& residual, const RowMask& usable,
                                         Index largest_order = 20, double damping = 1);

/// The same noise with white noise beside it, `share` of its variance: no band then counts as free of noise, where the
/// smallest error of the model would look certain.
[[nodiscard]] NoiseModel with_white_share(const NoiseModel& noise, double share);

}  // namespace deltadyn
