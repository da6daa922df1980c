#pragma once

/// \file
/// The presliding that a parameter file holds, as effects: for the tools that know friction with a memory only in that form.

#include <fmt/format.h>
#include <vector>

#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/runtime/effect_catalogue.hpp"

namespace deltadyn::tools {

/// One effect for each drive whose friction builds up over a displacement (rows driveK.presliding), of the size of its Coulomb
/// friction. The telescope's is told to be left out. Throws as presliding_of does.
inline std::vector<Effect> presliding_effects(const ParameterTable& table, const RobotDescription& robot) {
  const Eigen::VectorXd displacement = presliding_of(table, robot);
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
    effect.id = EffectId::presliding;
    effect.joint = joint;
    effect.shape = Eigen::VectorXd::Constant(1, displacement(joint));
    effect.amplitude = Eigen::VectorXd::Constant(1, coulomb->value);
    effects.push_back(std::move(effect));
  }
  return effects;
}

}  // namespace deltadyn::tools
