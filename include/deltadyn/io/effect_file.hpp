#pragma once

/// \file
/// Effect files: `effect,joint,parameter,value,unit,std`, one row a parameter (amplitudes and shapes), read by
/// identify, validate, simulate, convert and diagnose.

#include <string>
#include <vector>

#include "deltadyn/runtime/effect_catalogue.hpp"

namespace deltadyn {

/// Version of the catalogue's names and formulas, written as a comment `# deltadyn effects N` on top of every file.
inline constexpr int kEffectFileVersion = 1;

/// Throws Error(bad_input) with file, line and column: unknown effect, joint or parameter, a parameter twice or
/// missing, another unit, a file of another version.
[[nodiscard]] std::vector<Effect> read_effects(const std::string& path, const RobotDescription& robot);

/// Numbers read back exactly. An empty list gives a file with the header alone.
void write_effects(const std::string& path, const std::vector<Effect>& effects, const RobotDescription& robot);

}  // namespace deltadyn
