#pragma once

/// \file
/// The core as firmware calls it, behind functions without templates, so that it compiles with firmware's flags
/// into an object of its own.

namespace deltadyn::firmware_gate {

/// What one round of calls gave.
struct Outcome {
  bool ok = false;                    ///< every call returned Status::ok
  double round_trip = 0.0;            ///< largest |forward(inverse(z)) - z| [m, rad]
  double regressor_gap = 0.0;         ///< largest |Y p - inverse dynamics| over the largest torque
  double mass_asymmetry = 0.0;        ///< largest |M - M^T|
  double feed_forward_gap = 0.0;      ///< largest |feed-forward - inverse dynamics| over the largest torque
  double acceleration_gap = 0.0;      ///< largest |forward(inverse) - qdd| over the largest acceleration
  double equations_gap = 0.0;         ///< largest |M qdd + C qd + g + f - inverse dynamics| over the largest torque
  double slope_gap = 0.0;             ///< largest |dtau/dqdd - M|
  double reaction_gap = 0.0;          ///< largest |drive's reaction - its torque| over the largest torque
  double inertia_round_trip = 0.0;    ///< largest change of log-Cholesky numbers through the parameters and back
  double inertia_jacobian_gap = 0.0;  ///< relative error of the mass's derivative by the first of them
  double largest_torque = 0.0;
};

inline constexpr int kRobots = 6;
inline constexpr const char* kRobotNames[kRobots] = {"delta3", "linear_delta3", "delta4",
                                                     "axis",   "linear_axis",   "par4"};

/// \param robot index into kRobotNames
/// \param phase shifts the state, so that no call can be worked out at compile time [rad]
Outcome run_float(int robot, float phase);
Outcome run_double(int robot, double phase);

}  // namespace deltadyn::firmware_gate
