#pragma once

#include <initializer_list>
#include <vector>

#include "deltadyn/runtime/effect_catalogue.hpp"

namespace deltadyn::testing_support {

inline Eigen::VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// \param joint  drive from 0, or -1
inline Effect effect_of(EffectId id, int joint, const std::vector<double>& amplitude,
                        const std::vector<double>& shape) {
  Effect effect;
  effect.id = id;
  effect.joint = joint;
  effect.amplitude = vector_of(amplitude);
  effect.shape = vector_of(shape);
  return effect;
}

}  // namespace deltadyn::testing_support
