#pragma once

/// \file
/// All robots of the library, in the one list that everything else dispatches over.

#include <string_view>

#include "deltadyn/model/h4.hpp"
#include "deltadyn/model/i4.hpp"
#include "deltadyn/model/par4.hpp"

namespace deltadyn {

template <class... Robots>
struct RobotList {};

using RobotTypes =
    RobotList<Delta3, LinearDelta3, Delta4, H4, LinearH4, I4, LinearI4, Par4, LinearPar4, Axis, LinearAxis>;

namespace detail {

template <class Work, class Otherwise, class Robot, class... Others>
auto visit_robot_type_of(RobotList<Robot, Others...> /*list*/, std::string_view name, DriveKind drives,
                         const Work& work, const Otherwise& otherwise) {
  if (name == Robot::kName && drives == Robot::kDrive) return work(Robot());
  if constexpr (sizeof...(Others) > 0) {
    return visit_robot_type_of(RobotList<Others...>(), name, drives, work, otherwise);
  } else {
    return otherwise();
  }
}

}  // namespace detail

/// work(R()) with the type R of this name and kind of drives; otherwise() if there is none. Both give the same type.
template <class Work, class Otherwise>
auto visit_robot_type(std::string_view name, DriveKind drives, const Work& work, const Otherwise& otherwise) {
  return detail::visit_robot_type_of(RobotTypes(), name, drives, work, otherwise);
}

namespace detail {

template <class Work, class... Robots>
void for_each_robot_type_of(RobotList<Robots...> /*list*/, const Work& work) {
  (work(Robots()), ...);
}

}  // namespace detail

/// work(R()) for every type.
template <class Work>
void for_each_robot_type(const Work& work) {
  detail::for_each_robot_type_of(RobotTypes(), work);
}

}  // namespace deltadyn
