#pragma once

/// \file
/// A small identification from start to end on made-up logs, for tests of the reports.

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "deltadyn/identification/identify.hpp"
#include "deltadyn/identification/mass_matrix_survey.hpp"
#include "deltadyn/identification/validate.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"

namespace deltadyn::testing_support {

/// Torque that the model does not know of: of a drive, at its position and velocity.
using HiddenTorque = std::function<double(int drive, double q, double qd)>;

inline std::unique_ptr<Robot> shipped_robot(const std::string& name) {
  return make_robot(read_robot_file(std::string(DELTADYN_SOURCE_DIR) + "/data/robots/" + name + ".urdf"));
}

/// A motion with five sines a coordinate inside the reach, sampled at 200 Hz, with the torque of p plus noise.
/// \param noise  standard deviation as a share of each drive's rms torque
inline Log synthetic_log(const Robot& robot, const Eigen::VectorXd& p, double noise, const HiddenTorque& hidden = {},
                         std::uint64_t seed = 1, double seconds = 6) {
  const auto samples = static_cast<Eigen::Index>(200 * seconds);
  const int n = robot.drives();
  const bool axis = robot.description().parts.empty();
  const WorkspaceBall ball = WorkspaceSampler(robot).ball();
  std::mt19937_64 random(seed);
  UniformDistribution phase(0, 6.28);
  NormalDistribution normal;
  Eigen::MatrixXd phases(n, 5);
  for (Eigen::Index k = 0; k < phases.size(); ++k) phases(k) = phase(random);
  Log log;
  log.file = "made_up.csv";
  log.t_s = Eigen::VectorXd::LinSpaced(samples, 0, static_cast<double>(samples - 1) / 200);
  for (Eigen::MatrixXd* m : {&log.q, &log.qd, &log.qdd, &log.tau}) m->resize(samples, n);
  Eigen::VectorXd q(n), qd(n), qdd(n), tau(n);
  for (Eigen::Index k = 0; k < samples; ++k) {
    TaskState task{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
    for (int i = 0; i < n; ++i) {
      if (!axis && i < 3) task.z(i) = ball.centre(i);
      const double amplitude = axis ? 0.05 : i < 3 ? 0.1 * ball.radius : 0.4;
      for (int h = 0; h < 5; ++h) {
        const double omega = 2 * M_PI * (0.35 + 0.45 * h), argument = omega * log.t_s(k) + phases(i, h);
        task.z(i) += amplitude * std::sin(argument);
        task.zd(i) += amplitude * omega * std::cos(argument);
        task.zdd(i) -= amplitude * omega * omega * std::sin(argument);
      }
    }
    EXPECT_EQ(robot.to_drives(task, q, qd, qdd), Status::ok);
    EXPECT_EQ(robot.inverse_dynamics(q, qd, qdd, p, tau), Status::ok);
    if (hidden) {
      for (int j = 0; j < n; ++j) tau(j) += hidden(j, q(j), qd(j));
    }
    log.q.row(k) = q;
    log.qd.row(k) = qd;
    log.qdd.row(k) = qdd;
    log.tau.row(k) = tau;
  }
  const Eigen::RowVectorXd rms = (log.tau.colwise().squaredNorm() / static_cast<double>(samples)).cwiseSqrt();
  for (Eigen::Index k = 0; k < samples; ++k) {
    for (int j = 0; j < n; ++j) log.tau(k, j) += noise * rms(j) * normal(random);
  }
  return log;
}

struct SyntheticRun {
  std::unique_ptr<Robot> robot;
  Eigen::VectorXd truth;
  Identification identification;
  Validation training;
  MassMatrixSurvey survey;
};

/// Everything that delta-identify hands to its report. The prior is 20 % too low.
inline SyntheticRun synthetic_run(const std::string& robot_name, double noise = 0.01, const HiddenTorque& hidden = {}) {
  SyntheticRun run;
  run.robot = shipped_robot(robot_name);
  run.truth = nominal_parameters(*run.robot, PartShapes(run.robot->description())).value;
  const std::vector<Log> logs = {synthetic_log(*run.robot, run.truth, noise, hidden)};
  IdentificationOptions options;
  options.processing.filter = false;
  options.threads = 1;
  run.identification = identify(*run.robot, logs, 0.8 * run.truth, {}, options);
  run.training = validate(*run.robot, logs, run.identification.fit.p, run.identification.processing, 1);
  run.survey = survey_mass_matrix(*run.robot, run.identification.fit.p, 200);
  return run;
}

}  // namespace deltadyn::testing_support
