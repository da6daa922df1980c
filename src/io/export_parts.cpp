#include "export_parts.hpp"

#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn::model_export {

namespace {

/// True if the effect is one of the parameters and was added to it.
bool add_as_parameter(const Effect& effect, NamedValues& values) {
  if (effect.joint < 0 || effect.amplitude.size() < 1) return false;
  const std::string drive = fmt::format("drive{}", effect.joint + 1);
  switch (effect_kind(effect.id).base_term) {
    case BaseTerm::rotor_inertia: values[drive + ".rotor_inertia"] += effect.amplitude(0); return true;
    case BaseTerm::offset: values[drive + ".offset"] += effect.amplitude(0); return true;
    default: return false;
  }
}

}  // namespace

InertialVector<double> Parts::body(const std::string& shared, const std::string& own) const {
  const bool individual = !own.empty() && values.count(own + ".m") != 0;
  return robot_file::body_of(values, individual ? own : shared);
}

Parts collect(const Robot& robot, const Eigen::VectorXd& p, const std::vector<Effect>& effects) {
  const auto& names = robot.parameter_names();
  if (p.size() != robot.parameters())
    throw Error(fmt::format("{} parameters were given, but the robot has {}", p.size(), robot.parameters()),
                robot.description().name, "", ExitCode::usage);
  Parts parts;
  for (Eigen::Index k = 0; k < p.size(); ++k) {
    const std::string& name = names[static_cast<std::size_t>(k)];
    if (!std::isfinite(p(k)))
      throw Error(fmt::format("parameter {} is not finite", name), "", "mend the parameter file");
    parts.values[name] = p(k);
  }
  for (const Effect& effect : effects) {
    if (!add_as_parameter(effect, parts.values)) parts.effects.push_back(effect);
  }
  for (const ParameterId& id : robot.parameter_ids()) {
    if (id.kind != ParameterKind::inertial || id.entry != inertial::kM) continue;
    const std::string body = owner_name(id);
    const InertialVector<double> ten = parts.body(body);
    if (ten.cwiseAbs().maxCoeff() > 0 && !(ten(0) > 0))
      throw Error(fmt::format("body {} has mass {} kg", body, ten(0)), "",
                  "give physically consistent parameters, e.g. those of delta-identify");
  }
  return parts;
}

std::string describe(const Effect& effect, const RobotDescription& robot) {
  const std::string shape = effect_shape_text(effect, robot);
  return fmt::format("effect {} at {}{}", effect_kind(effect.id).name, effect_joint_name(effect.id, effect.joint),
                     shape.empty() ? "" : " (" + shape + ")");
}

void leave_effects_out(const RobotDescription& robot, Parts& parts) {
  for (const Effect& effect : parts.effects)
    parts.left_out.push_back(describe(effect, robot) +
                             ": the format holds viscous and Coulomb friction, offsets and rotors only");
}

std::string left_out_comment(const std::vector<std::string>& left_out, const std::string& prefix) {
  if (left_out.empty()) return {};
  std::string lines = prefix + "Not held by this file:\n";
  for (const std::string& line : left_out) lines += prefix + "  " + line + "\n";
  return lines;
}

}  // namespace deltadyn::model_export
