#pragma once

/// \file
/// The effects that a tool is given beside its parameters.

#include <fmt/format.h>
#include <string>
#include <vector>

#include "deltadyn/io/effect_file.hpp"
#include "deltadyn/io/parameter_file.hpp"

namespace deltadyn::tools {

/// Effects of the flag --effects; none without it, and a warning if the parameters were found together with some.
inline std::vector<Effect> given_effects(const std::string& effect_file, const ParameterTable& parameters,
                                         const RobotDescription& robot) {
  if (const std::string missing = missing_effects(parameters, effect_file); !missing.empty())
    fmt::print(stderr, "warning: {}\n", missing);
  return effect_file.empty() ? std::vector<Effect>() : read_effects(effect_file, robot);
}

}  // namespace deltadyn::tools
