#pragma once

/// \file
/// Short names for Eigen's types in all of the diagnosis.

#include <Eigen/Core>

namespace deltadyn {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

}  // namespace deltadyn
