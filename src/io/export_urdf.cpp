#include <Eigen/Geometry>
#include <cmath>
#include <fmt/format.h>

#include "export_parts.hpp"
#include "robot_file_format.hpp"

namespace deltadyn {
namespace {

/// Rotor inertias of the limbs as inertia of the bodies on their axes, where that gives the same torque.
void add_rotor_inertias(const RobotDescription& robot, model_export::Parts& parts) {
  for (std::size_t i = 0; i < robot.limbs.size(); ++i) {
    const std::string drive = robot_file::drive_name(i) + ".rotor_inertia";
    const double rotor = parts.value(drive);
    if (rotor == 0) continue;
    const std::string arm = fmt::format("upper_arm{}", i + 1);
    InertialVector<double> p = parts.body("upper_arm", arm);
    if (!(p(0) > 0) || rotor < 0) {
      parts.left_out.push_back(fmt::format("{} = {}: there is no mass to put it on", drive, rotor));
      continue;
    }
    if (robot.drive_kind == DriveKind::revolute) {
      // A thin ring about the drive's axis y: adds no mass, and keeps the body physically consistent.
      p(inertial::kIyy) += rotor;
      p(inertial::kIxx) += rotor / 2;
      p(inertial::kIzz) += rotor / 2;
    } else {
      const LimbGeometry<double>& limb = robot.limbs[i];
      const Vector3<double> axis = limb_frame(limb) * limb.axis_L;
      if (std::abs(axis.dot(robot.gravity)) > 1e-9 * robot.gravity.norm()) {
        parts.left_out.push_back(fmt::format("{} = {} kg: on a carriage it would weigh", drive, rotor));
        continue;
      }
      p(inertial::kM) += rotor;
    }
    for (int k = 0; k < kInertialParameters; ++k) parts.values[arm + "." + kInertialNames[k]] = p(k);
  }
}

/// A body whose ten parameters are zero has no <inertial> element.
void drop_bodies_without_mass(model_export::Parts& parts) {
  std::vector<std::string> empty;
  for (const auto& [name, value] : parts.values) {
    const auto id = parameter_id(name);
    if (id && id->kind == ParameterKind::inertial && parts.value(owner_name(*id) + ".m") == 0) empty.push_back(name);
  }
  for (const std::string& name : empty) parts.values.erase(name);
}

}  // namespace

ExportedModel export_urdf(const Robot& robot, const Eigen::VectorXd& p, const std::vector<Effect>& effects) {
  model_export::Parts parts = model_export::collect(robot, p, effects);
  const RobotDescription& description = robot.description();
  model_export::leave_effects_out(description, parts);
  add_rotor_inertias(description, parts);
  drop_bodies_without_mass(parts);
  for (int drive = 1; drive <= description.drives(); ++drive) {
    const std::string name = fmt::format("drive{}.offset", drive);
    if (const double offset = parts.value(name); offset != 0)
      parts.left_out.push_back(fmt::format("{} = {}: URDF has no constant torque", name, offset));
  }
  if (!description.parts.empty())
    parts.left_out.emplace_back(
        "the loops, for plain URDF readers: they are <loop> elements (URDF+), which those skip");
  std::string text = robot_to_urdf(description, parts.values);
  if (!parts.left_out.empty()) {
    const auto place = text.find("<robot");
    text.insert(place, "<!--\n" + model_export::left_out_comment(parts.left_out, "  ") + "-->\n");
  }
  return {text, parts.left_out, 0};
}

}  // namespace deltadyn
