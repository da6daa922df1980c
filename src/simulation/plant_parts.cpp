#include "plant_parts.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "deltadyn/effects/base_tilt.hpp"
#include "deltadyn/effects/kinematic_offset.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn::detail {
namespace {

// What the catalogue's one number leaves open about a real spring or real play.
constexpr double kMotorShare = 0.6;        // of a drive's inertia that sits before the spring: rotor and gear of a fast robot
constexpr double kLeastMotorShare = 0.3;   // before play: a motor much lighter than its load cannot be controlled across it
constexpr double kDampingRatio = 0.05;     // of a gear with its bearings
constexpr double kFlankFrequencyHz = 250;  // resonance of motor and load while a flank carries

/// Parameters by name, every limb on its own.
class Values {
 public:
  Values(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p)
      : names_(mechanism_parameter_names(description)), p_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(names_.size()))) {
    for (std::size_t k = 0; k < names_.size(); ++k) {
      for (const std::string& name : {names_[k], shared(names_[k])}) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) continue;
        p_(static_cast<Eigen::Index>(k)) = p(found - names.begin());
        break;
      }
    }
  }
  double& operator[](const std::string& name) {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) throw Error("the robot has no parameter " + name, "", "", ExitCode::usage);
    return p_(found - names_.begin());
  }
  [[nodiscard]] const Eigen::VectorXd& all() const { return p_; }

 private:
  /// "strut3.m" -> "strut.m"
  static std::string shared(const std::string& name) {
    const auto dot = name.find('.');
    std::string owner = name.substr(0, dot);
    if (owner.rfind("drive", 0) == 0) return name;
    while (!owner.empty() && std::isdigit(static_cast<unsigned char>(owner.back()))) owner.pop_back();
    return owner + name.substr(dot);
  }
  std::vector<std::string> names_;
  Eigen::VectorXd p_;
};

[[noreturn]] void refuse(const Effect& effect, const std::string& what, const std::string& mend) {
  throw Error(what, effect_kind(effect.id).name + "@" + effect_joint_name(effect.id, effect.joint), mend, ExitCode::usage);
}

class Builder {
 public:
  Builder(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p)
      : description_(description), values_(description, names, p) {
    options_.home_offset = DriveVector::Zero(description.drives());
  }

  PlantParts build(const std::vector<Effect>& effects) {
    for (const Effect& effect : effects) place(effect);
    parts_.gravity = description_.gravity;
    parts_.mechanism = make_mechanism(description_, values_.all(), options_);
    const int n = description_.drives();
    for (int j = 0; j < parts_.mechanism->joints(); ++j) {
      if (j > n || (j == n && !description_.telescope)) {
        parts_.laws.emplace_back(0.0, passive_friction_ * parts_.mechanism->multiplicity(j));
        continue;
      }
      const std::string joint = j < n ? fmt::format("drive{}", j + 1) : "telescope";
      parts_.laws.emplace_back(values_[joint + ".viscous"], values_[joint + ".coulomb"]);
      if (j < n && values_[joint + ".offset"] != 0) {
        Effect offset;
        offset.id = EffectId::asymmetric_coulomb;
        offset.joint = j;
        offset.amplitude = Eigen::VectorXd::Constant(1, values_[joint + ".offset"]);
        parts_.laws.back().add(offset);
      }
    }
    for (const Effect& effect : effects) {
      if (!FrictionLaw::takes(effect.id)) continue;
      const int joint = effect.joint >= 0 ? effect.joint : parts_.mechanism->telescope_joint();
      parts_.laws[static_cast<std::size_t>(joint)].add(effect);
    }
    for (const Effect& effect : effects) {
      if (effect.id == EffectId::joint_elasticity) add_spring(effect);
      if (effect.id == EffectId::backlash) add_play(effect);
    }
    return std::move(parts_);
  }

 private:
  void place(const Effect& effect) {
    const auto a = [&effect](Eigen::Index k) { return effect.amplitude(k); };
    const std::size_t limb = static_cast<std::size_t>(std::max(0, effect.joint));
    const std::string drive = fmt::format("drive{}", effect.joint + 1);
    switch (effect.id) {
      case EffectId::rotor_inertia: values_[drive + ".rotor_inertia"] += a(0); break;
      case EffectId::limb_inertia_mismatch:
        if (description_.drive_kind == DriveKind::prismatic) {
          refuse(effect, "a carriage that slides has neither moment nor inertia about its drive", "use rotor_inertia, a mass");
        }
        values_[fmt::format("upper_arm{}.mcx", effect.joint + 1)] += a(0);
        values_[fmt::format("upper_arm{}.Iyy", effect.joint + 1)] += a(1);
        break;
      case EffectId::payload: values_["platform.m"] += a(0); break;
      case EffectId::base_tilt: description_.gravity = tilted_gravity<double>(description_.gravity, a(0), a(1)); break;
      case EffectId::passive_joint_friction:
        options_.passive_joints = true;
        passive_friction_ += a(0);
        break;
      case EffectId::aerodynamic_drag: parts_.drag += a(0); break;
      case EffectId::hose_force:
        parts_.hose = true;
        parts_.hose_force += effect.amplitude.head<3>();
        parts_.hose_stiffness += effect.amplitude.segment<3>(3);
        break;
      case EffectId::kinematic_offset:
        switch (static_cast<KinematicOffset>(std::lround(effect.shape(0)))) {
          case KinematicOffset::home: options_.home_offset(effect.joint) += a(0); break;
          case KinematicOffset::arm:
            if (description_.drive_kind == DriveKind::prismatic) refuse(effect, "a carriage has no arm", "use kind 0 or 2");
            description_.limbs[limb].p_DE_0.x() += a(0);
            break;
          case KinematicOffset::strut: description_.limbs[limb].strut += a(0); break;
        }
        break;
      default: break;
    }
  }

