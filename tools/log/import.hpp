#pragma once

/// \file
/// `delta-log import`: a log of these tools from what drives and recorders export.

#include <fmt/format.h>
#include <string>

#include "deltadyn/io/log_file.hpp"
#include "deltadyn/io/robot_file.hpp"

#include "tool_support.hpp"

namespace deltadyn::tools {

class Import {
 public:
  void add_to(CLI::App& app, ToolRun& run) {
    CLI::App& c = *app.add_subcommand("import", "A log of these tools from what drives and recorders export.");
    set_example(c, "delta-log import export.csv --robot robot.urdf -o log.csv");
    c.add_option("log", file_, "file to read")->required()->type_name("FILE");
    c.add_option("--robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    c.add_option("-o,--output", output_, "log to write (CSV)")->required()->type_name("FILE");
    run.on(c, [this, &run] { execute(run); });
  }

 private:
  void execute(ToolRun& run) {
    run.check_files({output_}, {file_, robot_file_});
    const RobotDescription robot = read_robot_file(robot_file_);
    LogReadOptions options;
    options.check = false;  // the log is written as it was recorded; the tools that use it check it
    const Log log = read_log(file_, robot, options);
    for (const std::string& note : log.notes) fmt::print("note: {}\n", note);
    write_log(output_, log, robot);
    fmt::print("wrote {}: {} rows\n", output_, log.samples());
    run.summary.add("samples", static_cast<double>(log.samples()));
  }

  std::string file_, robot_file_, output_;
};

}  // namespace deltadyn::tools
