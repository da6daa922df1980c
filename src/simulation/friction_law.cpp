#include "deltadyn/simulation/friction_law.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "deltadyn/runtime/changed_machine.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

/// What the laws see. The rate is never of the other sign: within one integration step a joint slides in one direction.
JointInput<double> input_of(const JointMotion& motion, double load) {
  constexpr double kLeast = std::numeric_limits<double>::min();
  JointInput<double> in;
  in.position = motion.position;
  in.rate = motion.direction * std::max(motion.direction * motion.rate, kLeast);
  in.sign = motion.direction;
  in.time = motion.time;
  in.load = load;
  in.side_load = motion.side_load;
  return in;
}

template <class E>
constexpr bool kIsLaw = (kIs<E, JointLaw> || kIs<E, JointMemory>)&&!HasChange<E, ChangedMachine>::value;

}  // namespace

bool FrictionLaw::takes(EffectId id) {
  bool takes = false;
  visit_effect(id, [&takes](auto effect) { takes = kIsLaw<decltype(effect)>; });
  return takes;
}

void FrictionLaw::add(const Effect& effect, double count) {
  const EffectKind& kind = effect_kind(effect.id);
  const std::string where = fmt::format("{}@{}", kind.name, effect_joint_name(effect.id, effect.joint));
  Term term{effect.id, shape_of(effect), amplitudes_of(effect), kMostMemories};
  for (double& amplitude : term.amplitude) amplitude *= count;
  if (kind.memory) {
    const bool twice = std::ranges::find(terms_, effect.id, &Term::id) != terms_.end();
    if (twice || memories_ == kMostMemories)
      throw Error(fmt::format("{} is given twice for one joint", kind.name), where, "give it once", ExitCode::usage);
    term.memory = memories_++;
  }
  terms_.push_back(term);
  look_at_rest(where);
}

void FrictionLaw::look_at_rest(const std::string& where) {
  const auto differs = [](double one, double other) {
    return std::abs(one - other) > 1e-12 * (std::abs(one) + std::abs(other));
  };
  JointMotion up, down;
  down.direction = -1;
  const double plain = resistance(up, 0);
  load_ = differs(resistance(up, 1), plain) || differs(resistance(up, -1), plain);
  JointMotion loaded = up;
  loaded.side_load = 1;
  side_load_ = differs(resistance(loaded, 0), plain);
  jumps_ = coulomb_ != 0 || load_ || side_load_;
  const double back_driving = lost_share(up, -1);
  if (!(back_driving < 1)) {
    throw Error(fmt::format("a gear that loses {} of the load cannot be driven back at all", back_driving), where,
                "give a share below 1", ExitCode::usage);
  }
  // At rest friction must resist both ways, at every position.
  const double size = terms_.empty() ? 0.0 : std::abs(terms_.back().amplitude[0]);
  for (int k = 0; k < 64; ++k) {
    up.position = down.position = 0.1 * k;
    const double hold = resistance(up, 0) - resistance(down, 0);
    jumps_ = jumps_ || hold > 1e-9 * (coulomb_ + size);
    if (hold < -1e-9 * (coulomb_ + size)) {
      throw Error(
          fmt::format("with {} N m (N) the friction at rest would push instead of hold", terms_.back().amplitude[0]),
          where, fmt::format("the joint's Coulomb friction is {}; give the effect a smaller amplitude", coulomb_),
          ExitCode::usage);
    }
  }
}

double FrictionLaw::force(const Term& term, const JointInput<double>& in, const LawMemories& memory) {
  double sum = 0;
  visit_effect(term.id, [&](auto effect) {
    using E = decltype(effect);
    if constexpr (kIsLaw<E>) {
      ColumnsOf<double, E> columns;
      if constexpr (kIs<E, JointMemory>) {
        columns = E::columns(memory[term.memory], in, term.shape);
      } else {
        columns = E::columns(in, term.shape);
      }
      for (std::size_t c = 0; c < columns.size(); ++c) sum += term.amplitude[c] * columns[c];
    }
  });
  return sum;
}

double FrictionLaw::resistance(const JointMotion& motion, double load) const {
  const JointInput<double> in = input_of(motion, load);
  double sum = viscous_ * in.rate + coulomb_ * in.sign + offset_;
  for (const Term& term : terms_) sum += force(term, in, motion.memory);
  return sum;
}

double FrictionLaw::lost_share(const JointMotion& motion, int along) const {
  return motion.direction * (resistance(motion, along * motion.direction) - resistance(motion, 0));
}

double FrictionLaw::transmitted(double tau, const JointMotion& motion) const {
  const double rest = tau - resistance(motion, 0);
  if (!load_ || motion.direction == 0) return rest;
  // The load has the sign of the rest, since the laws of the load are homogeneous in it and no share reaches 1 against
  // it.
  return rest * motion.direction > 0 ? rest / (1 + lost_share(motion, 1)) : rest / (1 - lost_share(motion, -1));
}

LawMemories FrictionLaw::start(int direction) const {
  LawMemories memory{};
  for (const Term& term : terms_) {
    visit_effect(term.id, [&](auto effect) {
      using E = decltype(effect);
      if constexpr (kIs<E, JointMemory>) memory[term.memory] = E::start(static_cast<double>(direction), term.shape);
    });
  }
  return memory;
}

LawMemories FrictionLaw::moved(const LawMemories& memory, double way) const {
  LawMemories out = memory;
  for (const Term& term : terms_) {
    visit_effect(term.id, [&](auto effect) {
      using E = decltype(effect);
      if constexpr (kIs<E, JointMemory>) {
        out[term.memory] = E::moved(memory[term.memory], way, JointInput<double>(), term.shape);
      }
    });
  }
  return out;
}

}  // namespace deltadyn