  /// Inertia of one drive with everything behind it held by the other drives, in the middle of the workspace.
  double drive_inertia(int drive) {
    DriveVector q = DriveVector::Zero(description_.drives());
    for (int j = 0; j < description_.drives(); ++j) {
      const DriveLimits& limits = description_.limits[static_cast<std::size_t>(j)];
      if (std::isfinite(limits.lower + limits.upper)) q(j) = 0.5 * (limits.lower + limits.upper);
    }
    MechanismTerms terms;
    if (parts_.mechanism->evaluate(q, DriveVector::Zero(q.size()), terms) != Status::ok) {
      q.setZero();
      if (parts_.mechanism->evaluate(q, q, terms) != Status::ok) return 0;
    }
    return terms.M(drive, drive);
  }

  SoftDrive& new_soft_drive(const Effect& effect) {
    for (const SoftDrive& other : parts_.soft) {
      if (other.drive == effect.joint) refuse(effect, "this drive has a spring or play already", "give one of them a drive");
    }
    parts_.soft.emplace_back();
    parts_.soft.back().drive = effect.joint;
    return parts_.soft.back();
  }

  /// Amplitude [s^2]: J_motor/k with the encoder on the arm, J_arm/k with the encoder on the motor.
  void add_spring(const Effect& effect) {
    const double c = effect.amplitude(0);
    if (c == 0) return;
    const double inertia = drive_inertia(effect.joint);
    SoftDrive& soft = new_soft_drive(effect);
    const double share = effect.shape.size() > 1 ? effect.shape(1) : kMotorShare;
    if (!(c > 0 && share > 0 && share < 1)) {
      refuse(effect, "the inertia over the stiffness must be above 0, and the motor's share of the inertia between 0 and 1",
             "say by encoder=0 or 1 whether the encoder sits on the arm or on the motor");
    }
    soft.motor_inertia = share * inertia;
    soft.encoder_on_motor = effect.shape.size() > 0 && effect.shape(0) > 0;
    soft.stiffness = (soft.encoder_on_motor ? inertia - soft.motor_inertia : soft.motor_inertia) / c;
    set_damping(soft, inertia);
  }

  /// Amplitude: share of the load that hangs behind the gap.
  void add_play(const Effect& effect) {
    const double share = effect.amplitude(0);
    if (!(share > 0 && share <= 1)) refuse(effect, fmt::format("a share of {} is not between 0 and 1", share), "");
    const double inertia = drive_inertia(effect.joint);
    SoftDrive& soft = new_soft_drive(effect);
    soft.motor_inertia = std::max(kLeastMotorShare, 1 - share) * inertia;
    soft.gap = effect.shape(0);
    const double reduced = soft.motor_inertia * (inertia - soft.motor_inertia) / inertia;
    soft.stiffness = reduced * std::pow(2 * std::numbers::pi * kFlankFrequencyHz, 2);
    if (!(reduced > 0)) refuse(effect, "no load would be left behind the gap", "give a smaller share");
    set_damping(soft, inertia);
  }

  static void set_damping(SoftDrive& soft, double inertia) {
    const double reduced = soft.motor_inertia * (inertia - soft.motor_inertia) / inertia;
    soft.damping = 2 * kDampingRatio * std::sqrt(soft.stiffness * reduced);
  }

  RobotDescription description_;
  Values values_;
  MechanismOptions options_;
  PlantParts parts_;
  double passive_friction_ = 0;
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

bool plant_takes(EffectId id) {
  switch (id) {
    case EffectId::torque_constant_error:
    case EffectId::time_skew:
    case EffectId::current_lag:
    case EffectId::saturation: return false;  // of the log, see log_effects.hpp
    default: return true;
  }
}

PlantParts build_plant(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p,
                       const std::vector<Effect>& effects) {
  return Builder(description, names, p).build(effects);
}

}  // namespace deltadyn::detail
