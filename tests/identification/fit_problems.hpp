#pragma once

/// \file
/// Synthetic folded data for the tests of the consistent fit.

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "deltadyn/identification/consistent_fit.hpp"
#include "deltadyn/model/inertial_parameters.hpp"
#include "deltadyn/runtime/effect_states.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "identification/synthetic_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn::testing_support {

struct NamedValue {
  std::string name;
  double value;
};

/// The plant of the shared data set, in the order of the regressor.
inline std::vector<NamedValue> delta4_truth(bool rotor_inertia = true) {
  std::vector<NamedValue> truth;
  auto body = [&](const std::string& name, const std::vector<double>& p) {
    for (std::size_t i = 0; i < p.size(); ++i) truth.push_back({name + "." + kInertialNames[i], p[i]});
  };
  body("upper_arm", {1.1, 0.091, 0, 0.009, 0.012, 0.189, 0.181, 0, 0, 0});
  body("strut", {0.278, 0.104, 0, 0, 0.0246, 0.114, 0.116, 0, 0, 0});
  body("platform", {1.23, 0, 0, 0, 0.004, 0.004, 0.006, 0, 0, 0});
  body("tool", {0.4, 0, 0, -0.02, 0.003, 0.003, 0.00287, 0, 0, 0});
  body("telescope_upper", {0.732, 0, 0, -0.305, 0.148, 0.148, 4e-05, 0, 0, 0});
  body("telescope_lower", {0.483, 0, 0, 0.239, 0.126, 0.126, 3e-05, 0, 0, 0});
  const double friction[] = {1.576, 4.659, 1.667, 4.644, 1.411, 6.353, 0.019, 0.807, 4.08, 5.36};
  const char* joints[] = {"drive1", "drive2", "drive3", "drive4", "telescope"};
  for (int j = 0; j < 5; ++j) {
    truth.push_back({std::string(joints[j]) + ".viscous", friction[2 * j]});
    truth.push_back({std::string(joints[j]) + ".coulomb", friction[2 * j + 1]});
  }
  if (rotor_inertia) truth.push_back({"drive4.rotor_inertia", 0.0004});
  return truth;
}

/// What the motion of a delta4 cannot show, or what section VI sets to 0: these columns are 0 here.
inline bool is_dropped(const std::string& name) {
  static const std::vector<std::string> kept = {"upper_arm.mcx",
                                                "upper_arm.mcz",
                                                "upper_arm.Iyy",
                                                "strut.m",
                                                "strut.mcx",
                                                "strut.Ixx",
                                                "strut.Iyy",
                                                "strut.Izz",
                                                "platform.m",
                                                "tool.m",
                                                "tool.mcx",
                                                "tool.mcy",
                                                "tool.Izz",
                                                "telescope_upper.mcz",
                                                "telescope_upper.Ixx",
                                                "telescope_upper.Iyy",
                                                "telescope_upper.Izz",
                                                "telescope_lower.m",
                                                "telescope_lower.mcz",
                                                "telescope_lower.Ixx",
                                                "telescope_lower.Iyy",
                                                "telescope_lower.Izz"};
  const std::string part = name.substr(name.find('.') + 1);
  const bool scalar = part == "viscous" || part == "coulomb" || part == "rotor_inertia" || part == "offset";
  return !scalar && std::find(kept.begin(), kept.end(), name) == kept.end();
}

inline Eigen::VectorXd values_of(const std::vector<NamedValue>& named) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(named.size()));
  for (std::size_t i = 0; i < named.size(); ++i) values(static_cast<Eigen::Index>(i)) = named[i].value;
  return values;
}

/// A of the given rank in noise units: a direction of unit relative size is seen with `precision` standard deviations
/// on average, spread over three decades as in a real regressor; b = A truth + unit noise.
inline ConsistentFitProblem random_problem(unsigned seed, int rank, double precision, double prior_factor, bool drop,
                                           double noise = 1) {
  const std::vector<NamedValue> truth = delta4_truth();
  const Eigen::VectorXd p = values_of(truth);
  const auto P = p.size();
  std::mt19937 random(seed);
  NormalDistribution normal;
  Eigen::MatrixXd rows(rank, P);
  for (int i = 0; i < rank; ++i) {
    const double strength = precision * std::pow(10.0, -3.0 * i / rank);
    for (Eigen::Index j = 0; j < P; ++j) {
      const double size = p(j) != 0 ? std::abs(p(j)) : 0.05;
      const bool zero = drop && is_dropped(truth[static_cast<std::size_t>(j)].name);
      rows(i, j) = zero ? 0 : strength * normal(random) / size;
    }
  }
  Eigen::MatrixXd square(P, rank);
  for (Eigen::Index i = 0; i < P; ++i) {
    for (int j = 0; j < rank; ++j) square(i, j) = normal(random);
  }
  const Eigen::MatrixXd Q =
      Eigen::HouseholderQR<Eigen::MatrixXd>(square).householderQ() * Eigen::MatrixXd::Identity(P, rank);
  ConsistentFitProblem problem;
  for (const NamedValue& named : truth) problem.parameters.push_back(parameter_id(named.name).value());
  problem.A = Q * rows;
  problem.b = problem.A * p;
  for (Eigen::Index i = 0; i < P; ++i) problem.b(i) += noise * normal(random);
  problem.prior = prior_factor * p;
  return problem;
}

/// A small delta3 whose axes lean.
inline RobotDescription leaning_delta(const Eigen::Vector3d& tilts) {
  RobotDescription description = delta_description("delta3", {0.2, 0.06, 0.3, 0.65, 0.06});
  for (int limb = 0; limb < 3; ++limb) description.limbs[static_cast<std::size_t>(limb)].tilt = tilts(limb);
  return description;
}

/// Torques of a delta3 at random states while a force that no parameter explains lifts its plate.
/// \param lift  [N]
inline ConsistentFitProblem lifted_robot(unsigned seed, const Eigen::Vector3d& tilts, double lift) {
  constexpr int kStates = 40;
  constexpr double kNoise = 0.01;  // [N m]
  const RobotDescription description = leaning_delta(tilts);
  const auto robot = make_robot(description);
  const auto plate = make_effect_states(description);
  const Eigen::VectorXd truth = 0.1 * delta_truth(*robot);
  WorkspaceSampler states(*robot, seed);
  ConsistentFitProblem problem;
  problem.parameters = robot->parameter_ids();
  problem.A.resize(3 * kStates, robot->parameters());
  problem.b.resize(3 * kStates);
  problem.prior = 0.8 * truth;
  Eigen::VectorXd q(3), qd(3), qdd(3);
  Eigen::MatrixXd Y(3, robot->parameters());
  for (int k = 0; k < kStates; ++k) {
    states.next(q, qd, qdd);
    EffectState state;
    if (robot->regressor(q, qd, qdd, Y) != Status::ok || plate->at(q, qd, qdd, state) != Status::ok)
      throw std::runtime_error("a state of the sampler is not regular");
    problem.A.middleRows(3 * k, 3) = Y / kNoise;
    problem.b.segment(3 * k, 3) = (Y * truth - state.J.transpose() * Eigen::Vector3d(0, 0, lift)) / kNoise;
  }
  return problem;
}

inline InertialVector<double> body_of(const Eigen::VectorXd& p, int body) {
  return p.segment<10>(10 * body);
}

}  // namespace deltadyn::testing_support
