#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <utility>

#include "deltadyn/firmware/effect_set.hpp"
#include "deltadyn/identification/effect_torque.hpp"
#include "deltadyn/runtime/changed_machine.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/geometry_of.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "export_parts.hpp"

namespace deltadyn {
namespace {

std::string list(const Eigen::VectorXd& v) {
  std::string words;
  for (Eigen::Index k = 0; k < v.size(); ++k) words += (k > 0 ? ", " : "") + model_export::text(v(k));
  return "{" + words + "}";
}

/// A C++ name from free text: "ABB IRB 360" -> "abb_irb_360".
std::string identifier(const std::string& words) {
  std::string name;
  for (const char c : words) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) != 0 && u < 128) {
      name += static_cast<char>(std::tolower(u));
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) != 0) name.insert(0, "robot_");
  return name + "_model";
}

constexpr int kMostEffects = 64;  // in one header; each costs time in every tick

/// Moves those that a controller cannot feed forward to what is left out, with the reason that the controller itself
/// gives.
template <class R>
void refuse_effects(const RobotDescription& robot, model_export::Parts& parts) {
  ChangedGeometry<float, R> machine(geometry_of<float, R>(robot));
  EffectSet<float, R, kMostEffects> set;
  std::vector<Effect> accepted;
  for (const Effect& effect : parts.effects) {
    const EffectRefusal refusal = set.add({effect.id, effect.joint, shape_of(effect), amplitudes_of(effect)}, machine);
    if (refusal == EffectRefusal::none) {
      accepted.push_back(effect);
    } else {
      parts.left_out.push_back(fmt::format("{}: {}", model_export::describe(effect, robot), message(refusal)));
    }
  }
  parts.effects = std::move(accepted);
}

/// A motion and its torque, so that the firmware can prove on its own machine that it computes what was identified.
struct Check {
  Eigen::VectorXd q, qd, qdd, tau;
};

/// The machine is changed where effects change it; all other effects are what the columns of the fit say, here of a
/// robot that stays at one state.
Eigen::VectorXd check_torque(const Robot& robot, const Eigen::VectorXd& p, const std::vector<Effect>& effects,
                             const Check& at) {
  ChangedMachine machine(robot.description());
  std::vector<Effect> laws;
  for (const Effect& effect : effects) {
    visit_effect(effect.id, [&](auto type) {
      using E = decltype(type);
      if constexpr (kIs<E, MachineChange>) {
        E::change(machine, effect.joint, amplitudes_of(effect), shape_of(effect));
      } else {
        laws.push_back(effect);
      }
    });
  }
  const auto changed = make_robot(machine.description, robot.parameter_options());
  constexpr int kSamples = 7;  // enough for differences
  PreparedLog log;
  log.file = robot.description().name;
  log.rate_hz = 1;
  log.t_s.setZero(kSamples);
  log.q = (at.q + machine.home_offset).transpose().replicate(kSamples, 1);
  log.qd = at.qd.transpose().replicate(kSamples, 1);
  log.qdd = at.qdd.transpose().replicate(kSamples, 1);
  const EffectModel model(*changed);
  EffectSignals signals = model.signals(log, p);
  signals.q = at.q.transpose().replicate(kSamples, 1);
  return (signals.torque + effect_torque(model, signals, laws, 1)).row(0);
}

