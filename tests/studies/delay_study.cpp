/// \file
/// Is a delay between torque and position found, and does its interval hold?
///
///     delay_study delta3|linear-delta3|delta4 REPETITIONS [FIRST_SEED]
///
/// Each repetition is another motion and another delay between -5 and +10 ms beside Coulomb friction. Prints the
/// largest error, the share inside 3 standard deviations, and the largest error of the drives' friction from the mended
/// logs.

#include <cmath>
#include <fmt/format.h>
#include <random>
#include <string>
#include <vector>

#include "deltadyn/identification/identify.hpp"
#include "deltadyn/identification/log_gate.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/signal/torque_timing_mend.hpp"

#include "identification/synthetic_log.hpp"

namespace {

using namespace deltadyn;
using namespace deltadyn::testing_support;

std::vector<Log> recorded(const Robot& robot, std::uint64_t seed, double fast_hz) {
  std::vector<Log> logs;
  for (const std::uint64_t part : {0U, 1U}) {
    SyntheticOptions options;
    options.duration_s = 10;
    options.torque_noise = 0.1;
    const bool turns = robot.description().drive_kind == DriveKind::revolute;
    options.encoder_step = (turns ? 6.283 : 0.5) / std::exp2(19);
    options.with_derivatives = false;
    options.seed = 10 * seed + part;
    options.base_frequency_hz = part == 0 ? fast_hz : 0.15;
    logs.push_back(synthetic_log(robot, delta_truth(robot), options));
    logs.back().file = part == 0 ? "fast" : "slow";
  }
  return logs;
}

/// Largest relative error of the drives' Coulomb and viscous friction.
double friction_error(const Robot& robot, const std::vector<Log>& logs) {
  const Eigen::VectorXd truth = delta_truth(robot);
  IdentificationOptions options;
  options.threads = 1;
  const Identification found = identify(robot, logs, truth, {}, options);
  double worst = 0;
  for (int k = 0; k < robot.parameters(); ++k) {
    const std::string& name = robot.parameter_names()[static_cast<std::size_t>(k)];
    if (name.rfind("drive", 0) == 0 && name.find('.') != std::string::npos)
      worst = std::max(worst, std::abs(found.fit.p(k) / truth(k) - 1));
  }
  return worst;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: delay_study delta3|linear-delta3|delta4 REPETITIONS [FIRST_SEED]\n");
    return 2;
  }
  const auto robot = make_robot(delta_description(argv[1]));
  const Eigen::VectorXd truth = delta_truth(*robot), prior = 1.3 * truth;
  const Eigen::VectorXd std = (0.5 * prior.cwiseAbs()).cwiseMax(0.001);
  const int repetitions = std::stoi(argv[2]), first = argc > 3 ? std::stoi(argv[3]) : 1;
  int found = 0, inside = 0;
  double largest = 0, friction = 0;
  for (int k = first; k < first + repetitions; ++k) {
    std::mt19937_64 random(static_cast<std::uint64_t>(k));
    const double delay = UniformDistribution(-5e-3, 10e-3)(random);
    const double fast_hz = UniformDistribution(0.35, 0.7)(random);
    std::vector<Log> logs = recorded(*robot, static_cast<std::uint64_t>(k), fast_hz);
    for (Log& log : logs)
      for (Eigen::Index j = 0; j < log.drives(); ++j) log.tau.col(j) = mend_timing(log.tau.col(j), 1e-3, -delay, 0);
    const GateResult result = examine_logs(*robot, logs, prior, std);
    const LogFinding* finding = nullptr;
    for (const LogFinding& f : result.findings)
      if (f.level == FindingLevel::mended && (f.key == "delay" || f.key == "lag")) finding = &f;
    if (finding == nullptr) {
      fmt::print("seed {}: delay {:.3f} ms not found ({:.2f} Hz)\n", k, 1e3 * delay, fast_hz);
      for (const LogFinding& f : result.findings) fmt::print("    {}\n", f.text);
      continue;
    }
    ++found;
    const double error = finding->value - delay;
    largest = std::max(largest, std::abs(error));
    if (std::abs(error) <= 3 * finding->std) {
      ++inside;
    } else {
      fmt::print("seed {}: {} {:.4f} ms for {:.4f} ms, std {:.4f} ms\n", k, finding->key, 1e3 * finding->value,
                 1e3 * delay, 1e3 * finding->std);
    }
    const double worst = friction_error(*robot, result.logs);
    if (worst > 0.01) fmt::print("seed {}: friction off by {:.2f} % ({:.2f} ms)\n", k, 100 * worst, 1e3 * delay);
    friction = std::max(friction, worst);
  }
  fmt::print("{}: {} of {} found, largest error {:.4f} ms, {:.1f} % inside 3 std, drive friction within {:.2f} %\n",
             argv[1], found, repetitions, 1e3 * largest, 100.0 * inside / std::max(1, found), 100 * friction);
  return 0;
}
