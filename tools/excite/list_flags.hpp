#pragma once

/// \file
/// Flags of delta-excite that hold lists of numbers, one for all or one for each drive or axis.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tool_support.hpp"

namespace deltadyn::tools {

inline CLI::Option* add_list(CLI::App& app, const char* flag, std::vector<double>& values, const std::string& text) {
  return app.add_option(flag, values, text)->delimiter(',')->type_name("LIST");
}

/// The list with one entry for each of `count`. Throws Error(usage) that names the flag.
inline Eigen::VectorXd spread_vector(const std::vector<double>& values, int count, const std::string& flag) {
  const std::vector<double> all = spread(values, static_cast<std::size_t>(count), flag);
  return Eigen::Map<const Eigen::VectorXd>(all.data(), count);
}

}  // namespace deltadyn::tools
