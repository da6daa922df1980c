#pragma once

/// \file
/// A random robot in the core's form and in the library's, a random motion of it, and what the fit says of effects
/// along that motion.

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <vector>

#include "deltadyn/firmware/effect_feed_forward.hpp"
#include "deltadyn/identification/effect_columns.hpp"
#include "deltadyn/runtime/changed_machine.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "support/random_robot.hpp"

namespace deltadyn::testing_support {

template <class R>
RobotDescription description_of(const Geometry<double, R>& geometry) {
  RobotDescription robot;
  robot.name = robot.type = R::kName;
  robot.drive_kind = R::kDrive;
  robot.limbs.assign(geometry.limbs, geometry.limbs + R::kLimbs);
  robot.parts.assign(geometry.parts, geometry.parts + R::kPlateParts);
  if (R::kTelescope) robot.telescope = geometry.telescope;
  robot.gravity = geometry.gravity;
  robot.limits.resize(R::kDrives);
  return robot;
}

/// A random robot within the rules of robot files: elbows on the arm's x axis, gravity of this planet in any direction
/// near -z.
template <class R>
Geometry<double, R> plausible_geometry(Random& random) {
  Geometry<double, R> geometry = random_geometry<R>(random);
  if (R::kDrive == DriveKind::revolute) {
    for (LimbGeometry<double>& limb : geometry.limbs) limb.p_DE_0 = Vector3<double>(limb.p_DE_0.x(), 0, 0);
  }
  geometry.gravity *= 9.81 / geometry.gravity.norm();
  return geometry;
}

/// Numbers that float holds exactly, so that both precisions are asked for the same motion.
template <class Derived>
typename Derived::PlainObject as_float_holds_it(const Eigen::MatrixBase<Derived>& values) {
  return values.template cast<float>().template cast<double>();
}

template <class R>
class EffectBench {
 public:
  static constexpr int kSamples = 60;
  static constexpr int N = R::kDrives;
  using Drives = Vector<double, N>;
  using Layout = ParameterLayout<R, Limbs::individual>;
  template <class T, int kCapacity = 1>
  using Control = EffectFeedForward<T, R, Limbs::individual, kCapacity>;

  explicit EffectBench(std::uint64_t seed)
      : random(seed), geometry(plausible_geometry<R>(random)), p(random_parameters<Layout>(random)) {
    ParameterOptions options;
    options.individual_limbs = options.offset = true;
    for (int drive = 1; drive <= N; ++drive) options.rotor_inertia.push_back(drive);
    robot = make_robot(description_of(geometry), options);
    p = as_float_holds_it(p);
    draw_motion();
    model = std::make_unique<EffectModel>(*robot);
    signals = model->signals(log, p);
  }

  /// Largest torque of the motion [N m | N].
  [[nodiscard]] double size() const { return signals.torque.cwiseAbs().maxCoeff(); }

  /// Every effect of the list that can act here, at all its places, with a few shapes drawn from the start values of
  /// its traits.
  [[nodiscard]] std::vector<Effect> acting_effects() {
    std::vector<Effect> all;
    for (const EffectKind& kind : effect_catalogue()) {
      for (const int joint : effect_joints(kind.id, robot->description())) {
        for (int draw = 0; draw < 3; ++draw) {
          const Effect effect = draw_effect(kind, joint);
          if (refusal_of(effect.id, shape_of(effect)) == EffectRefusal::none) all.push_back(effect);
        }
      }
    }
    return all;
  }

  [[nodiscard]] static EffectRow row_of(const Effect& effect) {
    return {effect.id, effect.joint, shape_of(effect), deltadyn::amplitudes_of(effect)};
  }

  /// Torque with the effect as the library has it, samples x drives: columns of the fit, or the changed robot itself.
  [[nodiscard]] Eigen::MatrixXd expected(const Effect& effect) const {
    if (changes_machine(effect.id)) return expected_of_machine(effect);
    return signals.torque + by_columns(effect);
  }
  [[nodiscard]] Eigen::MatrixXd by_columns(const Effect& effect) const {
    Eigen::MatrixXd torque = Eigen::MatrixXd::Zero(kSamples, N);
    const auto columns = model->columns(signals, effect.id, effect.joint, effect.shape, 1);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double amplitude = effect.amplitude(static_cast<Eigen::Index>(c));
      if (columns[c].drive < 0) {
        torque += amplitude * columns[c].values;
      } else {
        torque.col(columns[c].drive) += amplitude * columns[c].values;
      }
    }
    return torque;
  }

