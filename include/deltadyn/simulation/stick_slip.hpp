#pragma once

/// \file
/// Which joints stay at rest: dry friction at zero speed as a problem with bounds.

#include <Eigen/Core>

#include "deltadyn/simulation/mechanism.hpp"

namespace deltadyn {

/// Forces of joints at rest and what becomes of them.
struct StickSlip {
  JointVector force;         ///< u, what each joint passes on to the mechanism [N m | N]
  JointVector acceleration;  ///< a = A u + b [rad/s^2 | m/s^2]; 0 where the joint stays at rest
  /// 0: stays at rest; +1, -1: starts to slide this way
  Eigen::Matrix<int, Eigen::Dynamic, 1, 0, kMaxJoints, 1> direction;
};

/// Solves for all joints at rest together: a = A u + b, low <= u <= high, and for each joint a = 0, or u = low and a >
/// 0, or u = high and a < 0 (a joint that starts to move is held back as hard as friction can). That is the minimum of
/// u^T A u / 2 + b^T u in the box (Gauss's principle), which always exists. A may be singular: joints whose rates
/// depend on one another share their force in one of many ways, with the same accelerations.
/// \param A  symmetric, positive semi-definite with positive diagonal
/// \param A, b, low, high  of the same size; low <= high
[[nodiscard]] StickSlip solve_stick_slip(const Eigen::Ref<const Eigen::MatrixXd>& A, const JointVector& b,
                                         const JointVector& low, const JointVector& high);

}  // namespace deltadyn
