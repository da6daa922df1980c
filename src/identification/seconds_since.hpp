#pragma once

#include <chrono>

namespace deltadyn {

/// Time since a start [s], for the summaries that say how long a step took.
inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace deltadyn