Check check_of(const Robot& robot, const Eigen::VectorXd& p, const std::vector<Effect>& effects) {
  const int n = robot.drives();
  Check check{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  WorkspaceSampler sampler(robot);
  sampler.next(check.q, check.qd, check.qdd);
  if (!effects.empty()) {
    check.tau = check_torque(robot, p, effects, check);
  } else if (robot.inverse_dynamics(check.q, check.qd, check.qdd, p, check.tau) != Status::ok) {
    throw Error("no regular state was found", robot.description().name, "check the lengths in the robot file");
  }
  return check;
}

std::string list(const auto& numbers, std::size_t count) {
  std::string words;
  for (std::size_t k = 0; k < count; ++k) words += (k > 0 ? ", " : "") + model_export::text(numbers[k]);
  return "{" + words + "}";
}

/// The controller's type, and the table of effects if there are some.
std::string model_text(const RobotDescription& robot, const std::vector<Effect>& effects) {
  const std::string model = "\ntemplate <class T>\nusing Model = deltadyn::";
  if (effects.empty()) return model + "FeedForward<T, Robot, kSharing>;\n";
  std::string rows, names;
  std::vector<EffectId> listed;
  for (const Effect& effect : effects) {
    const EffectKind& kind = effect_kind(effect.id);
    const std::string name = fmt::format("deltadyn::effect_named(\"{}\")", kind.name);
    rows += fmt::format("    // {} at {}\n", kind.name, effect_joint_name(effect.id, effect.joint));
    for (std::size_t k = 0; k < kind.amplitudes.size(); ++k)
      rows += fmt::format("    //   {} {:.4g} {}\n", kind.amplitudes[k].name, amplitudes_of(effect)[k],
                          effect_unit(kind.amplitudes[k].unit, effect.joint, robot));
    if (const std::string shape = effect_shape_text(effect, robot); !shape.empty())
      rows += fmt::format("    //   {}\n", shape);
    rows +=
        fmt::format("    {{{}, {}, {},\n     {}}},\n", name, effect.joint, list(shape_of(effect), kind.shapes.size()),
                    list(amplitudes_of(effect), kind.amplitudes.size()));
    if (std::find(listed.begin(), listed.end(), effect.id) != listed.end()) continue;
    listed.push_back(effect.id);
    names += (names.empty() ? "" : ", ") + name;
  }
  return fmt::format(
      "\n// What the rigid model misses: effect, drive from 0 (-1: not on one drive), shape, amplitudes.\n"
      "inline constexpr deltadyn::EffectRow kEffects[] = {{\n{}}};\ninline constexpr int kEffectCount = {};\n"
      "using Effects = deltadyn::SomeEffects<{}>;\n{}EffectFeedForward<T, Robot, kSharing, kEffectCount, Effects>;\n",
      rows, effects.size(), names, model);
}

/// The parts of the plate: pose as a function of the turn theta, see PlatePart.
std::string parts_text(const RobotDescription& description) {
  std::string rows;
  std::vector<PlatePart<double>> parts = description.parts;
  if (parts.empty()) parts.emplace_back();  // an array needs an entry
  for (const PlatePart<double>& part : parts)
    rows += fmt::format("    {{{}, {}, {}, {}, {}}},\n", list(part.c), list(part.a), list(part.b),
                        model_export::text(part.kappa), model_export::text(part.turn));
  return fmt::format(
      "struct Part {{\n  double c[3], a[3], b[3], kappa, turn;\n}};\ninline constexpr Part kParts[] = {{\n{}}};\n"
      "inline constexpr double kYawRatio = {}, kThetaRange = {};\n",
      rows, model_export::text(description.plate ? description.plate->ratio : 1),
      model_export::text(description.plate ? description.plate->range : 1));
}

constexpr const char* kFunctions = R"(
/// Lengths and places in scalar T (float or double).
template <class T>
deltadyn::Geometry<T, Robot> geometry() {
  const auto vector = [](const double(&v)[3]) {
    return deltadyn::Vector3<T>(static_cast<T>(v[0]), static_cast<T>(v[1]), static_cast<T>(v[2]));
  };
  deltadyn::Geometry<T, Robot> g;
  for (int i = 0; i < Robot::kLimbs; ++i) {
    g.limbs[i].azimuth = static_cast<T>(kLimbs[i].azimuth);
    g.limbs[i].tilt = static_cast<T>(kLimbs[i].tilt);
    g.limbs[i].p_WD = vector(kLimbs[i].p_WD);
    g.limbs[i].axis_L = vector(kLimbs[i].axis_L);
    g.limbs[i].p_DE_0 = vector(kLimbs[i].p_DE_0);
    g.limbs[i].strut = static_cast<T>(kLimbs[i].strut);
    g.limbs[i].strut_spacing = static_cast<T>(kLimbs[i].strut_spacing);
    g.limbs[i].p_BA = vector(kLimbs[i].p_BA);
    g.limbs[i].part = kLimbs[i].part;
    g.limbs[i].elbow = static_cast<T>(kLimbs[i].elbow);
  }
  for (int k = 0; k < Robot::kPlateParts; ++k) {
    g.parts[k] = {vector(kParts[k].c), vector(kParts[k].a), vector(kParts[k].b), static_cast<T>(kParts[k].kappa),
                  static_cast<T>(kParts[k].turn)};
  }
  g.yaw_ratio = static_cast<T>(kYawRatio);
  g.theta_range = static_cast<T>(kThetaRange);
  if constexpr (Robot::kPlateTurns) g.mode = deltadyn::plate_mode(g);
  g.telescope.p_WU = vector(kTelescopeUpper);
  g.telescope.p_BV = vector(kTelescopeLower);
  g.gravity = vector(kGravity);
  return g;
}

/// The identified parameters in scalar T.
template <class T>
deltadyn::Vector<T, Layout::kColumns> parameters() {
  deltadyn::Vector<T, Layout::kColumns> p;
  for (int k = 0; k < Layout::kColumns; ++k) p(k) = static_cast<T>(kParameters[k]);
  return p;
}

/// Keep one for the life of the controller.
template <class T>
Model<T> feed_forward() {
  return Model<T>(geometry<T>(), parameters<T>()@EFFECTS@);
}

/// Largest difference of a torque, computed here, to what the identifying program computed [N m | N]; negative if the
/// computation failed. Some 1e-10 of the torque in double, 1e-3 in float.
template <class T>
T self_check() {
  deltadyn::Vector<T, Robot::kDrives> q, qd, qdd, tau;
  for (int i = 0; i < Robot::kDrives; ++i) {
    q(i) = static_cast<T>(kCheckPosition[i]);
    qd(i) = static_cast<T>(kCheckVelocity[i]);
    qdd(i) = static_cast<T>(kCheckAcceleration[i]);
  }
  Model<T> model = feed_forward<T>();@COMPLETE@
  if (model.from_drives(q, qd, qdd, tau) != deltadyn::Status::ok) return T(-1);
  T worst = T(0);
  for (int i = 0; i < Robot::kDrives; ++i) {
    const T difference = tau(i) - static_cast<T>(kCheckTorque[i]);
    const T size = difference < T(0) ? -difference : difference;
    if (!(size <= worst)) worst = size;
  }
  return worst;
}
)";

}  // namespace