  /// Torque along the motion from a controller, samples x drives.
  template <class T, class Controller>
  [[nodiscard]] Eigen::MatrixXd run(Controller& control) const {
    Eigen::MatrixXd torque(kSamples, N);
    for (int k = 0; k < kSamples; ++k) {
      const auto row = [k](const Eigen::MatrixXd& of) {
        return Vector<T, N>(of.row(k).transpose().template cast<T>());
      };
      Vector<T, N> tau;
      EXPECT_EQ(control.set_time(static_cast<T>(log.t_s(k))), Status::ok);
      EXPECT_EQ(control.from_drives(row(log.q), row(log.qd), row(log.qdd), tau), Status::ok) << "sample " << k;
      torque.row(k) = tau.template cast<double>().transpose();
    }
    return torque;
  }

  template <class T, int kCapacity = 1>
  [[nodiscard]] Control<T, kCapacity> control() const {
    return Control<T, kCapacity>(cast_geometry<T>(geometry), p.template cast<T>());
  }

  static bool changes_machine(EffectId id) {
    bool changes = false;
    visit_effect(id, [&changes](auto effect) { changes = kIs<decltype(effect), MachineChange>; });
    return changes;
  }

  Random random;
  Geometry<double, R> geometry;
  Vector<double, Layout::kColumns> p;
  std::unique_ptr<Robot> robot;
  PreparedLog log;
  std::unique_ptr<EffectModel> model;
  EffectSignals signals;

 private:
  /// Jumps from place to place, and small steps with reversals between.
  void draw_motion() {
    log.rate_hz = 1000;
    log.t_s.resize(kSamples);
    for (Eigen::MatrixXd* of : {&log.q, &log.qd, &log.qdd}) of->resize(kSamples, N);
    RandomTask<R> task;
    for (int k = 0; k < kSamples; ++k) {
      const RandomTask<R> next = random_task<R>(random);
      task.z = k % 10 == 0 ? next.z : Drives(task.z + 0.002 * next.zd);
      task.zd = next.zd;
      task.zdd = next.zdd;
      Motion<double, R> motion;
      ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, motion), Status::ok);
      log.t_s(k) = 0.125 * k;
      log.q.row(k) = as_float_holds_it(motion.posture.q).transpose();
      log.qd.row(k) = as_float_holds_it(motion.qd).transpose();
      log.qdd.row(k) = as_float_holds_it(motion.qdd).transpose();
    }
  }

  [[nodiscard]] Effect draw_effect(const EffectKind& kind, int joint) {
    Effect effect;
    effect.id = kind.id;
    effect.joint = joint;
    effect.shape.resize(static_cast<Eigen::Index>(kind.shapes.size()));
    effect.amplitude.resize(static_cast<Eigen::Index>(kind.amplitudes.size()));
    for (Eigen::Index k = 0; k < effect.shape.size(); ++k) {
      const std::vector<double> start = start_values(kind.shapes[static_cast<std::size_t>(k)]);
      const auto count = static_cast<double>(start.size());
      const double value = start.empty() ? 1.0 : start[static_cast<std::size_t>(random.uniform(0, count))];
      effect.shape(k) = static_cast<double>(static_cast<float>(value));
    }
    for (Eigen::Index k = 0; k < effect.amplitude.size(); ++k) {
      const AmplitudeTraits& one = kind.amplitudes[static_cast<std::size_t>(k)];
      const double most = changes_machine(kind.id) ? 1e-3 : std::min(1.0, one.largest);
      const double value = most * random.uniform(one.positive() ? 0.1 : -1.0, 1.0);
      effect.amplitude(k) = static_cast<double>(static_cast<float>(value));
    }
    return effect;
  }

  [[nodiscard]] Eigen::MatrixXd expected_of_machine(const Effect& effect) const {
    ChangedMachine machine(robot->description());
    visit_effect(effect.id, [&](auto type) {
      using E = decltype(type);
      if constexpr (kIs<E, MachineChange>)
        E::change(machine, effect.joint, deltadyn::amplitudes_of(effect), shape_of(effect));
    });
    const auto changed = make_robot(machine.description, robot->parameter_options());
    Eigen::MatrixXd torque(kSamples, N);
    for (int k = 0; k < kSamples; ++k) {
      Eigen::VectorXd tau(N);
      const Eigen::VectorXd q = log.q.row(k), qd = log.qd.row(k), qdd = log.qdd.row(k);
      EXPECT_EQ(changed->inverse_dynamics(q + machine.home_offset, qd, qdd, p, tau), Status::ok);
      torque.row(k) = tau.transpose();
    }
    return torque;
  }
};

}  // namespace deltadyn::testing_support
