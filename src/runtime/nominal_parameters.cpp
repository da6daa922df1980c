#include "deltadyn/runtime/nominal_parameters.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "deltadyn/model/shapes.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/plausibility.hpp"

namespace deltadyn {
namespace {

using Ten = InertialVector<double>;
using Vec = Vector3<double>;

// Lengths of the paper's robot, the reference of all scaling. The arm's 0.525 m (0.500 m of it carbon) and the plate's
// radius are assumed, the strut's length is given.
constexpr double kPaperArm = 0.525;
constexpr double kPaperStrut = 1.106;
constexpr double kPaperPlate = 0.05;

[[noreturn]] void refuse(const std::string& what, const std::string& mend) {
  throw Error(what, "", mend, ExitCode::usage);
}

void require_positive(double value, const std::string& what) {
  if (!(std::isfinite(value) && value > 0))
    refuse(fmt::format("{} is {}, but must be positive", what, value),
           "give a value above 0, or leave it to the default");
}

void require_not_negative(double value, const std::string& what) {
  if (!(std::isfinite(value) && value >= 0))
    refuse(fmt::format("{} is {}, but must not be negative", what, value),
           "give 0 or more, or leave it to the default");
}

double arm_length(const LimbGeometry<double>& limb) {
  const double length = limb.p_DE_0.norm();
  return length > 0 ? length : 0.1;  // an axis without an arm: a short stub
}

/// From the plate's centre to the attachment of limb 1, an articulated plate in its middle.
double plate_radius(const RobotDescription& robot) {
  const LimbGeometry<double>& limb = robot.limbs.front();
  const Vec offset = robot.plate ? robot.parts[static_cast<std::size_t>(limb.part)].a : Vec(Vec::Zero());
  return (limb.p_BA + offset).head<2>().norm();
}

/// A part that is thicker than it is long is a length in another unit: half its length, and 5 cm for parts that are
/// short.
void require_thin(double thickness, double length, const std::string& what) {
  plausibility::require(plausibility::kDiameter, thickness, what, "", ExitCode::usage);
  const double most = 0.5 * length + 0.05;
  if (thickness > most)
    refuse(fmt::format("{} is {:.6g} m, which does not go with a length of {:.6g} m", what, thickness, length),
           "give it in metres");
}

/// Tube from its density.
Ten tube(double density, double diameter, double wall, const Vec& from, const Vec& to, const std::string& part) {
  require_positive(density, "the density of the " + part);
  require_positive(diameter, "the diameter of the " + part);
  require_positive(wall, "the wall of the " + part);
  plausibility::require(plausibility::kDensity, density, "the density of the " + part, "", ExitCode::usage);
  require_thin(diameter, (to - from).norm(), "the diameter of the " + part);
  const double outer = diameter / 2;
  if (wall > outer)
    refuse(fmt::format("the wall of the {}, {} m, is thicker than half its diameter {} m", part, wall, diameter),
           "give it in metres");
  return shapes::hollow_cylinder<double>(shapes::cylinder_mass(density, outer, outer - wall, (to - from).norm()), outer,
                                         outer - wall, from, to);
}

Ten round(double mass, double outer_diameter, double inner_diameter, const Vec& from, const Vec& to,
          const std::string& part) {
  const double length = (to - from).norm();
  require_positive(mass, "the mass of the " + part);
  require_positive(outer_diameter, "the diameter of the " + part);
  require_not_negative(inner_diameter, "the inner diameter of the " + part);
  plausibility::require(plausibility::kDiameter, outer_diameter, "the diameter of the " + part, "", ExitCode::usage);
  plausibility::require(plausibility::kLength, length, "the length of the " + part, "", ExitCode::usage);
  if (inner_diameter >= outer_diameter)
    refuse(fmt::format("the inner diameter of the {} is not below the outer one", part), "swap them");
  return shapes::hollow_cylinder<double>(mass, outer_diameter / 2, inner_diameter / 2, from, to);
}

Ten upper_arm(const RobotDescription& robot, const LimbGeometry<double>& limb, const PartShapes& s) {
  if (robot.drive_kind == DriveKind::prismatic) {
    const Vec half = 0.5 * s.carriage_length * limb.axis_L;
    return round(s.carriage_mass, s.carriage_diameter, 0, -half, half, "carriage");
  }
  Ten p = tube(s.upper_arm_density, s.upper_arm_outer_diameter, s.upper_arm_wall, Vec::Zero(),
               Vec(arm_length(limb), 0, 0), "upper arm");
  require_not_negative(s.upper_arm_hub_mass, "the mass of the upper arm's hub");
  if (s.upper_arm_hub_mass > 0) {
    const Vec half(0, s.upper_arm_hub_width / 2, 0);
    p += round(s.upper_arm_hub_mass, s.upper_arm_hub_diameter, 0, -half, half, "upper arm's hub");
  }
  return p;
}

Ten strut(double length, const PartShapes& s) {
  Ten p = tube(s.strut_density, s.strut_outer_diameter, s.strut_wall, Vec::Zero(), Vec(length, 0, 0), "strut");
  require_not_negative(s.strut_sockets_mass, "the mass of the strut's sockets");
  if (s.strut_sockets_mass > 0) {
    const Vec socket(s.strut_socket_length, 0, 0);
    const Vec end(length, 0, 0);
    const double inner = s.strut_outer_diameter;  // it sits around the tube
    p += round(s.strut_sockets_mass / 2, s.strut_socket_diameter, inner, Vec::Zero(), socket, "strut's socket");
    p += round(s.strut_sockets_mass / 2, s.strut_socket_diameter, inner, end - socket, end, "strut's socket");
  }
  return p;
}

/// From one limb's attachment to the other's.
Ten half_plate(const RobotDescription& robot, int part, const PartShapes& s) {
  std::vector<Vec> ends;
  const double turn = robot.parts[static_cast<std::size_t>(part)].turn;
  for (const auto& limb : robot.limbs)
    if (limb.part == part) ends.push_back(Eigen::AngleAxisd(-turn, Vec::UnitZ()) * limb.p_BA);
  return round(s.half_plate_mass, s.half_plate_diameter, 0, ends.front(), ends.back(), "half plate");
}

/// \param number  of the limb or half from 1; 0: all have the parameters of the first
Ten body_of(Body body, int number, const RobotDescription& robot, const PartShapes& s) {
  const int first = std::max(number - 1, 0);
  if (body == Body::upper_arm) return upper_arm(robot, robot.limbs[static_cast<std::size_t>(first)], s);
  if (body == Body::strut) return strut(robot.limbs[static_cast<std::size_t>(first)].strut, s);
  if (body == Body::platform) {
    const Vec half(0, 0, s.platform_thickness / 2);
    return round(s.platform_mass, s.platform_diameter, 0, -half, half, "platform");
  }
  if (body == Body::half_plate) return half_plate(robot, first, s);
  if (body == Body::crossbar) {
    const Vec half(robot.plate->spacing / 2, 0, 0);
    return round(s.crossbar_mass, s.crossbar_diameter, 0, -half, half, "crossbar");
  }
  if (body == Body::tool) return round(s.tool_mass, s.tool_diameter, 0, Vec(0, 0, -s.tool_length), Vec::Zero(), "tool");
  if (!(s.telescope_upper_share > 0 && s.telescope_upper_share < 1))
    refuse("the upper part's share of the telescope's mass must lie between 0 and 1", "the paper's is 0.6");
  if (body == Body::telescope_upper)
    return round(s.telescope_mass * s.telescope_upper_share, s.telescope_upper_diameter, 0, Vec::Zero(),
                 Vec(0, 0, -s.telescope_upper_length), "telescope's upper part");
  return round(s.telescope_mass * (1 - s.telescope_upper_share), s.telescope_lower_outer_diameter,
               s.telescope_lower_inner_diameter, Vec::Zero(), Vec(0, 0, s.telescope_lower_length),
               "telescope's lower part");
}

double friction_of(int drive, bool viscous, const RobotDescription& robot, const PartShapes& s) {
  if (drive == 0 && robot.plate) return viscous ? s.plate_viscous : s.plate_coulomb;
  if (drive == 0) return viscous ? s.telescope_viscous : s.telescope_coulomb;
  if (robot.telescope && drive == robot.drives())
    return viscous ? s.telescope_drive_viscous : s.telescope_drive_coulomb;
  return viscous ? s.drive_viscous : s.drive_coulomb;
}

}  // namespace

PartShapes::PartShapes(const RobotDescription& robot) {
  const LimbGeometry<double>& limb = robot.limbs.front();
  const bool prismatic = robot.drive_kind == DriveKind::prismatic;
  const double arm = arm_length(limb) / kPaperArm;
  const double rod = limb.strut / kPaperStrut;
  const double plate = std::max(plate_radius(robot), 0.2 * kPaperPlate) / kPaperPlate;
  const double bar = (arm_length(limb) + limb.strut) / (kPaperArm + kPaperStrut);

  upper_arm_outer_diameter = 0.056 * arm;
  upper_arm_wall = 0.003 * arm;
  upper_arm_density = 1600;  // carbon fibre
  upper_arm_hub_mass = 0.5 * arm;
  upper_arm_hub_diameter = 0.08 * arm;
  upper_arm_hub_width = 0.06 * arm;
  carriage_mass = 2;
  carriage_diameter = 0.1;
  carriage_length = 0.1;
  strut_outer_diameter = 0.0236 * rod;
  strut_wall = 0.001 * rod;
  strut_density = 1585;
  strut_sockets_mass =  // as heavy as the tube (paper VIII.A)
      shapes::cylinder_mass(strut_density, strut_outer_diameter / 2, strut_outer_diameter / 2 - strut_wall, limb.strut);
  strut_socket_diameter = 1.5 * strut_outer_diameter;
  strut_socket_length = 0.08 * rod;
  platform_mass = plate;  // 1 kg in the paper; a larger plate is wider and lighter built
  platform_diameter = 0.16 * plate;
  platform_thickness = 0.02;
  half_plate_mass = 0.4 * plate;
  half_plate_diameter = 0.025;
  crossbar_mass = 0.15 * plate;
  crossbar_diameter = 0.02;
  tool_mass = 0.3;
  tool_diameter = 0.06;
  tool_length = 0.1;
  telescope_mass = 1.5 * bar;
  telescope_upper_share = 0.6;
  telescope_upper_length = 0.70 * bar;
  telescope_upper_diameter = 0.016;
  telescope_lower_length = 0.78 * bar;
  telescope_lower_outer_diameter = 0.028;
  telescope_lower_inner_diameter = 0.016;
  drive_viscous = prismatic ? 20 : 1.5;
  drive_coulomb = prismatic ? 10 : 4;
  telescope_drive_viscous = 0.02;
  telescope_drive_coulomb = 0.5;
  telescope_viscous = 4;
  telescope_coulomb = 4;
  plate_viscous = 0.02;
  plate_coulomb = 0.1;
}

InertialVector<double> inertial_std(const InertialVector<double>& p, double share) {
  const PseudoInertia<double> M = to_pseudo_inertia(p);
  PseudoInertia<double> scale;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) scale(i, j) = share * std::sqrt(M(i, i) * M(j, j));
  return from_pseudo_inertia<double>(scale).cwiseAbs();
}

