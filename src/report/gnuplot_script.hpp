#pragma once

#include <string>
#include <vector>

#include "deltadyn/report/plot.hpp"

namespace deltadyn {

/// What to draw, checked, and where: everything gnuplot needs except the kind of picture.
struct GnuplotScript {
  int width = 0;
  int height = 0;
  std::string body;
};

/// \throws Error if the specifications contradict themselves
GnuplotScript gnuplot_script(const std::vector<PlotSpec>& panels);

}  // namespace deltadyn
