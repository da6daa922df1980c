#pragma once

/// \file
/// The motion that a simulated robot is told to follow, at any time.

#include <Eigen/Core>

#include "deltadyn/trajectory/samples.hpp"

namespace deltadyn {

/// Drives between the samples of a trajectory: the polynomial of fifth degree that takes position, rate and
/// acceleration of both neighbours, so that the samples come back exactly and the motion is smooth.
class ReferenceMotion {
 public:
  /// \param repeats  how often a periodic trajectory runs; 1: once, as it is
  /// Throws deltadyn::Error for fewer than two samples, and if a trajectory that is to be repeated does not end where
  /// it begins.
  explicit ReferenceMotion(const TrajectorySamples& samples, int repeats = 1);

  [[nodiscard]] int drives() const { return static_cast<int>(q_.cols()); }
  [[nodiscard]] double duration_s() const { return repeats_ == 1 ? t_(t_.size() - 1) : repeats_ * period_; }
  [[nodiscard]] double period_s() const { return period_; }  ///< of one repetition

  struct State {
    Eigen::VectorXd q, qd, qdd;
  };
  /// \param time  [s] from the start; before it and after the end the robot stands at the end's position
  void at(double time, State& state) const;

 private:
  Eigen::VectorXd t_;
  Eigen::MatrixXd q_, qd_, qdd_;
  int repeats_;
  double period_;
};

}  // namespace deltadyn
