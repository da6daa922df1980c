#pragma once

/// \file
/// One case of the blind study: made, recorded, diagnosed, judged.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "deltadyn/report/diagnosis_text.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"

#include "studies/blind_effects.hpp"
#include "support/descriptions.hpp"

namespace deltadyn::blind {

struct Outcome {
  std::string truth, joint, verdict, named, set, noise;  ///< truth and named: "effect@joint;effect@joint"
  double strength = 0, gap_shrink = 0, share = 0, time_s = 0;
  double size = 0, found_size = 0, found_std = 0;  ///< of a single effect; 0 where forms cannot be compared
};

/// Size of an effect in one number: two amplitudes of a wave or an angle are a length.
inline void size_of(const Effect& effect, double& size, double& std) {
  const auto has_std = effect.amplitude_std.size() == effect.amplitude.size();
  const bool plane = effect.id == effect_id<effects::TorqueRipple> || effect.id == effect_id<effects::BaseTilt>;
  size = plane ? effect.amplitude.norm() : std::abs(effect.amplitude(0));
  std = !has_std ? 0.0 : plane ? effect.amplitude_std.dot(effect.amplitude.cwiseAbs()) / size : effect.amplitude_std(0);
}

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

inline Outcome run_case(const std::string& part, int index, int null_runs) {
  const Case blind = make_case(part, index);
  Outcome out;
  for (const Hidden& hidden : blind.hidden)
    out.truth += (out.truth.empty() ? "" : ";") + hidden.truth + "@" + hidden.joint;
  if (out.truth.empty()) out.truth = "nothing";
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
  const Diagnosis result = diagnose(*robot, {logs[0], logs[1]}, &logs[2], 1.03 * blind.parameters, {}, {}, options);
  out.verdict = verdict_name(result.verdict);
  out.share = result.explained_share;
  out.gap_shrink = result.gap_shrink;
  out.time_s = result.total_time_s;
  if (std::getenv("BLIND_VERBOSE") != nullptr) {
    const DiagnosisText words = diagnosis_text(*robot, result);
    fmt::print("# {} (cut-off {:.3g} Hz)\n", words.headline, result.cutoff_hz);
    for (const auto* texts : {&words.lines, &words.notes}) {
      for (const std::string& text : *texts) fmt::print("#   {}\n", text);
    }
  }
  const bool names = gives_a_name(result.verdict);
  for (const NamedEffect& one : result.named) {
    if (!names) break;
    out.named += (out.named.empty() ? "" : ";") + one.name + "@" + one.joint;
    for (const EffectCandidate& other : one.confusable)
      out.set += (out.set.empty() ? "" : ";") + other.name + "@" + other.joint;
  }
  if (names && blind.hidden.size() == 1 && result.named.front().name == blind.hidden.front().truth &&
      std::isfinite(blind.hidden.front().amplitude)) {
    out.size = blind.hidden.front().amplitude;
    size_of(result.named.front().effect, out.found_size, out.found_std);
  }
  return out;
}

inline std::string to_line(const std::string& id, const Outcome& o) {
  return fmt::format("{},{},{:.3g},{},{},{},{},{:.3f},{:.3f},{:.1f},{:.5g},{:.5g},{:.3g}", id, o.truth, o.strength,
                     o.noise, o.verdict, o.named, o.set, o.share, o.gap_shrink, o.time_s, o.size, o.found_size,
                     o.found_std);
}

using Outcomes = std::vector<std::pair<std::string, Outcome>>;

inline Outcomes read_outcomes(const std::string& path) {
  Outcomes all;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> field;
    std::istringstream stream(line);
    for (std::string part; std::getline(stream, part, ',');) field.push_back(part);
    if (field.size() < 13) continue;
    Outcome o;
    o.truth = field[1];
    o.strength = std::stod(field[2]);
    o.noise = field[3];
    o.verdict = field[4];
    o.named = field[5];
    o.set = field[6];
    o.share = std::stod(field[7]);
    o.gap_shrink = std::stod(field[8]);
    o.time_s = std::stod(field[9]);
    o.size = std::stod(field[10]);
    o.found_size = std::stod(field[11]);
    o.found_std = std::stod(field[12]);
    all.emplace_back(field[0], o);
  }
  return all;
}

inline std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ';');) out.push_back(part);
  return out;
}

inline std::string effect_of(const std::string& text) {
  return text.substr(0, text.find('@'));
}

inline std::string class_of(const std::string& text) {
  const EffectKind* kind = find_effect_kind(effect_of(text));
  return kind != nullptr ? std::string(effect_class_name(kind->effect_class)) : "";
}

