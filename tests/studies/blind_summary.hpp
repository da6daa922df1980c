#pragma once

/// \file
/// The figures of a blind study beside what they should be: of the two fixed robots, of robots drawn at random and of
/// dirty machines, all together and type by type, and the cases that went wrong.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "studies/blind_outcome.hpp"
#include "studies/drawn_case.hpp"

namespace deltadyn::blind {

using Selection = std::vector<std::pair<std::string, Outcome>>;

/// Cases of the parts whose names end so: "effects", "clean", ...
inline Selection of_kind(const Selection& cases, const std::string& kind) {
  Selection out;
  for (const auto& one : cases) {
    const std::string part = part_of(one.first);
    const bool ends = part.size() >= kind.size() && part.compare(part.size() - kind.size(), kind.size(), kind) == 0;
    if (ends) out.push_back(one);
  }
  return out;
}

inline bool has_effect(const std::vector<std::string>& list, const std::string& wanted) {
  return std::any_of(list.begin(), list.end(),
                     [&](const std::string& one) { return effect_of(one) == effect_of(wanted); });
}

/// Names that say what is really there in every dirty machine, besides what was hidden.
inline bool is_dirt(const std::string& name) {
  static const std::set<std::string> real = {
      "presliding", "torque_ripple", "kinematic_offset", "limb_inertia_mismatch", "current_lag", "time_skew"};
  return real.count(effect_of(name)) > 0;
}

/// Is everything that is named there?
inline bool only_real(const Outcome& o) {
  const auto truth = split(o.truth), named = split(o.named);
  return std::all_of(named.begin(), named.end(),
                     [&](const std::string& one) { return has_effect(truth, one) || (o.dirty && is_dirt(one)); });
}

/// Names beside the hidden effect: what of a dirty machine is really there is no false one.
inline bool both_and_no_other(const Outcome& o, bool with_sets) {
  const auto truth = split(o.truth), named = split(o.named);
  auto reported = named;
  if (with_sets) {
    const auto set = split(o.set);
    reported.insert(reported.end(), set.begin(), set.end());
  }
  return truth.size() == 2 && named.size() == 2 && has_effect(reported, truth[0]) && has_effect(reported, truth[1]);
}

/// What a case should have come to. \param kind  "effects", "clean", "pairs" or "outside"
inline bool is_right(const std::string& kind, const Outcome& o) {
  if (o.verdict == "not-simulated" || o.verdict == "refused") return false;
  if (kind == "clean")
    return o.dirty ? o.verdict == "nothing-missing" || (!o.named.empty() && only_real(o)) : o.named.empty();
  if (kind == "pairs") return both_and_no_other(o, true);
  if (kind == "outside") return o.named.empty();
  return !o.named.empty() && effect_of(split(o.named).front()) == effect_of(o.truth) &&
         joint_of(split(o.named).front()) == joint_of(o.truth) && only_real(o);
}

inline void print_share(const std::string& what, int good, std::size_t of, const char* aim) {
  if (of == 0) return;
  fmt::print("  {:<62} {:>4} of {:<4} {:>5.1f} %   {}\n", what, good, of, 100.0 * good / static_cast<double>(of), aim);
}

template <class Test>
int count_if(const Selection& cases, Test test) {
  return static_cast<int>(std::count_if(cases.begin(), cases.end(), [&](const auto& one) { return test(one.second); }));
}

/// Of single effects: the sizes, where the catalogue states them as the plant does.
inline void print_sizes(const Selection& named) {
  Selection sized;
  std::copy_if(named.begin(), named.end(), std::back_inserter(sized), [](const auto& c) { return c.second.size > 0; });
  print_share("  sizes: within 5 %",
              count_if(sized, [](const Outcome& o) { return std::abs(o.found_size / o.size - 1) <= 0.05; }),
              sized.size(), "");
  print_share("  sizes: truth inside the 95 % interval",
              count_if(sized, [](const Outcome& o) { return std::abs(o.found_size - o.size) <= 1.96 * o.found_std; }),
              sized.size(), "(93 to 97 %)");
}

inline double middle(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? std::nan("") : values[values.size() / 2];
}

inline void print_spread(const Selection& effects, const Selection& named) {
  std::vector<double> shrink, strength;
  std::size_t in_sets = 0;
  for (const auto& [id, o] : named) {
    in_sets += 1 + split(o.set).size();
    if (std::isfinite(o.gap_shrink)) shrink.push_back(o.gap_shrink);
  }
  for (const auto& [id, o] : effects) {
    if (o.strength > 0) strength.push_back(o.strength);
  }
  if (!shrink.empty()) {
    fmt::print("    mean size of the set {:.2f}; gap shrink: median {:.3f}, smallest {:.3f}   (0.98, -0.05)\n",
               static_cast<double>(in_sets) / static_cast<double>(named.size()), middle(shrink),
               *std::min_element(shrink.begin(), shrink.end()));
  }
  if (!strength.empty()) {
    fmt::print("    strength {:.2g} to {:.2g}, median {:.2g}\n", *std::min_element(strength.begin(), strength.end()),
               *std::max_element(strength.begin(), strength.end()), middle(strength));
  }
}

inline void print_effects(const Selection& effects, bool dirty) {
  Selection named;
  std::copy_if(effects.begin(), effects.end(), std::back_inserter(named),
               [](const auto& c) { return !c.second.named.empty(); });
  const auto first = [](const Outcome& o) { return split(o.named).front(); };
  print_share("effects: something named", static_cast<int>(named.size()), effects.size(), "");
  print_share("  of these: right effect first",
              count_if(named, [&](const Outcome& o) { return effect_of(first(o)) == effect_of(o.truth); }),
              named.size(), dirty ? "(90 %)" : "(95 %)");
  print_share("  of these: right class first",
              count_if(named, [&](const Outcome& o) { return class_of(first(o)) == class_of(o.truth); }), named.size(),
              dirty ? "(95 %)" : "(98 %)");
  print_share("  of these: right joint first",
              count_if(named, [&](const Outcome& o) { return joint_of(first(o)) == joint_of(o.truth); }), named.size(),
              dirty ? "(97 %)" : "(98 %)");
  print_share("  of these: truth first or inside its set",
              count_if(named,
                       [&](const Outcome& o) {
                         auto set = split(o.set);
                         set.push_back(first(o));
                         return has_effect(set, o.truth);
                       }),
              named.size(), "");
  print_share("  of these: every name is really there", count_if(named, only_real), named.size(), "");
  print_sizes(named);
  print_spread(effects, named);
}

/// Figures of one selection.
inline void print_figures(const std::string& title, const Selection& cases) {
  if (cases.empty()) return;
  const bool dirty = cases.front().second.dirty;
  fmt::print("{} ({} cases)\n", title, cases.size());
  const Selection clean = of_kind(cases, "clean"), pairs = of_kind(cases, "pairs"), outside = of_kind(cases, "outside");
  if (dirty) {
    print_share("nothing dominates: nothing missing, or only what is there",
                count_if(clean, [](const Outcome& o) { return is_right("clean", o); }), clean.size(), "");
    print_share("nothing dominates: a name of what is not there",
                count_if(clean, [](const Outcome& o) { return !only_real(o); }), clean.size(), "");
  } else {
    print_share("clean logs: an effect named", count_if(clean, [](const Outcome& o) { return !o.named.empty(); }),
                clean.size(), "(at most 1 %)");
  }
  print_effects(of_kind(cases, "effects"), dirty);
  print_share("pairs: both and no other", count_if(pairs, [](const Outcome& o) { return both_and_no_other(o, false); }),
              pairs.size(), "");
  print_share("pairs: both, each by name or in the reported sets, no other",
              count_if(pairs, [](const Outcome& o) { return both_and_no_other(o, true); }), pairs.size(), "(90 %)");
  print_share("outside the catalogue: no wrong name",
              count_if(outside, [](const Outcome& o) { return o.named.empty(); }), outside.size(), "(95 %)");
  print_share("refused, or not simulated",
              count_if(cases, [](const Outcome& o) { return o.verdict == "refused" || o.verdict == "not-simulated"; }),
              cases.size(), "(none)");
}

inline void print_misses(const Selection& cases) {
  fmt::print("misses: id; truth; verdict; named; set; strength, noise\n");
  for (const auto& [id, o] : cases) {
    for (const char* kind : {"effects", "clean", "pairs", "outside"}) {
      if (of_kind({{id, o}}, kind).empty() || is_right(kind, o)) continue;
      fmt::print("  {}; {}; {}; {}; {}; {:.2g}, {} {} {:g} Hz {}\n", id, o.truth, o.verdict,
                 o.named.empty() ? "-" : o.named, o.set.empty() ? "-" : o.set, o.strength, o.type, o.motion, o.rate_hz,
                 o.noise);
    }
  }
}

/// Figures of all cases that pass a test, then type by type.
inline void print_group(const std::string& title, const Outcomes& all,
                        const std::function<bool(const std::string& id, const Outcome&)>& in) {
  Selection group;
  std::copy_if(all.begin(), all.end(), std::back_inserter(group), [&](const auto& c) { return in(c.first, c.second); });
  print_figures(title, group);
  std::set<std::string> types;
  for (const auto& one : group) types.insert(one.second.type);
  for (const std::string& type : types) {
    Selection own;
    std::copy_if(group.begin(), group.end(), std::back_inserter(own),
                 [&](const auto& c) { return c.second.type == type; });
    if (types.size() > 1) print_figures(title + ", " + type, own);
  }
}

inline void print_summary(const Outcomes& all) {
  fmt::print("Drawn cases: indices below {} are tuning seeds, from there on report seeds.\n", kFirstReport);
  print_group("fixed robots", all, [](const std::string& id, const Outcome&) { return !is_drawn(part_of(id)); });
  for (const bool report : {false, true}) {
    const std::string seeds = report ? "report seeds" : "tuning seeds";
    for (const bool dirty : {false, true}) {
      print_group((dirty ? "dirty machines, " : "robots drawn at random, clean machines, ") + seeds, all,
                  [&](const std::string& id, const Outcome& o) {
                    return is_drawn(part_of(id)) && (index_of_case(id) >= kFirstReport) == report && o.dirty == dirty;
                  });
    }
  }
  print_misses(all);
}

}  // namespace deltadyn::blind
