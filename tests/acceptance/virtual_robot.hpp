#pragma once

/// \file
/// A robot that is simulated with the installed tools: the fixture of tests that record logs of their own.

#include <cstdint>
#include <gtest/gtest.h>
#include <string>

#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/io/trajectory_file.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "acceptance/tool_run.hpp"
#include "identification/synthetic_log.hpp"

namespace deltadyn::acceptance {

/// Robot, parameters and a trajectory of a few seconds in a folder of their own.
class VirtualRobot : public ::testing::Test {
 protected:
  VirtualRobot() {
    (void)folder.write("robot.urdf", read_text(installed("robots/mujoco_delta4.urdf")));
    (void)folder.write("truth.csv", read_text(installed("logs/mujoco_delta4/truth.csv")));
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder.path(name); }

  /// Fourier motion from the tests' own generator, so that this test stands without delta-excite.
  void plan(const std::string& name, double duration_s, double frequency_hz, std::uint64_t seed) const {
    const auto robot = make_robot(read_robot_file(path("robot.urdf")));
    const Eigen::VectorXd p =
        values(read_parameters(path("truth.csv")), robot->parameter_names(), robot->parameter_units());
    testing_support::SyntheticOptions options;
    options.duration_s = duration_s;
    options.base_frequency_hz = frequency_hz;
    options.seed = seed;
    const Log log = testing_support::synthetic_log(*robot, p, options);
    TrajectorySamples samples;
    samples.t_s = log.t_s;
    samples.q = log.q;
    samples.qd = log.qd;
    samples.qdd = log.qdd;
    complete_task(*robot, samples);
    write_trajectory(path(name), samples, robot->description());
  }
  [[nodiscard]] Words simulate(const std::string& trajectory, const std::string& log, const Words& flags = {}) const {
    return Words{"delta-simulate", path("robot.urdf"), "--params", path("truth.csv"),
                 "--trajectory",   path(trajectory),   "-o",       path(log),
                 "--summary",      path("summary.csv")} +
           flags;
  }
  const testing_support::TemporaryFolder folder;
};

}  // namespace deltadyn::acceptance