inline void print_summary(const Outcomes& all) {
  std::map<std::string, std::vector<Outcome>> parts;
  for (const auto& [id, o] : all) parts[id.substr(0, id.find('-'))].push_back(o);
  const auto line = [](const char* what, int good, int of) {
    fmt::print("{:<58} {:>4} of {:<4} {:.1f} %\n", what, good, of, of > 0 ? 100.0 * good / of : 0.0);
  };
  int named_clean = 0;
  for (const Outcome& o : parts["clean"]) named_clean += o.named.empty() ? 0 : 1;
  line("clean logs: an effect named", named_clean, static_cast<int>(parts["clean"].size()));
  int found = 0, first = 0, right_class = 0, inside = 0, joint = 0;
  std::size_t set_size = 0;
  std::vector<double> shrink;
  for (const Outcome& o : parts["effects"]) {
    if (o.named.empty()) continue;
    ++found;
    const auto named = split(o.named);
    auto set = split(o.set);
    set.insert(set.begin(), named[0]);
    first += effect_of(named[0]) == effect_of(o.truth) ? 1 : 0;
    right_class += class_of(named[0]) == class_of(o.truth) ? 1 : 0;
    joint += named[0].substr(named[0].find('@')) == o.truth.substr(o.truth.find('@')) ? 1 : 0;
    inside +=
        std::any_of(set.begin(), set.end(), [&](const std::string& s) { return effect_of(s) == effect_of(o.truth); })
            ? 1
            : 0;
    set_size += set.size();
    if (std::isfinite(o.gap_shrink)) shrink.push_back(o.gap_shrink);
  }
  line("effects: something named", found, static_cast<int>(parts["effects"].size()));
  line("  of these: right effect first", first, found);
  line("  of these: right class first", right_class, found);
  line("  of these: truth inside the set", inside, found);
  line("  of these: right joint", joint, found);
  std::sort(shrink.begin(), shrink.end());
  if (!shrink.empty()) {
    fmt::print("  mean size of the set {:.2f}; gap shrink: median {:.3f}, smallest {:.3f}\n",
               static_cast<double>(set_size) / found, shrink[shrink.size() / 2], shrink.front());
  }
  int sizes = 0, close = 0, covered = 0;
  std::vector<double> strength;
  for (const Outcome& o : parts["effects"]) {
    if (o.strength > 0) strength.push_back(o.strength);
    if (!(o.size > 0)) continue;
    ++sizes;
    close += std::abs(o.found_size / o.size - 1) <= 0.05 ? 1 : 0;
    covered += std::abs(o.found_size - o.size) <= 1.96 * o.found_std ? 1 : 0;
  }
  line("  sizes that can be compared: within 5 %", close, sizes);
  line("  sizes that can be compared: truth inside the 95 % interval", covered, sizes);
  std::sort(strength.begin(), strength.end());
  if (!strength.empty()) {
    fmt::print("  strength (rms torque over noise, where it is a torque): {:.2g} to {:.2g}, median {:.2g}\n",
               strength.front(), strength.back(), strength[strength.size() / 2]);
  }
  int both = 0, in_sets = 0;
  for (const Outcome& o : parts["pairs"]) {
    const auto truth = split(o.truth), named = split(o.named);
    auto reported = split(o.set);
    reported.insert(reported.end(), named.begin(), named.end());
    const auto is_reported = [&](const std::string& hidden) {
      return std::any_of(reported.begin(), reported.end(),
                         [&](const std::string& r) { return effect_of(r) == effect_of(hidden); });
    };
    in_sets += named.size() == 2 && is_reported(truth[0]) && is_reported(truth[1]) ? 1 : 0;
    both += named.size() == 2 &&
                    ((effect_of(named[0]) == effect_of(truth[0]) && effect_of(named[1]) == effect_of(truth[1])) ||
                     (effect_of(named[1]) == effect_of(truth[0]) && effect_of(named[0]) == effect_of(truth[1])))
                ? 1
                : 0;
  }
  line("pairs: both and no other", both, static_cast<int>(parts["pairs"].size()));
  line("pairs: both, each by name or in the reported sets, and no other", in_sets,
       static_cast<int>(parts["pairs"].size()));
  int unknown = 0;
  for (const Outcome& o : parts["outside"]) unknown += o.named.empty() ? 1 : 0;
  line("outside the catalogue: no wrong name", unknown, static_cast<int>(parts["outside"].size()));
}

}  // namespace deltadyn::blind
