#pragma once

/// \file
/// Does a motion keep its limits, also between the samples?

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "deltadyn/trajectory/motion_limits.hpp"

namespace deltadyn {

/// A smooth motion in task space on [0, duration_s].
struct SmoothMotion {
  double duration_s = 0;
  std::function<TaskState(double t_s)> at;
};

/// How far one limit is used.
struct LimitUse {
  Limit limit;
  double load = 0;    ///< largest over the motion, with what it may be larger between the samples; kept if at most 1
  double value = 0;   ///< the value at the sample where it is largest [unit of the limit]
  double time_s = 0;  ///< when
};

struct LimitCheck {
  bool reachable = true;       ///< false: a pose is out of reach or singular; then `uses` ends there
  std::vector<LimitUse> uses;  ///< one a limit
  /// 1 - largest load: how much room is left, as a share of the limit that binds; negative: broken.
  [[nodiscard]] double margin() const;
  /// The limit with the largest load; not if there is none.
  [[nodiscard]] const LimitUse& tightest() const;
  /// Takes the larger use of each limit from two parts of one motion.
  void merge(const LimitCheck& other, double starts_at_s);
};

/// Samples the motion `samples` + 1 times, ends included. Between two samples a smooth curve leaves the chord by at
/// most an eighth of its second difference; twice the largest one found near each sample is added to the load there. A
/// torque is that of the model with its Coulomb friction on the side of the rest, whichever way the joints turn.
[[nodiscard]] LimitCheck check_limits(const Robot& robot, const MotionLimits& limits, const SmoothMotion& motion,
                                      int samples);

}  // namespace deltadyn
