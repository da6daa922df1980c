#include "plant_parts.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "deltadyn/runtime/changed_machine.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn::detail {
namespace {

constexpr double kDampingRatio = 0.05;  // of a gear with its bearings

/// Parameters by name, every limb on its own.
class Values {
 public:
  Values(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p)
      : names_(mechanism_parameter_names(description)), p_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(names_.size()))) {
    for (std::size_t k = 0; k < names_.size(); ++k) {
      for (const std::string& name : {names_[k], shared(names_[k])}) {
        const auto found = std::ranges::find(names, name);
        if (found == names.end()) continue;
        p_(static_cast<Eigen::Index>(k)) = p(found - names.begin());
        break;
      }
    }
  }
  double& operator[](const std::string& name) {
    const auto found = std::ranges::find(names_, name);
    if (found == names_.end()) throw Error("the robot has no parameter " + name, "", "", ExitCode::usage);
    return p_(found - names_.begin());
  }
  [[nodiscard]] const Eigen::VectorXd& all() const { return p_; }

 private:
  /// "strut3.m" -> "strut.m"
  static std::string shared(const std::string& name) {
    const auto dot = name.find('.');
    std::string owner = name.substr(0, dot);
    if (owner.starts_with("drive")) return name;
    while (!owner.empty() && std::isdigit(static_cast<unsigned char>(owner.back()))) owner.pop_back();
    return owner + name.substr(dot);
  }
  std::vector<std::string> names_;
  Eigen::VectorXd p_;
};

[[noreturn]] void refuse(const Effect& effect, const std::string& what, const std::string& mend) {
  throw Error(what, fmt::format("{}@{}", effect_kind(effect.id).name, effect_joint_name(effect.id, effect.joint)), mend,
              ExitCode::usage);
}

/// Is the effect built into the machine, and does it act on the plate by its law?
bool changes_machine(EffectId id) {
  bool changes = false;
  visit_effect(id, [&changes](auto effect) { changes = HasChange<decltype(effect), ChangedMachine>::value; });
  return changes;
}
bool pushes_plate(EffectId id) {
  bool pushes = false;
  visit_effect(id, [&pushes](auto effect) { pushes = kIs<decltype(effect), PlateForce>; });
  return pushes && !changes_machine(id);
}

class Builder {
 public:
  Builder(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p)
      : machine_(description), values_(description, names, p) {}

  PlantParts build(const std::vector<Effect>& effects) {
    for (const Effect& effect : effects) change(effect);
    for (const auto& [name, more] : machine_.parameters) values_[name] += more;
    MechanismOptions options;
    options.home_offset = machine_.home_offset;
    options.passive_joints = std::ranges::any_of(
        effects, [](const Effect& effect) { return effect_kind(effect.id).place == EffectPlace::passive_joints; });
    parts_.gravity = machine_.description.gravity;
    parts_.mechanism = make_mechanism(machine_.description, values_.all(), options);
    add_laws(effects);
    for (const auto& [drive, spring] : machine_.springs) add_spring(drive, spring);
    return std::move(parts_);
  }

 private:
  void change(const Effect& effect) {
    const std::vector<int> joints = effect_joints(effect.id, machine_.description);
    if (std::ranges::find(joints, effect.joint) == joints.end())
      refuse(effect, "this robot has no such place for the effect", "look at delta-simulate --list-effects");
    check_sizes(effect, std::string(effect_kind(effect.id).name), ExitCode::usage);
    if (pushes_plate(effect.id)) parts_.plate_forces.push_back(effect);
    const std::size_t springs = machine_.springs.size();
    visit_effect(effect.id, [&](auto type) {
      using E = decltype(type);
      if constexpr (HasChange<E, ChangedMachine>::value)
        E::change(machine_, effect.joint, amplitudes_of(effect), shape_of(effect));
    });
    for (std::size_t k = 0; k < springs && machine_.springs.size() > springs; ++k) {
      if (machine_.springs[k].first == effect.joint)
        refuse(effect, "this drive has a spring or play already", "give one of them a drive");
    }
  }

