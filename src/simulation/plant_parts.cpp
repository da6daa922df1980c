#include "plant_parts.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "deltadyn/runtime/changed_machine.hpp"
#include "deltadyn/runtime/drive_inertia.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn::detail {
namespace {

constexpr double kDampingRatio = 0.05;  // of a gear with its bearings

/// Parameters, every limb on its own.
class Values {
 public:
  Values(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p)
      : ids_(make_robot(description, mechanism_options(description))->parameter_ids()),
        p_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(ids_.size()))) {
    for (std::size_t k = 0; k < ids_.size(); ++k) {
      ParameterId shared = ids_[k];
      if (shared.kind == ParameterKind::inertial) shared.number = 0;
      for (const ParameterId& id : {ids_[k], shared}) {
        const auto found = std::find(names.begin(), names.end(), parameter_name(id));
        if (found == names.end()) continue;
        p_(static_cast<Eigen::Index>(k)) = p(found - names.begin());
        break;
      }
    }
  }
  double& operator[](const ParameterId& id) {
    const auto found = std::find(ids_.begin(), ids_.end(), id);
    if (found == ids_.end()) throw Error("the robot has no parameter " + parameter_name(id), "", "", ExitCode::usage);
    return p_(found - ids_.begin());
  }
  [[nodiscard]] const Eigen::VectorXd& all() const { return p_; }

 private:
  std::vector<ParameterId> ids_;
  Eigen::VectorXd p_;
};

[[noreturn]] void refuse(const Effect& effect, const std::string& what, const std::string& mend) {
  throw Error(what, fmt::format("{}@{}", effect_kind(effect.id).name, effect_joint_name(effect.id, effect.joint)), mend,
              ExitCode::usage);
}

/// Does the effect act on the plate by its law, and is it not built into the machine?
bool pushes_plate(EffectId id) {
  bool pushes = false;
  visit_effect(id, [&pushes](auto effect) {
    using E = decltype(effect);
    pushes = kIs<E, PlateForce> && !HasChange<E, ChangedMachine>::value;
  });
  return pushes;
}

class Builder {
 public:
  Builder(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p)
      : machine_(description), values_(description, names, p) {}

  PlantParts build(const std::vector<Effect>& effects) {
    for (const Effect& effect : effects) change(effect);
    for (const auto& [id, more] : machine_.parameters) values_[id] += more;
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
    check_sizes(
        effect, [&effect](std::string_view) { return std::string(effect_kind(effect.id).name); }, ExitCode::usage);
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
    const int n = machine_.description.drives(), inner = parts_.mechanism->inner_joint();
    for (int j = 0; j < parts_.mechanism->joints(); ++j) {
      const auto own = [&](ParameterKind kind) {
        return values_[{
            .kind = kind,
            .number = j < n ? j + 1 : 0,
            .inner = j == inner && machine_.description.plate ? InnerJointKind::plate : InnerJointKind::telescope}];
      };
      if (j < n || j == inner) {
        parts_.laws.emplace_back(own(ParameterKind::viscous), own(ParameterKind::coulomb),
                                 j < n ? own(ParameterKind::offset) : 0.0);
      } else {
        parts_.laws.emplace_back(0.0, 0.0);
      }
    }
    for (const Effect& effect : effects) {
      if (!FrictionLaw::takes(effect.id)) continue;
      for (int j = 0; j < parts_.mechanism->joints(); ++j) {
        const bool passive = j >= n && j != inner;
        const EffectPlace place = effect_kind(effect.id).place;
        const bool here = effect.joint >= 0                      ? j == effect.joint
                          : place == EffectPlace::passive_joints ? passive
                          : place == EffectPlace::telescope      ? j == inner && machine_.description.telescope
                                                                 : acts_on_all(effect.id, j, machine_.description);
        if (here) parts_.laws[static_cast<std::size_t>(j)].add(effect, parts_.mechanism->multiplicity(j));
      }
    }
  }

  void add_spring(int drive, const SpringInDrive& spring) {
    const std::unique_ptr<Robot> robot = make_robot(machine_.description, mechanism_options(machine_.description));
    const double inertia = drive_inertia(*robot, values_.all())(drive), motor = spring.motor_share * inertia;
    const double reduced = motor * (inertia - motor) / inertia;
    if (!(reduced > 0)) {
      throw Error(fmt::format("a motor with {} of the inertia of drive {} leaves no load behind its spring or play",
                              spring.motor_share, drive + 1),
                  "--effect", "give the motor (or the play) a share between 0 and 1", ExitCode::usage);
    }
    SoftDrive soft{
        .drive = drive, .motor_inertia = motor, .gap = spring.gap, .encoder_on_motor = spring.encoder_on_motor};
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

PlantParts build_plant(const RobotDescription& description, const std::vector<std::string>& names,
                       const Eigen::VectorXd& p, const std::vector<Effect>& effects) {
  return Builder(description, names, p).build(effects);
}

}  // namespace deltadyn::detail
