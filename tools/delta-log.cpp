/// \file
/// delta-log: logs of these tools from what drives and recorders export.

#include "log/import.hpp"

int main(int argc, char** argv) {
  deltadyn::tools::Import import;
  return deltadyn::tools::run_tool(argc, argv,
                                   {"delta-log", "Logs: read what drives and recorders export.",
                                    "delta-log import export.csv --robot robot.urdf --map-out map.toml -o log.csv\n"
                                    "  delta-log import export.csv --robot robot.urdf --map map.toml -o log.csv"},
                                   [&](CLI::App& app, deltadyn::tools::ToolRun& run) {
                                     app.require_subcommand(1);
                                     import.add_to(app, run);
                                   });
}
