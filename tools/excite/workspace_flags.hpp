#pragma once

/// \file
/// The workspace of delta-excite: where the plate's centre stays.

#include <fmt/format.h>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"
#include "deltadyn/trajectory/region.hpp"

#include "excite/list_flags.hpp"
#include "tool_support.hpp"

namespace deltadyn::tools {

class WorkspaceFlags {
 public:
  void add_to(CLI::App& app) {
    app.option_defaults()->group("Workspace");
    app.add_option("--workspace", shape_, "shape that the plate's centre stays in [a ball that the robot reaches]")
        ->check(CLI::IsMember({"half-ball", "ball", "cylinder", "cone", "box"}));
    add_list(app, "--workspace-center-m", centre_, "its centre x,y,z; half-ball: of the flat side, which is up [m]");
    app.add_option("--workspace-radius-m", radius_, "radius; cone: at its lower end [m]");
    app.add_option("--workspace-top-radius-m", top_radius_, "cone: radius at its upper end [m]");
    app.add_option("--workspace-height-m", height_, "height of cylinder and cone, centre in the middle [m]");
    add_list(app, "--workspace-size-m", size_, "box: edges along x,y,z [m]");
  }

  /// True if the user says where the workspace is.
  [[nodiscard]] bool given() const { return !shape_.empty() || !centre_.empty(); }

  /// The region of the flags, or a ball that the robot reaches, which is told. Throws Error(usage).
  [[nodiscard]] Region region(const Robot& robot) const {
    const WorkspaceBall ball = WorkspaceSampler(robot).ball();
    if (shape_.empty()) return usual(ball);
    if (centre_.empty())
      throw Error("the workspace has no centre", "--workspace-center-m",
                  fmt::format("give x,y,z; around ({:.3f}, {:.3f}, {:.3f}) m the robot moves well", ball.centre.x(),
                              ball.centre.y(), ball.centre.z()),
                  ExitCode::usage);
    Region region;
    region.shape = region_shape(shape_);
    region.centre = spread_vector(centre_, 3, "--workspace-center-m");
    region.radius = radius_.value_or(0);
    region.top_radius = top_radius_.value_or(0);
    region.height = height_.value_or(0);
    if (!size_.empty()) region.size = spread_vector(size_, 3, "--workspace-size-m");
    region.validate();
    tell_of_reach(robot, region);
    return region;
  }

 private:
  /// The search keeps to what the robot reaches; who asked for more should know.
  static void tell_of_reach(const Robot& robot, const Region& region) {
    constexpr int kGrid = 15;
    constexpr double kWorthAWord = 0.02;
    const RobotDescription& description = robot.description();
    const auto reached = [&](const Eigen::VectorXd& z) {
      Eigen::VectorXd q(robot.drives());
      if (robot.inverse_kinematics(z, q) != Status::ok) return false;
      for (std::size_t i = 0; i < description.limbs.size(); ++i) {
        const auto drive = static_cast<Eigen::Index>(i);
        if (q(drive) < description.limits[i].lower || q(drive) > description.limits[i].upper) return false;
      }
      return true;
    };
    int inside = 0, beyond = 0;
    Eigen::VectorXd z = Eigen::VectorXd::Zero(robot.drives());
    for (int k = 0; k < kGrid * kGrid * kGrid; ++k) {
      const Eigen::Array3d share =
          Eigen::Array3d(k % kGrid + 0.5, k / kGrid % kGrid + 0.5, k / kGrid / kGrid + 0.5) / kGrid;
      z.head<3>() = region.lower().array() + share * (region.upper() - region.lower()).array();
      if (!region.contains(z.head<3>())) continue;
      ++inside;
      if (!reached(z)) ++beyond;
    }
    const double share = inside > 0 ? static_cast<double>(beyond) / inside : 0;
    if (share > kWorthAWord)
      fmt::print(stderr,
                 "warning: {:.0f} % of the workspace ({}) are out of reach or beyond the drives' ranges; the motion "
                 "stays in the rest\n",
                 100 * share, region.text());
  }

  [[nodiscard]] Region usual(const WorkspaceBall& ball) const {
    const bool other = radius_ || top_radius_ || height_ || !size_.empty() || !centre_.empty();
    if (other)
      throw Error("lengths of a workspace without its shape", "--workspace",
                  "give half-ball, ball, cylinder, cone or box", ExitCode::usage);
    Region region;
    region.shape = RegionShape::ball;
    region.centre = ball.centre;
    region.radius = ball.radius;
    fmt::print("note: no --workspace; a {} is used\n", region.text());
    return region;
  }

  std::string shape_;
  std::vector<double> centre_, size_;
  std::optional<double> radius_, top_radius_, height_;
};

}  // namespace deltadyn::tools
