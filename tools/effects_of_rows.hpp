#pragma once

/// \file
/// The presliding and the ripple that a parameter file holds, as effects: for the tools that know them only in that
/// form.

#include <fmt/format.h>
#include <vector>

#include "deltadyn/io/extra_rows.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/runtime/effect_catalogue.hpp"

namespace deltadyn::tools {

/// One effect for each drive whose friction builds up over a displacement (rows driveK.presliding), of the size of its
/// Coulomb friction. The inner joint's is told to be left out. Throws as presliding_of does.
inline std::vector<Effect> presliding_effects(const ParameterTable& table, const RobotDescription& robot) {
  const Eigen::VectorXd displacement = presliding_of(table, robot);
  const Eigen::VectorXd damping = presliding_damping_of(table, robot);
  std::vector<Effect> effects;
  for (int joint = 0; joint < displacement.size(); ++joint) {
    if (!(displacement(joint) > 0)) continue;
    if (joint >= robot.drives()) {
      fmt::print("note: {}: left out, Coulomb's law is used there\n", presliding_name(robot, joint));
      continue;
    }
    const ParameterEntry* coulomb = table.find(fmt::format("drive{}.coulomb", joint + 1));
    if (coulomb == nullptr || !(coulomb->value > 0)) continue;
    Effect effect;
    effect.id = effect_with(Role::bristle);
    effect.joint = joint;
    effect.shape = Eigen::Vector2d(displacement(joint), damping(joint));
    effect.amplitude = Eigen::VectorXd::Constant(1, coulomb->value);
    effects.push_back(std::move(effect));
  }
  return effects;
}

/// One effect for each ripple (rows driveK.rippleI). Throws as ripples_of does.
inline std::vector<Effect> ripple_effects(const ParameterTable& table, const RobotDescription& robot) {
  std::vector<Effect> effects;
  for (const Ripple& ripple : ripples_of(table, robot)) {
    Effect effect;
    effect.id = effect_with(Role::wave);
    effect.joint = ripple.drive;
    effect.shape = Eigen::VectorXd::Constant(1, ripple.n);
    effect.amplitude = Eigen::Vector2d(ripple.cosine, ripple.sine);
    effects.push_back(std::move(effect));
  }
  return effects;
}

/// Both.
inline std::vector<Effect> effects_of_rows(const ParameterTable& table, const RobotDescription& robot) {
  std::vector<Effect> effects = presliding_effects(table, robot);
  for (Effect& effect : ripple_effects(table, robot)) effects.push_back(std::move(effect));
  return effects;
}

}  // namespace deltadyn::tools
