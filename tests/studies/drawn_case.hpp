#pragma once

/// \file
/// The cases of the blind study that are drawn at random, each a function of its part and its index alone.
///
/// Parts: any-effects, any-clean, any-pairs, any-outside (clean machines), dirty-effects, dirty-clean (everything
/// slightly wrong at once). Indices below kFirstReport are for tuning the diagnosis, those from there on for reporting.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "studies/drawn_machine_effects.hpp"
#include "studies/drawn_signature.hpp"

namespace deltadyn::blind {

constexpr int kFirstReport = 10'000;

inline const std::vector<std::string>& drawn_parts() {
  static const std::vector<std::string> parts = {"any-effects", "any-clean",     "any-pairs",
                                                 "any-outside", "dirty-effects", "dirty-clean"};
  return parts;
}

inline bool is_drawn(const std::string& part) {
  const auto& parts = drawn_parts();
  return std::find(parts.begin(), parts.end(), part) != parts.end();
}

/// Every effect meets every type: the numbers of both have no common divisor, and types of four limbs come twice, with
/// arms and on rails.
inline std::string drawn_type(int index) {
  const char* types[] = {"delta4", "delta3", "axis", "linear-delta3", "h4", "delta4", "i4",
                         "par4",   "delta3", "h4",   "par4"};
  return types[index % 11];
}

inline void draw_paths(DrawnCase& c, int harmonics, Random& random) {
  Machine& m = c.machine;
  const double u = between(random, 0, 1), hurry = between(random, 0.8, 1.4);
  c.motion = u < 0.5 ? MotionKind::fourier : u < 0.75 ? MotionKind::pick : MotionKind::mixed;
  const double cycle = hurry * (m.plate() ? 1.0 : 0.9) * std::sqrt(m.length);
  const double size = std::pow(0.35, 0.3);
  const auto seed = [&] { return random(); };
  std::vector<PathOptions> options = {{1, 0.3 * hurry, 1, harmonics, 0, seed()},
                                      {1, 0.1 * hurry, size, harmonics, 0, seed()},
                                      {1, 0.2 * hurry, 1, harmonics, 0, seed()}};
  const double cycles[] = {cycle, 2.5 * cycle, 1.4 * cycle};
  for (std::size_t l = 0; l < 3; ++l) {
    if (c.motion == MotionKind::pick || (c.motion == MotionKind::mixed && l == 2)) options[l].cycle_s = cycles[l];
    for (PathOptions& o = options[l]; !in_reach(m, path_of(m, o), c.duration_s) && o.share > 0.1;) o.share *= 0.85;
    c.paths.push_back(path_of(m, options[l]));
  }
}

/// Encoders of 15 to 19 bits in dirty machines, of 17 to 20 in clean ones; of carriages in steps of micrometres.
inline void draw_sensors(DrawnCase& c, bool dirty, Random& random) {
  const double rates[] = {500, 1000, 1000, 2000, 4000};
  c.rate_hz = rates[static_cast<std::size_t>(between(random, 0, 4.999))];
  c.noise.torque_share = between(random, 0.003, 0.009);
  const double correlations[] = {0.0, 0.0, 0.9};
  c.noise.correlation = dirty ? 0.0 : correlations[static_cast<std::size_t>(between(random, 0, 2.999))];
  c.noise.encoder_rad = 2e-6;
  const double bits = std::floor(dirty ? between(random, 15, 19.99) : between(random, 17, 20.99));
  for (int j = 0; j < c.machine.robot.drives(); ++j)
    c.encoder_step.push_back((c.machine.turns(j) ? 2 * kPi : 0.5) * std::pow(2.0, -bits));
}

/// The names that are to be hidden, before it is known which of them can act.
inline std::vector<std::string> drawn_names(const std::string& part, int index, Random& random) {
  const auto& names = hidden_names();
  const auto count = names.size();
  const double u = between(random, 0, 1), v = between(random, 0, 1);
  if (part == "any-effects" || part == "dirty-effects") return {names[static_cast<std::size_t>(index) % count]};
  if (part != "any-pairs") return {};
  const auto a = static_cast<std::size_t>(u * static_cast<double>(count)) % count;
  const auto b = (a + 1 + static_cast<std::size_t>(v * static_cast<double>(count - 1)) % (count - 1)) % count;
  return {names[a], names[b]};
}

/// Adds the effect in a size that stands out. \returns false if it has none
inline bool hide(DrawnCase& c, const Signature& signature, const std::string& name, double wanted, Random random) {
  const int drives = c.machine.robot.drives();
  Site site{c.machine, static_cast<int>(between(random, 0, drives - 0.001)),
            static_cast<int>(between(random, 0, c.machine.limbs() - 0.001)), between(random, 0, 1)};
  const bool dirty = c.machine.dirt.any();
  const Eigen::VectorXd beside = dirty ? signature.dirt() : Eigen::VectorXd(c.noise.torque_share * signature.largest());
  double strength = 0;
  Hidden hidden;
  for (int pass = 0; pass < 4; ++pass) {
    hidden = make_drawn(name, site, random);
    strength = signature.effects({hidden}).cwiseQuotient(beside).maxCoeff();
    if (strength >= 0.95 * wanted || !(strength > 0)) break;
    site.gain *= wanted / strength;
  }
  c.hidden.push_back(hidden);
  c.strength = c.hidden.size() == 1 ? strength : std::min(c.strength, strength);
  return strength >= 0.7 * wanted;
}

/// Hides the effects; one that cannot act here, or not enough, gives its place to the next one of the list.
inline void hide_all(DrawnCase& c, const std::vector<std::string>& names, Random& random) {
  if (names.empty()) return;
  const Signature signature(c);
  const auto& all = hidden_names();
  const double wanted =
      c.machine.dirt.any() ? 3 * std::exp(between(random, 0, std::log(2.5))) : (names.size() > 1 ? 1.2 : 0.6);
  for (const std::string& name : names) {
    auto at = static_cast<std::size_t>(std::find(all.begin(), all.end(), name) - all.begin());
    const Random own(random());
    bool done = false;
    for (std::size_t tried = 0; tried < all.size() && !done; ++tried, at = (at + 1) % all.size()) {
      const bool there =
          std::any_of(c.hidden.begin(), c.hidden.end(), [&](const Hidden& one) { return one.truth == all[at]; });
      const bool spring_late = all[at] == "joint_elasticity" && name != all[at];  // its path was not drawn to shake
      if (there || spring_late || !can_act(all[at], c.machine)) continue;
      const std::size_t before = c.hidden.size();
      const double strength = c.strength;
      done = hide(c, signature, all[at], wanted, own);
      if (!done) {
        c.hidden.resize(before);
        c.strength = strength;
      }
    }
    c.strong = c.strong && done;
  }
}

inline DrawnCase make_drawn_case(const std::string& part, int index) {
  const auto& parts = drawn_parts();
  const auto which = static_cast<std::uint64_t>(std::find(parts.begin(), parts.end(), part) - parts.begin());
  Random random(1'000'003u * static_cast<std::uint64_t>(index + 1) + 77u + which);
  DrawnCase c;
  c.type = drawn_type(index);
  c.seed = random();
  const bool dirty = part.rfind("dirty", 0) == 0;
  const std::vector<std::string> names = drawn_names(part, index, random);
  const bool shaken = std::find(names.begin(), names.end(), "joint_elasticity") != names.end();
  c.machine = draw_machine(c.type, random);
  draw_paths(c, shaken ? 10 : 5, random);
  measure_scales(c.machine, c.paths[0], c.duration_s);
  draw_friction(c.machine, random);
  draw_sensors(c, dirty, random);
  if (dirty) draw_dirt(c.machine, random);
  hide_all(c, names, random);
  if (part == "any-outside") {
    const Site site{c.machine, 0, static_cast<int>(between(random, 0, c.machine.limbs() - 0.001)),
                    between(random, 0, 1)};
    c.hidden.push_back(make_drawn_outside(index / 5, site, random));
    const Eigen::VectorXd noise = c.noise.torque_share * Signature(c).largest();
    c.strength = Signature(c).effects(c.hidden).cwiseQuotient(noise).maxCoeff();
  }
  return c;
}

/// Encoders, and the recorded torque's noise and steps.
inline void add_sensors(const DrawnCase& c, int l, Log& log) {
  Random random(c.seed + static_cast<std::uint64_t>(l) * 7919u);
  NormalDistribution normal;
  const Dirt& dirt = c.machine.dirt;
  const Eigen::VectorXd largest = log.tau.cwiseAbs().colwise().maxCoeff().transpose();
  for (const Hidden& one : c.hidden) {
    if (one.record) one.record(l, log.tau, log.q, 1 / c.rate_hz);
  }
  for (int j = 0; j < c.machine.robot.drives(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    const double sigma = c.noise.torque_share * largest(j), rho = c.noise.correlation;
    const double white = c.noise.encoder_rad * (c.machine.yaws(j) ? 10.0 : c.machine.turns(j) ? 1.0 : 0.3);
    const double step = c.encoder_step[at], phase = between(random, 0, 1);
    double e = sigma * normal(random);
    for (Eigen::Index k = 0; k < log.samples(); ++k) {
      e = rho * e + sigma * std::sqrt(1 - rho * rho) * normal(random);
      log.tau(k, j) += e;
      if (dirt.any()) log.tau(k, j) = dirt.torque_quantum[at] * std::round(log.tau(k, j) / dirt.torque_quantum[at]);
      log.q(k, j) = step * (std::round((log.q(k, j) + white * normal(random)) / step + phase) - phase);
    }
  }
}

/// Three logs: fast, slow, held out; fewer if the plant left its workspace.
inline std::vector<Log> record_drawn(const DrawnCase& c) {
  std::vector<Log> logs;
  for (int l = 0; l < 3; ++l) {
    Log log;
    log.file = l == 0 ? "fast" : (l == 1 ? "slow" : "holdout");
    if (!DrawnRun(c, l).record(log)) break;
    add_sensors(c, l, log);
    logs.push_back(std::move(log));
  }
  return logs;
}

}  // namespace deltadyn::blind
