#pragma once

inline double twice(float value) {
  return 2.0 * value;
}
