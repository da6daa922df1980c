#pragma once

/// \file
/// Where the plate was in the row before.

#include <Eigen/Core>

namespace deltadyn {

/// A loop over the rows of a log, in the order of time, carries one and hands it to every call. Forward kinematics of a
/// plate that turns then starts there: a part of the work, and the right one of two poses that belong to the same
/// drives near the rim of the workspace. A row without a pose, or a jump, only costs the search from nothing. Other
/// robots do not look at it.
struct PathPose {
  bool known = false;
  Eigen::VectorXd z;  ///< task coordinates, once known
};

}  // namespace deltadyn
