#pragma once

inline int halve(int value) {
  if (value % 2 != 0) throw value;
  return value / 2;
}
