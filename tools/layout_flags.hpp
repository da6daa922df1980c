#pragma once

/// \file
/// Flags that say which parameters a robot has: limbs alike or not, tool, rotors, offsets.

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn::tools {

class LayoutFlags {
 public:
  /// \param usual_rotors  what holds without the flag, in words
  void add_to(CLI::App& app, const std::string& usual_rotors) {
    add_bodies(app);
    app.add_option("--rotor-inertia", rotor_inertia_,
                   "drives with a rotor inertia of their own, e.g. 4 or 1,2,3 [" + usual_rotors + "]")
        ->delimiter(',')
        ->allow_extra_args(false);  // else it takes the file behind it for a drive
    offset_flag_ =
        app.add_flag("--offset,!--no-offset", offset_, "a torque offset for every drive [on for an axis, else off]");
  }

  /// Only the flags of the bodies.
  void add_bodies(CLI::App& app) {
    app.add_flag("--individual-limbs", individual_limbs_, "every limb has parameters of its own");
    app.add_flag("--without-tool", without_tool_, "leave out the tool's ten parameters (delta4)");
  }

  [[nodiscard]] ParameterOptions options(const RobotDescription& robot) const {
    ParameterOptions options;
    options.individual_limbs = individual_limbs_;
    if (!individual_limbs_ && !robot.limbs_are_alike())
      fmt::print(
          "note: arms or struts of the limbs differ in length, but all limbs share one set of parameters; "
          "--individual-limbs gives each its own\n");
    options.tool = !without_tool_;
    if (without_tool_ && robot.plate)
      throw Error(fmt::format("--without-tool does not fit a robot of type {}, whose plate turns its tool", robot.type),
                  "", "leave it out", ExitCode::usage);
    options.rotor_inertia = rotor_inertia_;
    if (offset_flag_ != nullptr) options.offset = offset_flag_->count() > 0 ? offset_ : robot.type == Axis::kName;
    return options;
  }

 private:
  bool individual_limbs_ = false, without_tool_ = false, offset_ = false;
  CLI::Option* offset_flag_ = nullptr;
  std::vector<int> rotor_inertia_;
};

}  // namespace deltadyn::tools
