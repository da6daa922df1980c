#pragma once

/// \file
/// Correlated noise of known coefficients for the tests of noise model and whitener.

#include <Eigen/Core>
#include <algorithm>
#include <random>

#include "deltadyn/runtime/random.hpp"

namespace deltadyn::testing_support {

/// e(t) = sum_k ar(k) e(t - 1 - k) + w(t), w white with unit variance, from e = 0 on.
inline Eigen::VectorXd autoregression(const Eigen::VectorXd& ar, Eigen::Index rows, unsigned seed) {
  std::mt19937_64 random(seed);
  NormalDistribution normal;
  Eigen::VectorXd e = Eigen::VectorXd::Zero(rows);
  for (Eigen::Index t = 0; t < rows; ++t) {
    e(t) = normal(random);
    for (Eigen::Index k = 0; k < std::min(t, ar.size()); ++k) e(t) += ar(k) * e(t - 1 - k);
  }
  return e;
}

}  // namespace deltadyn::testing_support
