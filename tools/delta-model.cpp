/// \file
/// delta-model: robot files from a few lengths or from a CAD program, what they can do, nominal parameters for them,
/// and identified models for others.

#include "model/adopt.hpp"
#include "model/convert.hpp"
#include "model/create.hpp"
#include "model/info.hpp"
#include "model/prior.hpp"

int main(int argc, char** argv) {
  deltadyn::tools::Create create;
  deltadyn::tools::Adopt adopt;
  deltadyn::tools::Info info;
  deltadyn::tools::Prior prior;
  deltadyn::tools::Convert convert;
  return deltadyn::tools::run_tool(argc, argv,
                                   {"delta-model",
                                    "Robot files of Delta-like robots: make them, look at them, guess their "
                                    "parameters, and hand identified ones on.",
                                    "delta-model create delta4 --base-radius 0.2 --platform-radius 0.05 --upper-arm "
                                    "0.525 --strut 1.106 -o robot.urdf\n"
                                    "  delta-model adopt cad.urdf -o robot.urdf\n"
                                    "  delta-model info robot.urdf\n"
                                    "  delta-model prior robot.urdf -o prior.csv\n"
                                    "  delta-model convert robot.urdf --params params.csv --to mjcf -o robot.xml"},
                                   [&](CLI::App& app, deltadyn::tools::ToolRun& run) {
                                     app.require_subcommand(1);
                                     create.add_to(app, run);
                                     adopt.add_to(app, run);
                                     info.add_to(app, run);
                                     prior.add_to(app, run);
                                     convert.add_to(app, run);
                                   });
}
