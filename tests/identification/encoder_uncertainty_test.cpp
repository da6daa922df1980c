#include "../../src/identification/encoder_uncertainty.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <iostream>

#include "deltadyn/identification/identify.hpp"

#include "identification/axis_log.hpp"
#include "identification/synthetic_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

/// Share of the motion's square over that of time, of a log: a figure that coarse steps move.
Eigen::VectorXd mean_square_rate(const std::vector<Log>& logs) {
  const Eigen::VectorXd q = logs.front().q.col(0);
  return Eigen::VectorXd::Constant(1, (q.tail(q.size() - 20) - q.head(q.size() - 20)).squaredNorm());
}

TEST(EncoderUncertainty, IsTheSpreadOverThePhasesOfTheEncoder) {
  AxisLog axis;
  axis.encoder_bits = 9;
  const Eigen::MatrixXd found = encoder_covariance({axis.make()}, 10, mean_square_rate);
  ASSERT_EQ(found.size(), 1);
  // The same over phases of the true motion.
  AxisLog fine;
  const Log truth = fine.make();
  const double step = 2 * 3.14159265358979323846 / 512;
  double sum = 0, square = 0;
  constexpr int kPhases = 200;
  for (int k = 0; k < kPhases; ++k) {
    Log log = truth;
    log.q = step * ((truth.q.array() / step) + (k + 0.5) / kPhases).round() - step * (k + 0.5) / kPhases;
    const double value = mean_square_rate({log})(0);
    sum += value;
    square += value * value;
  }
  const double std = std::sqrt(square / kPhases - sum * sum / kPhases / kPhases);
  EXPECT_GT(std::sqrt(found(0, 0)), std / 2);
  EXPECT_LT(std::sqrt(found(0, 0)), std * 2);
}

TEST(EncoderUncertainty, FineStepsAddNothing) {
  AxisLog axis;
  axis.encoder_bits = 22;
  EXPECT_EQ(encoder_covariance({axis.make()}, 10, mean_square_rate).size(), 0);
}

// Ten logs of one drive with 12 bit encoders: errors as large as stated, at the chosen cut-off, below and above it.
TEST(EncoderUncertainty, IntervalsHoldWithCoarseEncoders) {
  const auto robot = make_robot(axis_description(DriveKind::revolute));
  for (const double factor : {1.0 / 3, 1.0, 3.0}) {
    double square = 0, count = 0;
    for (std::uint64_t seed = 401; seed < 411; ++seed) {
      AxisLog axis;
      axis.seed = seed;
      axis.encoder_bits = 12;
      axis.base_hz = 0.31 + 0.013 * static_cast<double>(seed % 20);
      const std::vector<Log> logs = {axis.make()};
      IdentificationOptions options;
      options.choose_cutoff = false;
      options.processing.cutoff_hz = factor * choose_cutoff(logs).cutoff_hz;
      Eigen::VectorXd prior = Eigen::VectorXd::Zero(robot->parameters());
      for (std::size_t k = 0; k < robot->parameter_names().size(); ++k) {
        const std::string& name = robot->parameter_names()[k];
        const auto p = static_cast<Eigen::Index>(k);
        if (name.ends_with(".m")) prior(p) = 1;
        if (name.ends_with("Ixx") || name.ends_with("Iyy") || name.ends_with("Izz")) prior(p) = axis.inertia;
        if (name.ends_with("viscous")) prior(p) = axis.viscous;
        if (name.ends_with("coulomb")) prior(p) = axis.coulomb;
      }
      const Identification found = identify(*robot, logs, prior, {}, options);
      for (Eigen::Index k = 0; k < found.base.count(); ++k) {
        const std::string& name = found.base.expressions[static_cast<std::size_t>(k)];
        const double truth = name.find("Iyy") != std::string::npos       ? axis.inertia
                             : name.find("viscous") != std::string::npos ? axis.viscous
                             : name.find("coulomb") != std::string::npos ? axis.coulomb
                                                                         : 0.0;
        const double error = (found.base_estimate.value(k) - truth) / found.base_estimate.std()(k);
        square += error * error;
        ++count;
      }
    }
    const double rms = std::sqrt(square / count);
    std::cout << "  x " << factor << ": errors of " << rms << " stated standard deviations\n";
    EXPECT_GT(rms, 0.4);
    EXPECT_LT(rms, 1.4);
  }
}

TEST(EncoderUncertainty, FewStepsASampleAreCoarse) {
  AxisLog axis;
  axis.encoder_bits = 12;
  EXPECT_TRUE(has_coarse_encoders({axis.make()}));
  axis.encoder_bits = 17;
  EXPECT_FALSE(has_coarse_encoders({axis.make()}));
}

// On a robot the steps of 12 bits bend the friction about the reversals: both are told from the motion without them.
TEST(EncoderUncertainty, FrictionOfARobotIsRightWithCoarseEncoders) {
  const auto robot = make_robot(delta_description("delta4"));
  const Eigen::VectorXd truth = delta_truth(*robot);
  double square = 0, count = 0;
  for (const std::uint64_t seed : {5000U, 5001U, 5003U}) {
    const std::vector<Log> logs = {synthetic_log(*robot, truth, coarse_recording(seed))};
    const Identification found = identify(*robot, logs, truth, {}, IdentificationOptions{});
    const Eigen::VectorXd right = found.base.B * truth, std = found.base_estimate.std();
    for (Eigen::Index k = 0; k < right.size(); ++k) {
      const std::string& name = found.base.expressions[static_cast<std::size_t>(k)];
      if (name.find("coulomb") == std::string::npos && name.find("viscous") == std::string::npos) continue;
      square += std::pow((found.base_estimate.value(k) - right(k)) / std(k), 2);
      ++count;
    }
  }
  const double rms = std::sqrt(square / count);
  std::cout << "  errors of " << rms << " stated standard deviations\n";
  EXPECT_GT(rms, 0.4);
  EXPECT_LT(rms, 1.4);
}

}  // namespace
}  // namespace deltadyn
