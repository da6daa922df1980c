#pragma once

/// \file
/// Everything that resists the motion of one joint in the plant: viscous and Coulomb friction and the effects that act there.
/// The formulas are those of effects/; here they are put together so that rest, sliding either way and load fit.

#include <memory>
#include <vector>

#include "deltadyn/effects/hysteresis.hpp"
#include "deltadyn/runtime/effect_catalogue.hpp"

namespace deltadyn {

/// State of one joint as its friction sees it.
struct JointMotion {
  double rate = 0;       ///< [rad/s | m/s]
  int direction = 1;     ///< sign of the sliding, +1 or -1; decides at rate 0
  double position = 0;   ///< [rad | m]
  double time = 0;       ///< since the start of the log [s]
  double bristle = 0;    ///< state of `presliding`, in [-1, 1]
  double loop = 0;       ///< state of `hysteresis`, in [-1, 1]
  double side_load = 0;  ///< of the telescope's guide, per unit mass [m/s^2]
};

class FrictionLaw {
 public:
  FrictionLaw(double viscous, double coulomb) : viscous_(viscous), coulomb_(coulomb) {}

  /// True if the effect is one of those that act inside a joint.
  [[nodiscard]] static bool takes(EffectId id);
  /// Throws Error(usage) if the friction would push at rest (a friction that is taken away must be there in the first place), or
  /// if a second effect with the same state is added.
  void add(const Effect& effect);

  /// What reaches the mechanism of the drive's torque tau (0 for a passive joint), friction taken off [N m | N].
  [[nodiscard]] double transmitted(double tau, const JointMotion& motion) const;
  /// The torque that brings `load` to the mechanism: inverse of transmitted().
  [[nodiscard]] double required(double load, const JointMotion& motion) const;

  /// True if the resistance jumps with the sign of the rate, or has a memory that needs to know reversals.
  [[nodiscard]] bool minds_reversals() const { return jumps_ || bristle_ > 0; }
  [[nodiscard]] bool has_loop() const { return loop_ != nullptr; }
  [[nodiscard]] bool has_side_load() const { return side_load_; }
  [[nodiscard]] double bristle_displacement() const { return bristle_displacement_; }  ///< [rad | m]; 0 without `presliding`
  [[nodiscard]] HysteresisShape<double> loop_shape() const;                            ///< of `hysteresis`
  /// Rate of the state of `hysteresis` [1/s]; 0 without it.
  [[nodiscard]] double loop_rate(double rate, double state) const;

 private:
  [[nodiscard]] double resistance(const JointMotion& motion) const;
  [[nodiscard]] double effect_force(const Effect& effect, double rate, const JointMotion& motion) const;

  double viscous_, coulomb_;
  double bristle_ = 0, bristle_displacement_ = 0, bristle_damping_ = 0;
  double driving_ = 0, back_driving_ = 0;  ///< shares of the load
  bool jumps_ = coulomb_ != 0, side_load_ = false;
  std::vector<Effect> effects_;
  std::shared_ptr<const Effect> loop_;
};

}  // namespace deltadyn
