#pragma once

/// \file
/// A log of a virtual robot: plant, controller and sensors together.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/log.hpp"
#include "deltadyn/simulation/controller.hpp"
#include "deltadyn/simulation/plant.hpp"
#include "deltadyn/simulation/reference_motion.hpp"
#include "deltadyn/simulation/sensors.hpp"

namespace deltadyn {

struct SimulationOptions {
  ControllerOptions controller;
  PlantOptions plant;
  SensorOptions sensors;
  double log_rate_hz = 1000;
  double control_rate_hz = 1000;  ///< a whole multiple of the log's rate; the torque is held in between
  double discard_s = 0;           ///< of the start: not in the log, e.g. until a periodic motion has settled
  bool inverse = false;           ///< no controller: the torque that the exact motion takes
  std::uint64_t seed = 1;
  std::function<void(double)> progress;  ///< called with the share done, 0 to 1; may be empty

  /// Throws deltadyn::Error(usage) naming the field.
  void validate(int drives) const;
};

struct SimulationResult {
  Log log;                         ///< q as the encoders read it, tau as recorded; qd, qdd exact
  Eigen::VectorXd rms_error;       ///< of each drive, reference minus true position [rad | m]
  Eigen::VectorXd largest_error;   ///< of each drive, largest size of the same
  Eigen::VectorXd largest_torque;  ///< that acted [N m | N]
  long clipped = 0;                ///< control samples at a drive's effort limit
  PlantCounts counts;
  double work = 0, losses = 0;  ///< of the drives, in friction and the like, over the whole run [J]
  /// Kinetic, potential and spring energy at the end minus at the start [J]; work - losses
  double energy_change = 0;
};

/// Moves the plant along the reference.
///
/// The torque acts as a staircase. Its value at a sample is the mean of the two stairs that meet there: what a drive
/// that averages its current over the sampling period reports, in phase with the positions. qdd is given likewise.
/// \param plant        the virtual robot
/// \param model, p     what the controller knows of it
/// \param effects      those of the plant have been built in already; here those of the log act
/// Throws deltadyn::Error as plant and controller do.
[[nodiscard]] SimulationResult simulate(Plant& plant, const Robot& model, const Eigen::VectorXd& p,
                                        const ReferenceMotion& reference, const std::vector<Effect>& effects,
                                        const SimulationOptions& options);

}  // namespace deltadyn