NominalParameters nominal_parameters(const Robot& robot, const PartShapes& shapes) {
  require_positive(shapes.body_std, "the relative standard deviation of the bodies");
  require_positive(shapes.friction_std, "the relative standard deviation of the friction");
  for (const double share : {shapes.body_std, shapes.friction_std})
    plausibility::require(plausibility::kShare, share, "a standard deviation", "", ExitCode::usage);
  for (const double friction :
       {shapes.drive_viscous, shapes.drive_coulomb, shapes.telescope_drive_viscous, shapes.telescope_drive_coulomb,
        shapes.telescope_viscous, shapes.telescope_coulomb, shapes.plate_viscous, shapes.plate_coulomb})
    require_positive(friction, "a friction coefficient");
  NominalParameters nominal;
  nominal.value = Eigen::VectorXd::Zero(robot.parameters());
  nominal.std = Eigen::VectorXd::Zero(robot.parameters());
  for (int column = 0; column < robot.parameters();) {
    const ParameterId& id = robot.parameter_ids()[static_cast<std::size_t>(column)];
    if (id.kind == ParameterKind::inertial) {  // a body's ten parameters stand together, the mass first
      const Ten p = body_of(id.body, id.number, robot.description(), shapes);
      if (!is_physically_consistent<double>(p))
        refuse(fmt::format("the shapes of {} make no physically consistent body", owner_name(id)),
               "give every part a thickness");
      plausibility::require_body(robot.description(), id.body, p, owner_name(id), "", ExitCode::usage);
      nominal.value.segment<kInertialParameters>(column) = p.array() + 0.0;  // no -0 in a file that people read
      nominal.std.segment<kInertialParameters>(column) = inertial_std(p, shapes.body_std);
      column += kInertialParameters;
      continue;
    }
    const double friction = friction_of(id.number, id.kind == ParameterKind::viscous, robot.description(), shapes);
    if (id.is_friction()) {
      nominal.value(column) = friction;
      plausibility::require_joint_parameter(id.kind, friction, parameter_name(id), "", ExitCode::usage);
    }
    // Rotor inertia and offset: unknown beforehand, of the size of the drive's own friction.
    nominal.std(column) = shapes.friction_std * friction;
    ++column;
  }
  return nominal;
}

}  // namespace deltadyn
