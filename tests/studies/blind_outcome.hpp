#pragma once

/// \file
/// What came out of one case of the blind study, as a line of a CSV file and read back from there.

#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "deltadyn/report/diagnosis_text.hpp"

#include "studies/blind_plant.hpp"

namespace deltadyn::blind {

struct Outcome {
  std::string truth, joint, verdict, named, set, noise;  ///< truth and named: "effect@joint;effect@joint"
  double strength = 0, gap_shrink = 0, share = 0, time_s = 0;
  double size = 0, found_size = 0, found_std = 0;  ///< of a single effect; 0 where forms cannot be compared
  std::string type = "delta4", motion = "fourier";
  bool dirty = false;
  double rate_hz = 1000;
};

/// Size of an effect in one number: two amplitudes of a wave or an angle are a length.
inline void size_of(const Effect& effect, double& size, double& std) {
  const auto has_std = effect.amplitude_std.size() == effect.amplitude.size();
  const bool plane = effect.id == effect_id<effects::TorqueRipple> || effect.id == effect_id<effects::BaseTilt>;
  size = plane ? effect.amplitude.norm() : std::abs(effect.amplitude(0));
  std = !has_std ? 0.0 : plane ? effect.amplitude_std.dot(effect.amplitude.cwiseAbs()) / size : effect.amplitude_std(0);
}

/// What is hidden, in the words of a diagnosis.
inline std::string truth_of(const std::vector<Hidden>& hidden) {
  std::string truth;
  for (const Hidden& one : hidden) truth += (truth.empty() ? "" : ";") + one.truth + "@" + one.joint;
  return truth.empty() ? "nothing" : truth;
}

/// The whole of what was found, where the environment asks for it.
inline void tell_if_asked(const Robot& robot, const Diagnosis& result) {
  if (std::getenv("BLIND_VERBOSE") == nullptr) return;
  const DiagnosisText words = diagnosis_text(robot, result);
  fmt::print("# {} (cut-off {:.3g} Hz)\n", words.headline, result.cutoff_hz);
  for (const auto* texts : {&words.lines, &words.notes}) {
    for (const std::string& text : *texts) fmt::print("#   {}\n", text);
  }
}

inline void judge(const Robot& robot, const Diagnosis& result, const std::vector<Hidden>& hidden, Outcome& out) {
  out.verdict = verdict_name(result.verdict);
  out.share = result.explained_share;
  out.gap_shrink = result.gap_shrink;
  out.time_s = result.total_time_s;
  tell_if_asked(robot, result);
  if (!gives_a_name(result.verdict)) return;
  for (const NamedEffect& one : result.named) {
    out.named += (out.named.empty() ? "" : ";") + one.name + "@" + one.joint;
    for (const EffectCandidate& other : one.confusable)
      out.set += (out.set.empty() ? "" : ";") + other.name + "@" + other.joint;
  }
  if (hidden.size() == 1 && result.named.front().name == hidden.front().truth &&
      std::isfinite(hidden.front().amplitude)) {
    out.size = hidden.front().amplitude;
    size_of(result.named.front().effect, out.found_size, out.found_std);
  }
}

inline std::string to_line(const std::string& id, const Outcome& o) {
  return fmt::format("{},{},{:.3g},{},{},{},{},{:.3f},{:.3f},{:.1f},{:.5g},{:.5g},{:.3g},{},{},{:g},{}", id, o.truth,
                     o.strength, o.noise, o.verdict, o.named, o.set, o.share, o.gap_shrink, o.time_s, o.size,
                     o.found_size, o.found_std, o.type, o.dirty ? 1 : 0, o.rate_hz, o.motion);
}

/// "a@x;b@y" as a list.
inline std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ';');) out.push_back(part);
  return out;
}

inline std::string effect_of(const std::string& text) {
  return text.substr(0, text.find('@'));
}

inline std::string joint_of(const std::string& text) {
  return text.substr(text.find('@') + 1);
}

inline std::string class_of(const std::string& text) {
  const EffectKind* kind = find_effect_kind(effect_of(text));
  return kind != nullptr ? std::string(effect_class_name(kind->effect_class)) : "";
}

using Outcomes = std::vector<std::pair<std::string, Outcome>>;

/// The part of an id such as "any-effects-12".
inline std::string part_of(const std::string& id) {
  return id.substr(0, id.rfind('-'));
}

inline int index_of_case(const std::string& id) {
  return std::atoi(id.substr(id.rfind('-') + 1).c_str());
}

/// Lines have 17 fields; older ones, of the two fixed robots at 1 kHz, have 13. Throws Error(bad_input) for any other.
inline Outcomes read_outcomes(const std::string& path) {
  constexpr std::size_t kOld = 13, kNew = 17;
  Outcomes all;
  std::ifstream file(path);
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    std::vector<std::string> field;
    std::istringstream stream(line);
    for (std::string part; std::getline(stream, part, ',');) field.push_back(part);
    if (field.empty()) continue;
    if (field.size() != kOld && field.size() != kNew) {
      throw Error(fmt::format("{} fields where a case has {}", field.size(), kNew),
                  fmt::format("{}, line {}", path, number), "write the study into a file of its own");
    }
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
    o.type = field.size() == kNew ? field[13] : index_of_case(field[0]) % 2 == 0 ? "delta4" : "delta3";
    if (field.size() == kNew) {
      o.dirty = field[14] == "1";
      o.rate_hz = std::stod(field[15]);
      o.motion = field[16];
    }
    all.emplace_back(field[0], o);
  }
  return all;
}

}  // namespace deltadyn::blind
