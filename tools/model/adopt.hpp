#pragma once

/// \file
/// `delta-model adopt`: a robot file from the URDF of a CAD program.

#include <fmt/format.h>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/io/adopt.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "model/create.hpp"
#include "parameter_tables.hpp"
#include "tool_support.hpp"

namespace deltadyn::tools {

class Adopt {
 public:
  void add_to(CLI::App& app, ToolRun& run) {
    CLI::App& c = *app.add_subcommand("adopt",
                                      "Make a robot file from a CAD program's URDF: limbs, struts and plate are found "
                                      "by structure; any names and frames.");
    set_example(c,
                "delta-model adopt cad.urdf -o robot.urdf --prior-out prior.csv\n"
                "  delta-model adopt cad.urdf -o robot.urdf --length-unit mm --strut-spacing 0.1 --drives J1,J4,J7");
    c.add_option("cad", cad_file_, "URDF of the CAD program, assembled with all joints at zero")
        ->required()
        ->type_name("CAD");
    c.add_option("-o,--output", output_, "robot file to write")->required()->type_name("FILE");
    c.add_option("--prior-out", prior_,
                 "parameter file from the masses and inertias of the CAD (CSV name,value,unit,std)")
        ->type_name("FILE");
    c.add_option("--body-std", body_std_, "its standard deviations of masses and moments, as a share of the value")
        ->capture_default_str();
    c.add_option("--length-unit", length_unit_, "unit of the file's lengths: m, cm, mm or inch")
        ->check(CLI::IsMember({"m", "cm", "mm", "inch"}))
        ->capture_default_str();
    c.add_option("--mass-unit", mass_unit_, "unit of the file's masses: kg or g")
        ->check(CLI::IsMember({"kg", "g"}))
        ->capture_default_str();
    const std::string found = " [found]";
    c.add_option("--drives", options_.drives, "joints of the drives in their order, limbs first" + found)
        ->delimiter(',')
        ->type_name("JOINT,...");
    c.add_option("--plate", options_.plate, "a link of the travelling plate, where no strut carries it" + found)
        ->type_name("LINK");
    c.add_option("--plate-frame", options_.plate_frame,
                 "link whose origin is the plate's centre [middle of the attachments]")
        ->type_name("LINK");
    c.add_option("--strut", options_.strut, "ball centre to ball centre [m]" + found);
    c.add_option("--strut-spacing", options_.strut_spacing,
                 "between the two struts of a limb, where they are one link [m]" + found);
    c.add_option("--platform-radius", options_.platform_radius,
                 "attachments of the limbs from the plate's centre [m]" + found);
    c.add_option("--gravity-m-s2", options_.gravity_size, "size of gravity [m/s^2], default 9.81");
    c.add_option("--gravity-direction", gravity_direction_,
                 "x,y,z in the robot's base (z from plate to base), default 0,0,-1")
        ->delimiter(',')
        ->type_name("X,Y,Z");
    run.on(c, [this, &run] { execute(run); });
  }

 private:
  void execute(ToolRun& run) {
    run.check_files({output_, prior_}, {cad_file_});
    const std::map<std::string, double> units = {{"m", 1},         {"cm", 0.01}, {"mm", 0.001},
                                                 {"inch", 0.0254}, {"kg", 1},    {"g", 0.001}};
    options_.length_unit = units.at(length_unit_);
    options_.mass_unit = units.at(mass_unit_);
    if (!gravity_direction_.empty())
      options_.gravity_direction = direction_of(gravity_direction_, "--gravity-direction");
    const AdoptedRobot adopted = adopt_robot(read_robot_text(cad_file_), cad_file_, options_);
    for (const std::string& note : adopted.notes) fmt::print("note: {}\n", note);
    for (std::size_t k = 0; k < adopted.drives.size(); ++k) tell_drive(k, adopted, run.summary);
    write_robot_file(output_, adopted.robot, adopted.parameters);
    if (!prior_.empty()) write_prior(adopted);
    fmt::print("wrote {}: {} with {} drives; delta-model info {} shows its lengths\n", output_, adopted.robot.type,
               adopted.robot.drives(), output_);
    run.summary.add("type", adopted.robot.type);
    run.summary.add("drives", adopted.robot.drives());
    run.summary.add("notes", static_cast<int>(adopted.notes.size()));
  }

  static void tell_drive(std::size_t k, const AdoptedRobot& adopted, Summary& summary) {
    const AdoptedDrive& drive = adopted.drives[k];
    const bool slides = adopted.robot.kind_of_drive(static_cast<int>(k)) == DriveKind::prismatic;
    const char* unit = slides ? "m" : "rad";
    fmt::print("drive {}: joint {}, q{} = {}q_joint {} {:.9g} {}\n", k + 1, drive.joint, k + 1,
               drive.sign < 0 ? "-" : "", drive.offset < 0 ? "-" : "+", std::abs(drive.offset), unit);
    summary.add(fmt::format("drive{}_sign", k + 1), drive.sign);
    summary.add(fmt::format("drive{}_offset", k + 1), drive.offset, unit);
  }

  /// What the CAD knows, and for the rest (friction, bodies without mass) what delta-model prior would write.
  void write_prior(const AdoptedRobot& adopted) const {
    const auto robot = make_robot(adopted.robot);
    PartShapes shapes(adopted.robot);
    const NominalParameters nominal = nominal_parameters(*robot, shapes);
    ParameterTable table = parameter_table(*robot, nominal);
    int from_cad = 0;
    for (ParameterEntry& entry : table.entries) {
      const auto found = adopted.parameters.find(entry.name);
      if (found == adopted.parameters.end()) continue;
      entry.value = found->second;
      entry.std = 0;
      ++from_cad;
    }
    set_spreads(table);
    write_parameters(prior_, table);
    fmt::print("wrote {}: {} of {} parameters from the CAD, the others by shapes as delta-model prior has them\n",
               prior_, from_cad, table.entries.size());
  }

  /// Standard deviations of what came from the CAD: a share of the moments (nominal_parameters.hpp says why of their
  /// means).
  void set_spreads(ParameterTable& table) const {
    for (std::size_t k = 0; k + kInertialParameters <= table.entries.size();) {
      const std::string& name = table.entries[k].name;
      if (name.size() < 2 || name.compare(name.size() - 2, 2, ".m") != 0 || table.entries[k].std != 0) {
        ++k;
        continue;
      }
      InertialVector<double> p;
      for (int j = 0; j < kInertialParameters; ++j) p(j) = table.entries[k + static_cast<std::size_t>(j)].value;
      const InertialVector<double> std = inertial_std(p, body_std_);
      for (int j = 0; j < kInertialParameters; ++j) table.entries[k + static_cast<std::size_t>(j)].std = std(j);
      k += kInertialParameters;
    }
  }

  std::string cad_file_, output_, prior_, length_unit_ = "m", mass_unit_ = "kg";
  double body_std_ = 0.1;  // a drawing knows the shapes, not screws, cables and glue
  AdoptOptions options_;
  std::vector<double> gravity_direction_;
};

}  // namespace deltadyn::tools
