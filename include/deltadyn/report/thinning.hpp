#pragma once

/// \file
/// Fewer points for the same picture, so that a report on hours of data stays small.

#include "deltadyn/report/plot.hpp"

namespace deltadyn {

/// The area a series is drawn in.
struct PlotFrame {
  PlotRange x, y;
  bool log_x = false;
  bool log_y = false;
  int columns = 800;  ///< width [px]
  int rows = 240;     ///< height [px]
};

/// Leaves out what cannot be seen at this size. Lines, steps and impulses with increasing x keep the smallest and the
/// largest value of each pixel column, so that no peak is lost, and their gaps. Curves that run back and forth keep
/// what moves by at least a pixel; points keep one a cell and the extremes of each column. Short series come back
/// unchanged, except that samples that cannot be drawn on these axes became NaN.
[[nodiscard]] Series thin(const Series& series, const PlotFrame& frame);

}  // namespace deltadyn
