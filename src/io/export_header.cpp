#include <Eigen/Geometry>
#include <cctype>
#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"
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

const char* type_name(const RobotDescription& robot) {
  if (robot.type == Delta3::kName) return "Delta3";
  if (robot.type == LinearDelta3::kName) return "LinearDelta3";
  if (robot.type == Delta4::kName) return "Delta4";
  if (robot.type == Axis::kName) return robot.drive_kind == DriveKind::prismatic ? "LinearAxis" : "Axis";
  throw Error(fmt::format("robots of type {} cannot be written as a header", robot.type), robot.name, "");
}

/// A motion and its torque, so that the firmware can prove on its own machine that it computes what was identified.
struct Check {
  Eigen::VectorXd q, qd, qdd, tau;
};
Check check_of(const Robot& robot, const Eigen::VectorXd& p) {
  const int n = robot.drives();
  Check check{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  WorkspaceSampler sampler(robot);
  sampler.next(check.q, check.qd, check.qdd);
  if (robot.inverse_dynamics(check.q, check.qd, check.qdd, p, check.tau) != Status::ok)
    throw Error("no regular state was found", robot.description().name, "check the lengths in the robot file");
  return check;
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
    g.limbs[i].p_WD = vector(kLimbs[i].p_WD);
    g.limbs[i].axis_L = vector(kLimbs[i].axis_L);
    g.limbs[i].p_DE_0 = vector(kLimbs[i].p_DE_0);
    g.limbs[i].strut = static_cast<T>(kLimbs[i].strut);
    g.limbs[i].strut_spacing = static_cast<T>(kLimbs[i].strut_spacing);
    g.limbs[i].p_BA = vector(kLimbs[i].p_BA);
    g.limbs[i].elbow = static_cast<T>(kLimbs[i].elbow);
  }
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

/// Keep one for the life of the controller; see firmware/feed_forward.hpp.
template <class T>
deltadyn::FeedForward<T, Robot, kSharing> feed_forward() {
  return deltadyn::FeedForward<T, Robot, kSharing>(geometry<T>(), parameters<T>());
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
  if (feed_forward<T>().from_drives(q, qd, qdd, tau) != deltadyn::Status::ok) return T(-1);
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
  const model_export::Parts parts = model_export::collect(robot, p, effects);
  const RobotDescription& description = robot.description();
  // The firmware's layout has every column; those that were not identified are zero there.
  ParameterOptions options;
  options.individual_limbs = robot.parameter_options().individual_limbs;
  options.offset = true;
  for (int drive = 1; drive <= description.drives(); ++drive) options.rotor_inertia.push_back(drive);
  const auto full = make_robot(description, options);
  Eigen::VectorXd values(full->parameters());
  for (int k = 0; k < full->parameters(); ++k) values(k) = parts.value(full->parameter_names()[static_cast<std::size_t>(k)]);
  const Check check = check_of(*full, values);
  const std::string space = identifier(description.name.empty() ? description.type : description.name);

  std::string text = fmt::format(
      "#pragma once\n\n// {} \"{}\", written by deltadyn: identified model for feed-forward control. SI units, angles in rad.\n",
      description.type, description.name);
  text += model_export::left_out_comment(parts.left_out, "// ");
  text += fmt::format(
      "//\n//   auto model = {0}::feed_forward<float>();\n//   if (model.from_drives(q, qd, qdd, tau) == deltadyn::Status::ok) "
      "...\n\n"
      "#include <deltadyn/firmware/feed_forward.hpp>\n\nnamespace {0} {{\n\nusing Robot = deltadyn::{1};\n"
      "inline constexpr deltadyn::Limbs kSharing = deltadyn::Limbs::{2};\n"
      "using Layout = deltadyn::ParameterLayout<Robot, kSharing>;\n\n",
      space, type_name(description), options.individual_limbs ? "individual" : "shared");
  text += "struct Limb {\n  double azimuth, p_WD[3], axis_L[3], p_DE_0[3], strut, strut_spacing, p_BA[3], elbow;\n};\n";
  text += "inline constexpr Limb kLimbs[] = {\n";
  for (const auto& limb : description.limbs) {
    text += fmt::format("    {{{}, {}, {}, {}, {}, {}, {}, {}}},\n", model_export::text(limb.azimuth), list(limb.p_WD),
                        list(limb.axis_L), list(limb.p_DE_0), model_export::text(limb.strut),
                        model_export::text(limb.strut_spacing), list(limb.p_BA), model_export::text(limb.elbow));
  }
  const TelescopeGeometry<double> bar = description.telescope.value_or(TelescopeGeometry<double>());
  text += fmt::format(
      "}};\ninline constexpr double kTelescopeUpper[3] = {};\ninline constexpr double kTelescopeLower[3] = {};\n"
      "inline constexpr double kGravity[3] = {};\n\n",
      list(bar.p_WU), list(bar.p_BV), list(description.gravity));
  text += "inline constexpr double kParameters[] = {\n";
  for (int k = 0; k < full->parameters(); ++k) {
    text +=
        fmt::format("    {},  // {} [{}]\n", model_export::text(values(k)), full->parameter_names()[static_cast<std::size_t>(k)],
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
  for (int body = 0; body < (full->parameters() - 2 * full->friction_joints() - 2 * full->drives()) / kInertialParameters;
       ++body) {
    const int column = kInertialParameters * body;
    if (values(column) > 0)
      text += fmt::format("static_assert(kParameters[{}] > 0, \"{} must have mass\");\n", column,
                          full->parameter_names()[static_cast<std::size_t>(column)]);
  }
  text += kFunctions;
  text += fmt::format("\n}}  // namespace {}\n", space);
  return {text, parts.left_out};
}

}  // namespace deltadyn
