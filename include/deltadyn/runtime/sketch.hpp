#pragma once

/// \file
/// A robot as lines in space, to be drawn.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// Lines of one kind; in W [m].
struct SketchLines {
  std::string label;  ///< "upper arms", "struts", "plate", ...
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> lines = {};
};

/// Base, arms or carriages on their rails, struts, parts of the plate, its tool, and the telescope bar, at drive
/// coordinates q.
/// Throws deltadyn::Error if the pose is out of reach or singular.
[[nodiscard]] std::vector<SketchLines> sketch_of(const Robot& robot, const Eigen::VectorXd& q);

}  // namespace deltadyn
