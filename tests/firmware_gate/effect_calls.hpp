#pragma once

/// \file
/// The controller with all effects that can act, behind functions without templates, as core_calls.hpp does it for the
/// rest of the core.

namespace deltadyn::firmware_gate {

/// What a run over random set points gave.
struct EffectOutcome {
  int effects = 0;        ///< that were added
  bool settings = false;  ///< payload, friction, widths, time and reset were all taken
  long ok = 0;            ///< set points with a torque
  long refused = 0;       ///< set points with another status
  long wrong = 0;         ///< torques that are not finite, or that changed though the set point was refused
  double largest_torque = 0.0;
};

/// Random set points in task and drive coordinates, some of them out of reach, some not numbers.
/// \param robot index into kRobotNames of core_calls.hpp
EffectOutcome run_effects_float(int robot, long set_points);
EffectOutcome run_effects_double(int robot, long set_points);

}  // namespace deltadyn::firmware_gate
