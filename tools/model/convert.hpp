#pragma once

/// \file
/// `delta-model convert`: an identified robot for MuJoCo, for URDF readers, or for firmware.

#include <fmt/format.h>
#include <string>
#include <vector>

#include "deltadyn/io/model_export.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "effects_of_rows.hpp"
#include "given_effects.hpp"
#include "tool_support.hpp"

namespace deltadyn::tools {

class Convert {
 public:
  void add_to(CLI::App& app, ToolRun& run) {
    CLI::App& c = *app.add_subcommand(
        "convert", "Hand an identified robot on: MuJoCo (MJCF), URDF readers, firmware (C++ header).");
    set_example(
        c,
        "delta-model convert robot.urdf --params params.csv --to mjcf -o robot.xml\n"
        "  delta-model convert robot.urdf --params params.csv --effects effects.csv --to header -o robot_model.hpp");
    c.add_option("robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    c.add_option("--params", parameter_file_, "parameters name,value,unit (CSV)")->required()->type_name("FILE");
    c.add_option("--effects", effect_file_,
                 "effects of delta-diagnose (CSV); those that the format holds travel along: in a header all that a "
                 "controller can feed "
                 "forward, else offsets and rotor inertias")
        ->type_name("FILE");
    c.add_option("--to", format_,
                 "mjcf: MuJoCo, loops closed by equality constraints; urdf: Pinocchio, Gazebo, RViz; header: C++17 for "
                 "firmware")
        ->required()
        ->check(CLI::IsMember({"mjcf", "urdf", "header"}));
    c.add_option("-o,--output", output_, "file to write")->required()->type_name("FILE");
    run.on(c, [this, &run] { execute(run); });
  }

 private:
  void execute(ToolRun& run) {
    run.check_files({output_}, {robot_file_, parameter_file_, effect_file_});
    const RobotDescription description = read_robot_file(robot_file_);
    const ParameterTable table = read_parameters(parameter_file_, description);
    const auto robot = make_robot(description, parameter_options_of(table, description));
    const ParameterMatch match = match_parameters(table, robot->parameter_names(), robot->parameter_units());
    for (const std::string& warning : match.warnings) fmt::print("note: {}\n", warning);
    std::vector<Effect> effects = effects_of_rows(table, description);
    for (Effect& effect : given_effects(effect_file_, table, description)) effects.push_back(std::move(effect));
    const auto convert = format_ == "mjcf" ? export_mjcf : format_ == "urdf" ? export_urdf : export_header;
    const ExportedModel model = convert(*robot, match.value, effects);
    write_file(output_, model.text);
    for (const std::string& line : model.left_out) fmt::print("left out: {}\n", line);
    if (model.effects > 0) fmt::print("effects that the controller feeds forward: {}\n", model.effects);
    fmt::print("wrote {}\n", output_);
    run.summary.add("format", format_);
    run.summary.add("parameters", robot->parameters());
    run.summary.add("effects", model.effects);
    run.summary.add("left_out", static_cast<int>(model.left_out.size()));
  }

  std::string robot_file_, parameter_file_, effect_file_, format_, output_;
};

}  // namespace deltadyn::tools
