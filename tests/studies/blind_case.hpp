#pragma once

/// \file
/// One case of the blind study: made, recorded, diagnosed, judged.

#include <cmath>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "deltadyn/diagnosis/diagnose.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"

#include "studies/blind_outcome.hpp"
#include "studies/drawn_case.hpp"
#include "studies/user_chain.hpp"
#include "support/descriptions.hpp"

namespace deltadyn::blind {

inline Case make_case(const std::string& part, int index) {
  Random random(1000003u * static_cast<unsigned>(index + 1) + (part == "effects" ? 1u
                                                               : part == "clean" ? 2u
                                                               : part == "pairs" ? 3u
                                                                                 : 4u));
  Case blind;
  const bool four = index % 2 == 0;
  blind.robot = four ? testing_support::delta_description("delta4") : testing_support::delta_description("delta3");
  const auto robot = make_robot(blind.robot);
  blind.parameters = nominal_parameters(*robot, PartShapes(robot->description())).value;
  for (int k = 0; k < robot->parameters(); ++k) {
    const std::string& name = robot->parameter_names()[static_cast<std::size_t>(k)];
    if (name.rfind("drive", 0) == 0 && name.find("coulomb") != std::string::npos)
      blind.parameters(k) = coulomb_of(name[5] - '1');
    if (name.rfind("drive", 0) == 0 && name.find("viscous") != std::string::npos)
      blind.parameters(k) = name[5] == '4' ? 0.02 : 1.5;
  }
  blind.seed = static_cast<std::uint64_t>(index) * 7919u + 17u;
  const double size = between(random, 0, 1);
  const int drives = robot->drives();
  if (part == "effects") {
    const auto& names = hidden_names();
    blind.hidden.push_back(make_hidden(names[static_cast<std::size_t>(index) % names.size()], drives, size, random));
    blind.noise.encoder_rad = 3e-6;
    if (blind.hidden.back().spring) blind.harmonics = 10;
  } else if (part == "pairs") {
    const auto& names = hidden_names();
    const auto a = static_cast<std::size_t>(between(random, 0, static_cast<double>(names.size()) - 0.01));
    const auto b =
        (a + 1 + static_cast<std::size_t>(between(random, 0, static_cast<double>(names.size()) - 2.01))) % names.size();
    blind.hidden.push_back(make_hidden(names[a], drives, 0.3 + 0.7 * size, random));
    blind.hidden.push_back(make_hidden(names[b], drives, 0.3 + 0.7 * between(random, 0, 1), random));
    if (blind.hidden.front().spring || blind.hidden.back().spring) blind.harmonics = 10;
  } else if (part == "outside") {
    blind.hidden.push_back(make_outside(index, drives, size, random));
  } else {
    const double correlations[] = {0.0, 0.9, 0.98};
    blind.noise.correlation = correlations[index % 3];
    blind.noise.encoder_rad = std::pow(10.0, between(random, -6, -4));
  }
  return blind;
}

/// A case of a robot drawn at random, through the chain of tools that its user has.
inline Outcome run_drawn(const std::string& part, int index, int null_runs) {
  const DrawnCase drawn = make_drawn_case(part, index);
  Outcome out;
  out.truth = truth_of(drawn.hidden);
  out.strength = drawn.strength;
  out.type = drawn.type;
  out.motion = motion_name(drawn.motion);
  out.dirty = drawn.machine.dirt.any();
  out.rate_hz = drawn.rate_hz;
  out.noise = fmt::format("rho {} encoder {:.1e}{}", drawn.noise.correlation, drawn.encoder_step.front(),
                          drawn.strong ? "" : " weak");
  const std::vector<Log> logs = record_drawn(drawn);
  if (logs.size() != 3) {
    out.verdict = "not-simulated";
    return out;
  }
  const auto robot = make_robot(drawn.machine.robot, drawn.machine.layout);
  const LogFiles files(logs, drawn.machine.robot, fmt::format("{}-{}", part, index));
  try {
    // Of a clean machine the user has parameters a few per cent off, of a dirty one those that delta-identify finds.
    ParameterFile file{1.03 * drawn.machine.parameters, {}, ""};
    if (out.dirty) {
      file = run_identify(*robot, files.read({"fast", "slow"}));
      out.noise += "; identified " + file.remark;
    }
    judge(*robot, run_diagnose(*robot, files, file, null_runs), drawn.hidden, out);
  } catch (const Error& e) {
    out.verdict = "refused";
    fmt::print("# {}-{}: {}\n", part, index, e.what());
  }
  return out;
}

inline Outcome run_case(const std::string& part, int index, int null_runs) {
  if (is_drawn(part)) return run_drawn(part, index, null_runs);
  const Case blind = make_case(part, index);
  Outcome out;
  out.truth = truth_of(blind.hidden);
  out.type = blind.robot.type;
  out.noise = fmt::format("rho {} encoder {:.1e}", blind.noise.correlation, blind.noise.encoder_rad);
  const std::vector<Log> logs = record(blind, &out.strength);
  if (logs.size() != 3) {
    out.verdict = "not-simulated";
    return out;
  }
  const auto robot = make_robot(blind.robot);
  DiagnosisOptions options;
  options.null_runs = null_runs;
  options.identify = false;
  // The user's own parameters are not the truth: a few per cent off, as an identification with the effect in the logs
  // would be.
  judge(*robot, diagnose(*robot, {logs[0], logs[1]}, &logs[2], 1.03 * blind.parameters, {}, {}, options), blind.hidden,
        out);
  return out;
}

}  // namespace deltadyn::blind
