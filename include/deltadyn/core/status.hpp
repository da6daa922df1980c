#pragma once

/// \file
/// Result of a core function. The core never throws; callers must look at the status.

namespace deltadyn {

enum class [[nodiscard]] Status{
    ok,
    unreachable,   ///< no posture of the robot reaches this point
    singular,      ///< the drives and the plate are not related one to one here
    ambiguous,     ///< more than one pose of the plate belongs to these drives: give the last pose as the start
    out_of_range,  ///< an input is not finite or outside its domain
};

/// One line in plain words, for messages.
constexpr const char* message(Status status) {
  switch (status) {
    case Status::ok: return "ok";
    case Status::unreachable: return "the pose is out of reach";
    case Status::singular: return "the pose is singular";
    case Status::ambiguous: return "more than one pose of the plate belongs to these drives";
    case Status::out_of_range: return "an input is not finite or outside its domain";
  }
  return "unknown status";
}

}  // namespace deltadyn