ExportedModel export_header(const Robot& robot, const Eigen::VectorXd& p, const std::vector<Effect>& effects) {
  model_export::Parts parts = model_export::collect(robot, p, effects);
  const RobotDescription& description = robot.description();
  std::string type;
  with_robot_type(description, [&](auto robot_type) {
    type = decltype(robot_type)::kClass;
    refuse_effects<decltype(robot_type)>(description, parts);
  });
  // The firmware's layout has every column; those that were not identified are zero there.
  ParameterOptions options;
  options.individual_limbs = robot.parameter_options().individual_limbs;
  options.offset = true;
  for (int drive = 1; drive <= description.drives(); ++drive) options.rotor_inertia.push_back(drive);
  const auto full = make_robot(description, options);
  Eigen::VectorXd values(full->parameters());
  for (int k = 0; k < full->parameters(); ++k)
    values(k) = parts.value(full->parameter_names()[static_cast<std::size_t>(k)]);
  const Check check = check_of(*full, values, parts.effects);
  const std::string space = identifier(description.name.empty() ? description.type : description.name);

  std::string text = fmt::format(
      "#pragma once\n\n// {} \"{}\", written by deltadyn: identified model for feed-forward control. SI units, angles "
      "in rad.\n",
      description.type, description.name);
  text += model_export::left_out_comment(parts.left_out, "// ");
  text += fmt::format(
      "//\n//   auto model = {0}::feed_forward<float>();\n//   if (model.from_drives(q, qd, qdd, tau) == "
      "deltadyn::Status::ok) "
      "...\n\n"
      "#include <deltadyn/firmware/{3}feed_forward.hpp>\n"
      "#include <deltadyn/model/robot_types.hpp>\n\nnamespace {0} {{\n\nusing Robot = deltadyn::{1};\n"
      "inline constexpr deltadyn::Limbs kSharing = deltadyn::Limbs::{2};\n"
      "using Layout = deltadyn::ParameterLayout<Robot, kSharing>;\n\n",
      space, type, options.individual_limbs ? "individual" : "shared", parts.effects.empty() ? "" : "effect_");
  text +=
      "struct Limb {\n  double azimuth, tilt, p_WD[3], axis_L[3], p_DE_0[3], strut, strut_spacing, p_BA[3], elbow;\n  "
      "int part;\n};\n";
  text += "inline constexpr Limb kLimbs[] = {\n";
  for (const auto& limb : description.limbs) {
    text += fmt::format("    {{{}, {}, {}, {}, {}, {}, {}, {}, {}, {}}},\n", model_export::text(limb.azimuth),
                        model_export::text(limb.tilt), list(limb.p_WD), list(limb.axis_L), list(limb.p_DE_0),
                        model_export::text(limb.strut), model_export::text(limb.strut_spacing), list(limb.p_BA),
                        model_export::text(limb.elbow), limb.part);
  }
  text += "};\n" + parts_text(description);
  const TelescopeGeometry<double> bar = description.telescope.value_or(TelescopeGeometry<double>());
  text += fmt::format(
      "inline constexpr double kTelescopeUpper[3] = {};\ninline constexpr double kTelescopeLower[3] = {};\n"
      "inline constexpr double kGravity[3] = {};\n\n",
      list(bar.p_WU), list(bar.p_BV), list(description.gravity));
  text += "inline constexpr double kParameters[] = {\n";
  for (int k = 0; k < full->parameters(); ++k) {
    text += fmt::format("    {},  // {} [{}]\n", model_export::text(values(k)),
                        full->parameter_names()[static_cast<std::size_t>(k)],
                        full->parameter_units()[static_cast<std::size_t>(k)]);
  }
  text += "};\n\n// One motion and its torque, for self_check().\n";
  const auto check_line = [&text](const char* name, const Eigen::VectorXd& v) {
    text += fmt::format("inline constexpr double {}[] = {};\n", name, list(v));
  };
  check_line("kCheckPosition", check.q);
  check_line("kCheckVelocity", check.qd);
  check_line("kCheckAcceleration", check.qdd);
  check_line("kCheckTorque", check.tau);
  text +=
      "\nstatic_assert(sizeof(kLimbs) / sizeof(kLimbs[0]) == Robot::kLimbs, \"one entry a limb\");\n"
      "static_assert(sizeof(kParameters) / sizeof(kParameters[0]) == Layout::kColumns,\n"
      "              \"this header was written for another version of deltadyn: convert again\");\n";
  for (int body = 0;
       body < (full->parameters() - 2 * full->friction_joints() - 2 * full->drives()) / kInertialParameters; ++body) {
    const int column = kInertialParameters * body;
    if (values(column) > 0)
      text += fmt::format("static_assert(kParameters[{}] > 0, \"{} must have mass\");\n", column,
                          full->parameter_names()[static_cast<std::size_t>(column)]);
  }
  text += model_text(description, parts.effects);
  std::string functions = kFunctions;
  const auto fill_in = [&](const std::string& mark, const std::string& words) {
    functions.replace(functions.find(mark), mark.size(), parts.effects.empty() ? "" : words);
  };
  fill_in("@EFFECTS@", ", kEffects");
  fill_in("@COMPLETE@", "\n  if (model.effects() != kEffectCount) return T(-1);");
  text += functions;
  text += fmt::format("\n}}  // namespace {}\n", space);
  return {text, parts.left_out, static_cast<int>(parts.effects.size())};
}

}  // namespace deltadyn
