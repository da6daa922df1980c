#pragma once

/// \file
/// Ripple of a drive's torque over its position (cogging, tooth meshing) as part of a model (effects/wave.hpp holds the
/// law).

namespace deltadyn {

/// One wave: cosine cos(n q) + sine sin(n q).
struct Ripple {
  int drive = 0;                ///< from 0
  double n = 0;                 ///< [1/rad | 1/m]: waves a turn, or 2 pi waves a metre
  double cosine = 0, sine = 0;  ///< [N m | N]
  double n_std = 0;
  double amplitude_std = 0;  ///< of either
};

}  // namespace deltadyn
