#pragma once

/// \file
/// `delta-model prior`: nominal parameters from simple shapes and materials.

#include <fmt/format.h>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "layout_flags.hpp"
#include "parameter_tables.hpp"
#include "tool_support.hpp"

namespace deltadyn::tools {

class Prior {
 public:
  void add_to(CLI::App& app, ToolRun& run) {
    CLI::App& c = *app.add_subcommand(
        "prior", "Nominal parameters from simple shapes and materials, scaled from the paper's robot.");
    set_example(c, "delta-model prior robot.urdf --platform-mass-kg 1.0 --tool-mass-kg 0.4 -o prior.csv");
    c.add_option("robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    c.add_option("-o,--output", output_, "parameter file to write (CSV name,value,unit,std)")
        ->required()
        ->type_name("FILE");
    layout_.add_bodies(c);
    for (Shape& shape : shapes_) c.add_option(shape.flag, shape.value, shape.help)->group("Shapes, masses, friction");
    run.on(c, [this, &run] { execute(run); });
  }

 private:
  void execute(ToolRun& run) {
    run.check_files({output_}, {robot_file_});
    const RobotDescription description = read_robot_file(robot_file_);
    const auto robot = make_robot(description, layout_.options(description));
    PartShapes shapes(description);
    for (const Shape& shape : shapes_) {
      if (!shape.value) continue;
      if (!has(description, shape.part))
        throw Error(fmt::format("{} does not belong to this {}, which has no {}", shape.flag, description.type,
                                kPartNames[shape.part]),
                    "", "leave it out", ExitCode::usage);
      shapes.*shape.member = *shape.value;
    }
    const NominalParameters nominal = nominal_parameters(*robot, shapes);
    const ParameterTable table = parameter_table(*robot, nominal);
    for (const ParameterEntry& entry : table.entries) {
      if (entry.name.size() <= 2 || entry.name.compare(entry.name.size() - 2, 2, ".m") != 0) continue;
      const std::string body = entry.name.substr(0, entry.name.size() - 2);
      fmt::print("  {:<18} {:8.3f} kg\n", body, entry.value);
      run.summary.add("mass_" + body, entry.value, "kg");
    }
    write_parameters(output_, table);
    fmt::print("wrote {}: {} nominal parameters\n", output_, table.entries.size());
    run.summary.add("columns", robot->parameters());
  }

  enum Part { arm, carriage, strut, platform, tool, telescope, halves, bars, any };
  static constexpr const char* kPartNames[] = {
      "upper arm", "carriage", "struts", "rigid plate", "tool", "telescope bar", "half plates", "crossbar", ""};

  /// A flag for a part that the robot does not have is a mistake, not a wish.
  [[nodiscard]] bool has(const RobotDescription& robot, Part part) const {
    switch (part) {
      case arm: return robot.drive_kind == DriveKind::revolute;
      case carriage: return robot.drive_kind == DriveKind::prismatic;
      case strut: return !robot.parts.empty();
      case platform: return !robot.parts.empty() && !robot.plate;
      case tool: return robot.plate || (robot.telescope && layout_.options(robot).tool);
      case halves: return robot.plate.has_value();
      case bars: return robot.plate && robot.plate->spacing > 0;
      case telescope: return robot.telescope.has_value();
      case any: break;
    }
    return true;
  }

  struct Shape {
    std::string flag, help;
    Part part;
    double PartShapes::*member;
    std::optional<double> value = {};
  };

  std::string robot_file_, output_;
  LayoutFlags layout_;
  std::vector<Shape> shapes_ = {
      {"--upper-arm-outer-diameter-m", "tube of the upper arm [m]", arm, &PartShapes::upper_arm_outer_diameter},
      {"--upper-arm-wall-m", "its wall [m]", arm, &PartShapes::upper_arm_wall},
      {"--upper-arm-density-kg-m3", "its density [kg/m^3], carbon fibre 1600", arm, &PartShapes::upper_arm_density},
      {"--upper-arm-hub-mass-kg", "hub about the drive axis [kg], 0: none", arm, &PartShapes::upper_arm_hub_mass},
      {"--upper-arm-hub-diameter-m", "its diameter [m]", arm, &PartShapes::upper_arm_hub_diameter},
      {"--upper-arm-hub-width-m", "its width along the axis [m]", arm, &PartShapes::upper_arm_hub_width},
      {"--carriage-mass-kg", "carriage of a prismatic drive [kg]", carriage, &PartShapes::carriage_mass},
      {"--carriage-diameter-m", "its diameter [m]", carriage, &PartShapes::carriage_diameter},
      {"--carriage-length-m", "its length along the rail [m]", carriage, &PartShapes::carriage_length},
      {"--strut-outer-diameter-m", "tube of a strut [m]", strut, &PartShapes::strut_outer_diameter},
      {"--strut-wall-m", "its wall [m]", strut, &PartShapes::strut_wall},
      {"--strut-density-kg-m3", "its density [kg/m^3]", strut, &PartShapes::strut_density},
      {"--strut-sockets-mass-kg", "both sockets of one strut [kg], 0: none; default as heavy as the tube", strut,
       &PartShapes::strut_sockets_mass},
      {"--strut-socket-diameter-m", "their diameter [m]", strut, &PartShapes::strut_socket_diameter},
      {"--strut-socket-length-m", "their length [m]", strut, &PartShapes::strut_socket_length},
      {"--platform-mass-kg", "travelling plate [kg]", platform, &PartShapes::platform_mass},
      {"--platform-diameter-m", "its diameter [m]", platform, &PartShapes::platform_diameter},
      {"--platform-thickness-m", "its thickness [m]", platform, &PartShapes::platform_thickness},
      {"--tool-mass-kg", "tool [kg]", tool, &PartShapes::tool_mass},
      {"--tool-diameter-m", "its diameter [m]", tool, &PartShapes::tool_diameter},
      {"--tool-length-m", "its length below the plate's centre [m]", tool, &PartShapes::tool_length},
      {"--half-plate-mass-kg", "half of an articulated plate [kg]", halves, &PartShapes::half_plate_mass},
      {"--half-plate-diameter-m", "its thickness [m]", halves, &PartShapes::half_plate_diameter},
      {"--crossbar-mass-kg", "bar between the halves [kg]", bars, &PartShapes::crossbar_mass},
      {"--crossbar-diameter-m", "its thickness [m]", bars, &PartShapes::crossbar_diameter},
      {"--telescope-mass-kg", "both parts of the telescope bar [kg]", telescope, &PartShapes::telescope_mass},
      {"--telescope-upper-share", "share of the upper part in that mass, the paper's is 0.6", telescope,
       &PartShapes::telescope_upper_share},
      {"--telescope-upper-length-m", "solid rod of the upper part [m]", telescope, &PartShapes::telescope_upper_length},
      {"--telescope-upper-diameter-m", "its diameter [m]", telescope, &PartShapes::telescope_upper_diameter},
      {"--telescope-lower-length-m", "tube of the lower part [m]", telescope, &PartShapes::telescope_lower_length},
      {"--telescope-lower-outer-diameter-m", "its outer diameter [m]", telescope,
       &PartShapes::telescope_lower_outer_diameter},
      {"--telescope-lower-inner-diameter-m", "its inner diameter [m]", telescope,
       &PartShapes::telescope_lower_inner_diameter},
      {"--drive-viscous", "friction of a limb's drive [N m s/rad or N s/m]", any, &PartShapes::drive_viscous},
      {"--drive-coulomb", "the same [N m or N]", any, &PartShapes::drive_coulomb},
      {"--telescope-drive-viscous-Nm-s-rad", "friction of the telescope's drive [N m s/rad]", telescope,
       &PartShapes::telescope_drive_viscous},
      {"--telescope-drive-coulomb-Nm", "the same [N m]", telescope, &PartShapes::telescope_drive_coulomb},
      {"--telescope-viscous-N-s-m", "friction of the sliding bar [N s/m]", telescope, &PartShapes::telescope_viscous},
      {"--telescope-coulomb-N", "the same [N]", telescope, &PartShapes::telescope_coulomb},
      {"--plate-viscous-Nm-s-rad", "friction of all joints of an articulated plate, by its turn [N m s/rad]", halves,
       &PartShapes::plate_viscous},
      {"--plate-coulomb-Nm", "the same [N m]", halves, &PartShapes::plate_coulomb},
      {"--body-std", "assumed standard deviation of masses and moments as a share of the value, default 0.5", any,
       &PartShapes::body_std},
      {"--friction-std", "of the friction, default 1", any, &PartShapes::friction_std},
  };
};

}  // namespace deltadyn::tools
