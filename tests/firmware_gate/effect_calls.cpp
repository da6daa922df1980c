// Calls what a controller with effects may want, for one scalar (GATE_SCALAR) and every robot.

#include "effect_calls.hpp"

#include <cstdint>
#include <limits>

#include "deltadyn/firmware/effect_feed_forward.hpp"

#include "plausible_geometry.hpp"

namespace deltadyn::firmware_gate {
namespace {

/// The same numbers everywhere, without the standard library's generators, which bring streams.
template <class T>
class Numbers {
 public:
  T uniform(T lower, T upper) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return lower + (upper - lower) * static_cast<T>(state_ >> 40U) / T(16777216);
  }
  template <int N>
  Vector<T, N> vector(T half) {
    Vector<T, N> v;
    for (int i = 0; i < N; ++i) v(i) = uniform(-half, half);
    return v;
  }

 private:
  std::uint64_t state_ = 1;
};

/// First start values of the shapes, as constants.
template <class E>
constexpr Shape<double> first_shape() {
  const EffectTraits traits = E::traits();
  Shape<double> shape{};
  for (std::size_t k = 0; k < traits.shapes.size(); ++k)
    shape[k] = traits.shapes[k].count > 0 ? traits.shapes[k].start[0] : 1.0;
  return shape;
}

template <class Controller, class Robot, class... Effects>
int add_all(EffectList<Effects...>, Controller& control) {
  int added = 0;
  const auto add = [&](auto effect) {
    using E = decltype(effect);
    constexpr Shape<double> shape = first_shape<E>();
    for (int joint = -1; joint < Robot::kDrives; ++joint) {
      EffectRow row;
      row.id = effect_id<E>;
      row.joint = joint;
      row.shape = shape;
      row.amplitude.fill(kIs<E, MachineChange> ? 1e-3 : 0.1);
      added += control.add(row) == EffectRefusal::none ? 1 : 0;
    }
  };
  (add(Effects()), ...);
  return added;
}

template <class T, class Robot>
EffectOutcome run(long set_points) {
  constexpr int N = Robot::kDrives;
  using Drives = Vector<T, N>;
  using Controller = EffectFeedForward<T, Robot, Limbs::shared, 100>;
  typename Controller::Parameters p = Controller::Parameters::Constant(T(0.2));
  Controller control(plausible_geometry<T, Robot>(), p);
  EffectOutcome outcome;
  outcome.effects = add_all<Controller, Robot>(AllEffects(), control);
  Numbers<T> random;
  Drives q = Drives::Zero(), qd = Drives::Zero(), tau = Drives::Zero();
  outcome.settings = control.set_payload(T(0.5), Vector3<T>(T(0), T(0), T(-0.1))) == Status::ok &&
                     control.set_friction(0, T(1), T(2)) == Status::ok &&
                     control.set_reversal_width(0, T(0.01)) == Status::ok && control.reset(q, qd) == Status::ok;
  for (long k = 0; k < set_points; ++k) {
    outcome.settings = outcome.settings && control.set_time(T(0.001) * static_cast<T>(k)) == Status::ok;
    Drives z = random.template vector<N>(T(0.5));
    if (kHasPlate<Robot>) z(2) -= T(0.8);
    Drives zd = random.template vector<N>(k % 3 == 0 ? T(0) : T(5));
    const Drives zdd = random.template vector<N>(T(100));
    if (k % 101 == 0) (k % 2 == 0 ? z : zd)(0) = std::numeric_limits<T>::quiet_NaN();
    const Drives before = tau;
    const Status status = k % 2 == 0 ? control.from_task(z, zd, zdd, q, qd, tau) : control.from_drives(z, zd, zdd, tau);
    ++(status == Status::ok ? outcome.ok : outcome.refused);
    if (!tau.allFinite() || (status != Status::ok && tau != before)) ++outcome.wrong;
    const double torque = static_cast<double>(tau.template lpNorm<Eigen::Infinity>());
    if (torque > outcome.largest_torque) outcome.largest_torque = torque;
  }
  return outcome;
}

template <class T>
EffectOutcome run_robot(int robot, long set_points) {
  switch (robot) {
    case 0: return run<T, Delta3>(set_points);
    case 1: return run<T, LinearDelta3>(set_points);
    case 2: return run<T, Delta4>(set_points);
    case 3: return run<T, Axis>(set_points);
    case 4: return run<T, LinearAxis>(set_points);
    case 5: return run<T, Par4>(set_points);
    default: return EffectOutcome();
  }
}

}  // namespace

#define GATE_JOIN_(a, b) a##b
#define GATE_JOIN(a, b) GATE_JOIN_(a, b)
EffectOutcome GATE_JOIN(run_effects_, GATE_SCALAR)(int robot, long set_points) {
  return run_robot<GATE_SCALAR>(robot, set_points);
}

}  // namespace deltadyn::firmware_gate