  void add_laws(const std::vector<Effect>& effects) {
    const int n = machine_.description.drives(), telescope = parts_.mechanism->telescope_joint();
    for (int j = 0; j < parts_.mechanism->joints(); ++j) {
      const std::string joint = j < n ? fmt::format("drive{}", j + 1) : "telescope";
      if (j < n || j == telescope) {
        parts_.laws.emplace_back(values_[joint + ".viscous"], values_[joint + ".coulomb"],
                                 j < n ? values_[joint + ".offset"] : 0.0);
      } else {
        parts_.laws.emplace_back(0.0, 0.0);
      }
    }
    for (const Effect& effect : effects) {
      if (!FrictionLaw::takes(effect.id)) continue;
      for (int j = 0; j < parts_.mechanism->joints(); ++j) {
        const bool passive = j >= n && j != telescope;
        const EffectPlace place = effect_kind(effect.id).place;
        const bool here = effect.joint >= 0                      ? j == effect.joint
                          : place == EffectPlace::passive_joints ? passive
                          : place == EffectPlace::telescope      ? j == telescope
                                                                 : acts_on_all(effect.id, j, machine_.description);
        if (here) parts_.laws[static_cast<std::size_t>(j)].add(effect, parts_.mechanism->multiplicity(j));
      }
    }
  }

  /// Inertia of one drive with everything behind it held by the other drives, in the middle of the workspace.
  double drive_inertia(int drive) {
    const RobotDescription& robot = machine_.description;
    DriveVector q = DriveVector::Zero(robot.drives());
    for (int j = 0; j < robot.drives(); ++j) {
      const DriveLimits& limits = robot.limits[static_cast<std::size_t>(j)];
      if (std::isfinite(limits.lower + limits.upper)) q(j) = 0.5 * (limits.lower + limits.upper);
    }
    MechanismTerms terms;
    if (parts_.mechanism->evaluate(q, DriveVector::Zero(q.size()), terms) != Status::ok) {
      q.setZero();
      if (parts_.mechanism->evaluate(q, q, terms) != Status::ok) {
        throw Error("the inertia of the drives cannot be had: neither the middle of the limits nor 0 is a pose of this robot",
                    robot.name, "mend the limits of the drives in the robot file", ExitCode::usage);
      }
    }
    return terms.M(drive, drive);
  }

  void add_spring(int drive, const SpringInDrive& spring) {
    const double inertia = drive_inertia(drive), motor = spring.motor_share * inertia;
    const double reduced = motor * (inertia - motor) / inertia;
    if (!(reduced > 0)) {
      throw Error(fmt::format("a motor with {} of the inertia of drive {} leaves no load behind its spring or play",
                              spring.motor_share, drive + 1),
                  "--effect", "give the motor (or the play) a share between 0 and 1", ExitCode::usage);
    }
    SoftDrive soft{.drive = drive, .motor_inertia = motor, .gap = spring.gap, .encoder_on_motor = spring.encoder_on_motor};
    soft.stiffness = spring.inertia_over_stiffness > 0
                         ? (spring.encoder_on_motor ? inertia - motor : motor) / spring.inertia_over_stiffness
                         : reduced * std::pow(2 * std::numbers::pi * spring.flank_hz, 2);
    soft.damping = 2 * kDampingRatio * std::sqrt(soft.stiffness * reduced);
    parts_.soft.push_back(soft);
  }

  ChangedMachine machine_;
  Values values_;
  PlantParts parts_;
};

}  // namespace

double SoftDrive::torque(double lead, double lead_rate) const {
  const double half = 0.5 * gap;
  const double wound = lead > half ? lead - half : (lead < -half ? lead + half : 0.0);
  if (gap == 0) return stiffness * lead + damping * lead_rate;
  // A flank pushes, it never pulls.
  const double torque = stiffness * wound + (wound != 0 ? damping * lead_rate : 0.0);
  return wound > 0 ? std::max(0.0, torque) : (wound < 0 ? std::min(0.0, torque) : 0.0);
}

double SoftDrive::energy(double lead) const {
  const double half = 0.5 * gap;
  const double wound = lead > half ? lead - half : (lead < -half ? lead + half : 0.0);
  return 0.5 * stiffness * wound * wound;
}

PlantParts build_plant(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p,
                       const std::vector<Effect>& effects) {
  return Builder(description, names, p).build(effects);
}

}  // namespace deltadyn::detail
