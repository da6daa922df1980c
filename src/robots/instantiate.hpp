#pragma once

/// \file
/// What the run-time faces need of a robot type. Each type has a file of its own; a folder holds those that share much
/// and compile together: by the kind of their plate, axes with the rigid ones.

// NOLINTBEGIN(cppcoreguidelines-macro-usage, bugprone-macro-parentheses): an explicit instantiation has no other form.
#define DELTADYN_INSTANTIATE_ROBOT(Type)                                                                       \
  namespace deltadyn::detail {                                                                                 \
  template std::unique_ptr<Robot> make_robot_of<Type>(const RobotDescription&, const ParameterOptions&);       \
  template std::unique_ptr<EffectStates> make_effect_states_of<Type>(const RobotDescription&);                 \
  template std::unique_ptr<TaskRegressor> make_task_regressor_of<Type>(const Robot&);                          \
  template std::unique_ptr<Mechanism> make_mechanism_of<Type>(const RobotDescription&, const Eigen::VectorXd&, \
                                                              const MechanismOptions&);                        \
  }
// NOLINTEND(cppcoreguidelines-macro-usage, bugprone-macro-parentheses)
