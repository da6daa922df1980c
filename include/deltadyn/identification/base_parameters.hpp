#pragma once

/// \file
/// Base parameters: the linear combinations of parameters that the motion of the drives can show at all (paper IV.A).

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

struct BaseParameterOptions {
  int states = 400;  ///< random task-space states; drives x states must be well above the number of columns
  std::uint64_t seed = 1;
  /// A diagonal entry of R below tolerance x the largest counts as zero (columns have norm 1)
  double tolerance = 1e-9;
};

/// beta = B p, with B the identity on the independent columns. Y p = Y_B beta for every state.
struct BaseParameters {
  std::vector<int> independent;          ///< columns of Y that make Y_B, ascending
  Eigen::MatrixXd B;                     ///< count x parameters
  std::vector<std::string> expressions;  ///< "strut.Iyy + 0.61 platform.m - ...", one a base parameter
  std::vector<std::string> units;
  double rank_gap = 0;          ///< last kept over first dropped diagonal entry of R: large when the count is certain
  double condition_number = 0;  ///< of Y_B over the random states, columns scaled to norm 1

  [[nodiscard]] int count() const { return static_cast<int>(independent.size()); }
};

/// Rank-revealing QR of the regressor over random states.
/// Throws deltadyn::Error for options out of range and if the rank cannot be told (no gap in R).
[[nodiscard]] BaseParameters find_base_parameters(const Robot& robot, const BaseParameterOptions& options = {});

}  // namespace deltadyn
