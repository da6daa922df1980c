// Uses the compiled part of the library: an axis with a known inertia, through the run-time interface.

#include <cmath>
#include <cstdio>

#include "deltadyn/runtime/robot.hpp"

int main() {
  deltadyn::RobotDescription description;
  description.name = "bench";
  description.type = "axis";
  description.limbs.resize(1);
  description.limits.resize(1);
  const auto robot = deltadyn::make_robot(description);

  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  Eigen::VectorXd p = Eigen::VectorXd::Zero(robot->parameters());
  for (int i = 0; i < robot->parameters(); ++i) {
    if (robot->parameter_names()[static_cast<std::size_t>(i)] == "upper_arm.Iyy") p(i) = 0.25;
  }
  Eigen::VectorXd tau(1);
  const auto status = robot->inverse_dynamics(0 * one, one, 2 * one, p, tau);
  std::printf("torque of 0.25 kg m^2 at 2 rad/s^2: %g N m\n", tau(0));
  return status == deltadyn::Status::ok && std::abs(tau(0) - 0.5) < 1e-12 ? 0 : 1;
}
