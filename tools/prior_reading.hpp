#pragma once

/// \file
/// The prior of a robot as the tools take it: nominal values of simple shapes, or a file with its own trust in them.

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <string>

#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn::tools {

struct Prior {
  Eigen::VectorXd value, std;  ///< one value a parameter of the robot
  ParameterTable table;        ///< of the file
};

/// \param file  parameters (CSV), or empty: nominal values
inline Prior read_prior(const Robot& robot, const std::string& file) {
  const NominalParameters nominal = nominal_parameters(robot, PartShapes(robot.description()));
  Prior out{nominal.value, nominal.std, {}};
  if (file.empty()) {
    fmt::print(
        "note: no --prior; nominal parameters from simple shapes are used (delta-model prior shows and changes "
        "them)\n");
    return out;
  }
  out.table = read_parameters(file, robot.description());
  const ParameterMatch match = match_parameters(out.table, robot.parameter_names(), robot.parameter_units());
  out.value = match.value;
  for (Eigen::Index k = 0; k < out.value.size(); ++k) {
    const double std = match.std(k);
    const double share = nominal.value(k) != 0 ? nominal.std(k) / std::abs(nominal.value(k)) : 0.0;
    // The file's own trust in its values; without it the nominal one, carried over as a share of the value.
    out.std(k) = std::isfinite(std) && std > 0
                     ? std
                     : (share > 0 && out.value(k) != 0 ? share * std::abs(out.value(k)) : nominal.std(k));
  }
  for (const std::string& warning : match.warnings) fmt::print("note: {}\n", warning);
  return out;
}

}  // namespace deltadyn::tools
