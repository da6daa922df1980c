#pragma once

/// \file
/// A basis for structure of any kind in a drive's residual: piecewise linear in position, speed (logarithmic),
/// acceleration, load and time, by direction, and in the other joints' motion. It knows nothing of the catalogue: it
/// sees what the catalogue may not explain.

#include <string>
#include <utility>
#include <vector>

#include "log_rows.hpp"

namespace deltadyn {

struct GenericBasis {
  /// [log][drive]: rows x columns; the same columns in every log.
  std::vector<std::vector<MatrixXd>> columns;
  /// Which coordinate each column belongs to, for each drive: "position", "speed", ...
  std::vector<std::vector<std::string>> coordinate;
  /// First column and number of columns of each function of one coordinate, for each drive.
  std::vector<std::vector<std::pair<Index, Index>>> blocks;
};

/// \param logs   set the knots
/// \param more   evaluated with the same knots, behind those of `logs`
[[nodiscard]] GenericBasis make_generic_basis(const std::vector<LogRows>& logs, const std::vector<LogRows>& more = {});

}  // namespace deltadyn
