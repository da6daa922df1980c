/// \file
/// Do the stated intervals of the base parameters hold, whatever the encoder and the cut-off?
///
///     encoder_study axis|delta4 BITS REPETITIONS [FIRST_SEED]
///
/// Each repetition is a log of its own: another motion, another noise, another phase of the encoder. Prints, for the
/// chosen cut-off and a third, half, twice and three times of it, the share of base parameters inside their 95 %
/// intervals.

#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "deltadyn/identification/identify.hpp"
#include "deltadyn/identification/log_processing.hpp"

#include "identification/axis_log.hpp"
#include "identification/synthetic_log.hpp"

namespace {

using namespace deltadyn;
using namespace deltadyn::testing_support;

constexpr double kFactors[] = {1.0 / 3, 0.5, 1, 2, 3};
constexpr double kInside = 1.96;

struct Machine {
  std::unique_ptr<Robot> robot;
  Eigen::VectorXd truth;
};

Machine machine_of(const std::string& name) {
  Machine machine;
  machine.robot = make_robot(name == "axis" ? axis_description(DriveKind::revolute) : delta_description(name));
  machine.truth = Eigen::VectorXd::Zero(machine.robot->parameters());
  if (name != "axis") {
    machine.truth = delta_truth(*machine.robot);
    return machine;
  }
  const AxisLog axis;
  const std::vector<std::string>& names = machine.robot->parameter_names();
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto p = static_cast<Eigen::Index>(k);
    if (names[k].find("viscous") != std::string::npos) machine.truth(p) = axis.viscous;
    if (names[k].find("coulomb") != std::string::npos) machine.truth(p) = axis.coulomb;
    if (names[k].find("mass") != std::string::npos) machine.truth(p) = 1;
    if (names[k].find("Ixx") != std::string::npos || names[k].find("Iyy") != std::string::npos ||
        names[k].find("Izz") != std::string::npos)
      machine.truth(p) = axis.inertia;
  }
  return machine;
}

Log log_of(const std::string& name, const Machine& machine, int bits, std::uint64_t seed) {
  if (name == "axis") {
    AxisLog axis;
    axis.seed = seed;
    axis.encoder_bits = bits;
    axis.base_hz = 0.31 + 0.013 * static_cast<double>(seed % 20);
    return axis.make();
  }
  SyntheticOptions options;
  options.duration_s = 10;
  options.torque_noise = 0.1;
  options.base_frequency_hz = 0.3;
  options.encoder_step = 2 * std::numbers::pi / std::exp2(bits);
  options.with_derivatives = false;
  options.seed = seed;
  return synthetic_log(*machine.robot, machine.truth, options);
}

struct Count {
  int inside = 0, all = 0;
  double bias = 0;  ///< sum of errors in units of the stated std, for those far out only its sign counts
  double square = 0;
  void add(double z) {
    inside += std::abs(z) < kInside ? 1 : 0;
    bias += z;
    square += z * z;
    ++all;
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(stderr, "usage: encoder_study axis|delta4 BITS REPETITIONS [FIRST_SEED]\n");
    return 2;
  }
  const std::string name = argv[1];
  const int bits = std::stoi(argv[2]), repetitions = std::stoi(argv[3]), first = argc > 4 ? std::stoi(argv[4]) : 1;
  const Machine machine = machine_of(name);
  std::map<double, std::map<std::string, Count>> counts;
  std::map<double, int> bristles;
  double cutoff_sum = 0;
  for (int k = first; k < first + repetitions; ++k) {
    const std::vector<Log> logs = {log_of(name, machine, bits, static_cast<std::uint64_t>(k))};
    const double chosen = choose_cutoff(logs).cutoff_hz;
    cutoff_sum += chosen;
    for (const double factor : kFactors) {
      IdentificationOptions options;
      options.threads = 1;
      options.choose_cutoff = false;
      options.processing.cutoff_hz = factor * chosen;
      try {
        const Identification found = identify(*machine.robot, logs, machine.truth, {}, options);
        for (const PreslidingJoint& joint : found.presliding) bristles[factor] += joint.displacement > 0 ? 1 : 0;
        const Eigen::VectorXd truth = found.base.B * machine.truth, std = found.base_estimate.std();
        for (Eigen::Index i = 0; i < truth.size(); ++i) {
          const std::string& what = found.base.expressions[static_cast<std::size_t>(i)];
          const bool friction = what.find("viscous") != std::string::npos || what.find("coulomb") != std::string::npos;
          const double z = (found.base_estimate.value(i) - truth(i)) / std(i);
          counts[factor][friction ? "friction" : "inertial"].add(z);
          counts[factor][what].add(z);
        }
      } catch (const std::exception& error) {
        ++counts[factor]["failed"].all;
      }
    }
  }
  fmt::print("{} {} bit, {} repetitions, cut-off chosen {:.1f} Hz\n", name, bits, repetitions,
             cutoff_sum / repetitions);
  for (const auto& [factor, by_name] : counts) {
    fmt::print("  x {:.2f}  {} bristles found, none is there\n", factor, bristles[factor]);
    for (const auto& [what, count] : by_name) {
      fmt::print("  x {:.2f}  {:40.40}  inside {:6.1f} %  mean {:6.2f} std, rms {:6.2f} std\n", factor, what,
                 100.0 * count.inside / count.all, count.bias / count.all, std::sqrt(count.square / count.all));
    }
  }
  return 0;
}
