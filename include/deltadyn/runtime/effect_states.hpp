#pragma once

/// \file
/// What the effects on plate and telescope need to know of a robot's state, for any robot type.

#include <Eigen/Core>
#include <memory>

#include "deltadyn/core/status.hpp"
#include "deltadyn/runtime/path_pose.hpp"
#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

/// Plate, inner joint and passive joints at one state of the drives. For an axis everything is zero.
struct EffectState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< of the tool's point in W [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< [m/s^2]
  Eigen::Matrix3Xd J;                                      ///< d position / dq
  double inner_rate = 0;                                   ///< of a telescope [m/s] or an articulated plate [rad/s]
  Eigen::RowVectorXd J_inner;                              ///< d inner_rate / dqd
  Eigen::Vector3d bar = Eigen::Vector3d::UnitZ();          ///< unit vector along the telescope
  Eigen::VectorXd passive_rate;                            ///< of each different passive joint [rad/s]
  /// d rate / d qd, times the number of joints alike: joints x drives
  Eigen::MatrixXd J_passive;
};

/// Dispatches once on the type of the robot.
class EffectStates {
 public:
  virtual ~EffectStates() = default;
  using ConstRef = Eigen::Ref<const Eigen::VectorXd>;
  [[nodiscard]] virtual Status at(const ConstRef& q, const ConstRef& qd, const ConstRef& qdd, EffectState& state,
                                  PathPose* path = nullptr) const = 0;
};

[[nodiscard]] std::unique_ptr<EffectStates> make_effect_states(const RobotDescription& description);

}  // namespace deltadyn
