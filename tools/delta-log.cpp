/// \file
/// delta-log: logs of these tools from what drives and recorders export.

#include "log/check.hpp"
#include "log/import.hpp"

int main(int argc, char** argv) {
  deltadyn::tools::Import import;
  deltadyn::tools::Check check;
  return deltadyn::tools::run_tool(
      argc, argv,
      {"delta-log", "Logs: read what drives and recorders export, and check logs before anything is made of them.",
       "delta-log import export.csv --robot robot.urdf --map-out map.toml -o log.csv\n"
       "  delta-log import export.csv --robot robot.urdf --map map.toml -o log.csv\n"
       "  delta-log check fast.csv slow.csv --robot robot.urdf --report check.html"},
      [&](CLI::App& app, deltadyn::tools::ToolRun& run) {
        app.require_subcommand(1);
        import.add_to(app, run);
        check.add_to(app, run, deltadyn::tools::command_line(argc, argv));
      });
}
