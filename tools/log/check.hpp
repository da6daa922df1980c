#pragma once

/// \file
/// `delta-log check`: what is wrong with logs, by name, before anything is made of them.

#include <fmt/format.h>
#include <string>
#include <vector>

#include "deltadyn/io/log_file.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/report/log_report.hpp"
#include "deltadyn/report/log_table.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"

#include "log_gate.hpp"
#include "prior_reading.hpp"
#include "processing_flags.hpp"
#include "tool_support.hpp"

namespace deltadyn::tools {

class Check {
 public:
  void add_to(CLI::App& app, ToolRun& run, const std::string& command_line) {
    command_line_ = command_line;
    CLI::App& c =
        *app.add_subcommand("check",
                            "The gate before the fit: rate, gaps and noise of the channels; delay between torque and "
                            "position; signs, order, units and "
                            "zeros of the drives; scale of the torque against the prior's masses; given derivatives. "
                            "Exit code 5 if a fault is found.");
    set_example(c, "delta-log check fast.csv slow.csv --robot robot.urdf --prior prior.csv --report check.html");
    c.add_option("logs", log_files_, "logs of this robot (CSV, or what delta-log import reads)")
        ->required()
        ->type_name("LOG");
    c.add_option("--robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    c.add_option("--prior", prior_file_,
                 "prior parameters name,value,unit[,std] (CSV) [simple shapes, as delta-model prior]")
        ->type_name("FILE");
    c.add_option("--report", report_file_, "report (HTML)")->type_name("FILE");
    gate_.add_to(c);
    processing_.add_to(c);
    run.on(c, [this, &run] { return execute(run); });
  }

 private:
  ExitCode execute(ToolRun& run) {
    std::vector<std::string> inputs = log_files_;
    inputs.insert(inputs.end(), {robot_file_, prior_file_});
    run.check_files({report_file_}, inputs);
    const RobotDescription description = read_robot_file(robot_file_);
    ParameterOptions layout;
    layout.offset = description.type == Axis::kName;  // as delta-identify has it
    const auto robot = make_robot(description, layout);
    const Prior prior = read_prior(*robot, prior_file_);
    const GateResult gate = gate_.run(*robot, processing_.read_logs(log_files_, description), prior.value, prior.std,
                                      !prior_file_.empty(), !processing_.options().filter, run.summary, true);
    if (!report_file_.empty()) {
      const ReportContext context{robot_file_, log_files_, prior_file_, command_line_, all_findings(gate)};
      write_file(report_file_, log_report(*robot, gate.logs, context));
      fmt::print("wrote {}\n", report_file_);
    }
    for (const LogFigures& log : log_figures(gate.logs)) {
      for (const std::string& line : channel_lines(description, log)) fmt::print("{}\n", line);
    }
    fmt::print("verdict: {}\n", check_verdict_in_words(tools::all_findings(gate)));
    return gate.fault() ? ExitCode::not_trusted : ExitCode::done;
  }

  std::string command_line_, robot_file_, prior_file_, report_file_;
  std::vector<std::string> log_files_;
  LogGate gate_;
  ProcessingFlags processing_;
};

}  // namespace deltadyn::tools
