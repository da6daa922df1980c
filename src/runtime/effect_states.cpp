#include "deltadyn/runtime/effect_states.hpp"

#include "deltadyn/runtime/geometry_of.hpp"

namespace deltadyn {

namespace detail {

/// In effect_states_of.hpp, compiled for each type in src/robots.
template <class R>
std::unique_ptr<EffectStates> make_effect_states_of(const RobotDescription& description);

}  // namespace detail

std::unique_ptr<EffectStates> make_effect_states(const RobotDescription& description) {
  return with_robot_type(description,
                         [&](auto type) { return detail::make_effect_states_of<decltype(type)>(description); });
}

}  // namespace deltadyn
