#pragma once

/// \file
/// Everything that resists the motion of one joint in the plant: viscous and Coulomb friction and the laws of effects
/// that act there, put together so that rest, sliding either way and load fit.

#include <array>
#include <vector>

#include "deltadyn/runtime/effect_catalogue.hpp"

namespace deltadyn {

/// Memories of the laws at one joint, in the order in which they were added.
inline constexpr std::size_t kMostMemories = 4;
using LawMemories = std::array<double, kMostMemories>;

/// State of one joint as its friction sees it.
struct JointMotion {
  double rate = 0;       ///< [rad/s | m/s]
  int direction = 1;     ///< sign of the sliding, +1 or -1, which decides at rate 0; 0: no Coulomb friction
  double position = 0;   ///< [rad | m]
  double time = 0;       ///< since the start of the log [s]
  double side_load = 0;  ///< of the telescope's guide, per unit mass [m/s^2]
  LawMemories memory = {};
};

class FrictionLaw {
 public:
  FrictionLaw(double viscous, double coulomb, double offset = 0)
      : viscous_(viscous), coulomb_(coulomb), offset_(offset) {}

  /// True if the effect is one of those that act inside a joint by their law.
  [[nodiscard]] static bool takes(EffectId id);
  /// \param count  joints alike that this one stands for
  /// Throws Error(usage) if the friction would push at rest (a friction that is taken away must be there in the first
  /// place), or if a second effect of a kind with memory is added.
  void add(const Effect& effect, double count = 1);

  /// What reaches the mechanism of the drive's torque tau (0 for a passive joint), friction taken off [N m | N].
  [[nodiscard]] double transmitted(double tau, const JointMotion& motion) const;
  /// The torque that brings `load` to the mechanism: inverse of transmitted().
  [[nodiscard]] double required(double load, const JointMotion& motion) const {
    return load + resistance(motion, load);
  }

  /// True if the resistance jumps with the sign of the rate, or has a memory that needs to know reversals.
  [[nodiscard]] bool minds_reversals() const { return jumps_ || memories_ > 0; }
  [[nodiscard]] bool has_memory() const { return memories_ > 0; }
  [[nodiscard]] bool has_side_load() const { return side_load_; }
  /// Memories of a joint that has long slid in a direction (0: at rest, unloaded).
  [[nodiscard]] LawMemories start(int direction) const;
  /// Memories after a further way [rad | m].
  [[nodiscard]] LawMemories moved(const LawMemories& memory, double way) const;

 private:
  struct Term {
    EffectId id;
    Shape<double> shape;
    std::array<double, kMostAmplitudes> amplitude;
    std::size_t memory;  ///< its place among the memories; kMostMemories: has none
  };
  [[nodiscard]] double resistance(const JointMotion& motion, double load) const;
  [[nodiscard]] static double force(const Term& term, const JointInput<double>& in, const LawMemories& memory);
  /// Torque per unit of load that is lost, for a load along (+1) and against (-1) the motion.
  [[nodiscard]] double lost_share(const JointMotion& motion, int along) const;
  void look_at_rest(const std::string& where);

  double viscous_, coulomb_, offset_;
  bool jumps_ = coulomb_ != 0, side_load_ = false, load_ = false;
  std::size_t memories_ = 0;
  std::vector<Term> terms_;
};

}  // namespace deltadyn
