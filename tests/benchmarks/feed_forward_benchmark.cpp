/// \file
/// Time of a controller's call for one set point of a delta4, rigid and with seven effects, in float and double: the
/// mean over random set points, and beside it the worst set point.

#include <algorithm>
#include <array>
#include <benchmark/benchmark.h>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include "deltadyn/effects/some_effects.hpp"
#include "deltadyn/firmware/effect_feed_forward.hpp"
#include "deltadyn/firmware/feed_forward.hpp"

#include "firmware_gate/plausible_geometry.hpp"

namespace {

using namespace deltadyn;

constexpr EffectRow kRows[] = {{effect_named("stribeck"), 1, {0.25, 2}, {2}},
                               {effect_named("shear_thinning"), 3, {2.5, 0}, {0.4}},
                               {effect_named("asymmetric_viscous"), 0, {}, {0.7}},
                               {effect_named("presliding"), 2, {0.01, 0}, {1.5}},
                               {effect_named("torque_ripple"), 3, {20}, {0.1, 0.05}},
                               {effect_named("telescope_side_load"), -1, {}, {0.2}},
                               {effect_named("hose_force"), -1, {}, {3, -2, 1, 25, 18, 8}}};
constexpr int kEffects = sizeof(kRows) / sizeof(kRows[0]);

template <class T>
using Drives = Vector<T, 4>;
template <class T>
using Rigid = FeedForward<T, Delta4>;
template <class T>
using WithEffects = EffectFeedForward<T, Delta4, Limbs::shared, kEffects>;

template <class T>
struct SetPoint {
  Drives<T> q, qd, qdd;
};

template <class T>
std::array<SetPoint<T>, 256> random_set_points() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::array<SetPoint<T>, 256> points;
  const auto draw = [&](double size) { return static_cast<T>(size * uniform(random)); };
  for (SetPoint<T>& point : points) {
    for (int i = 0; i < 4; ++i) {
      point.q(i) = draw(i < 3 ? 0.3 : 2);
      point.qd(i) = draw(10);
      point.qdd(i) = draw(100);
    }
  }
  return points;
}

template <class T, class Controller>
void call(Controller& control, const SetPoint<T>& point) {
  Drives<T> tau;
  Status status = control.from_drives(point.q, point.qd, point.qdd, tau);
  benchmark::DoNotOptimize(status);
  benchmark::DoNotOptimize(tau);
}

/// Of each set point the best of some rounds, so that what else the machine does does not count; of these the worst
/// [us].
template <class T, class Controller>
double worst_set_point(Controller& control, const std::array<SetPoint<T>, 256>& points) {
  constexpr int kRounds = 30, kCalls = 20;
  double worst = 0;
  for (const SetPoint<T>& point : points) {
    double best = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kRounds; ++round) {
      const auto start = std::chrono::steady_clock::now();
      for (int k = 0; k < kCalls; ++k) call(control, point);
      const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
      best = std::min(best, time.count() / kCalls);
    }
    worst = std::max(worst, best);
  }
  return worst;
}

template <class T, class Controller>
void run(benchmark::State& state, Controller control) {
  const auto points = random_set_points<T>();
  std::size_t k = 0;
  for (auto _ : state) call(control, points[k++ % points.size()]);
  state.counters["worst_us"] = worst_set_point(control, points);
}

template <class T>
const typename Rigid<T>::Parameters kParameters = Rigid<T>::Parameters::Constant(T(0.1));

template <class T>
void rigid(benchmark::State& state) {
  run<T>(state, Rigid<T>(firmware_gate::plausible_geometry<T, Delta4>(), kParameters<T>));
}

template <class T>
void with_effects(benchmark::State& state) {
  WithEffects<T> control(firmware_gate::plausible_geometry<T, Delta4>(), kParameters<T>, kRows);
  if (control.effects() != kEffects) state.SkipWithError("an effect was refused");
  run<T>(state, control);
}

BENCHMARK(rigid<double>)->Unit(benchmark::kMicrosecond);
BENCHMARK(with_effects<double>)->Unit(benchmark::kMicrosecond);
BENCHMARK(rigid<float>)->Unit(benchmark::kMicrosecond);
BENCHMARK(with_effects<float>)->Unit(benchmark::kMicrosecond);

}  // namespace
