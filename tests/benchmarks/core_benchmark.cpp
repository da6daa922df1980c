/// \file
/// Time of the core's calls for one state of a delta4, in float and double: mean, and the worst of the repetitions
/// beside it.

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <vector>

#include "deltadyn/dynamics/equations_of_motion.hpp"
#include "deltadyn/dynamics/forward_dynamics.hpp"
#include "deltadyn/dynamics/inverse_dynamics.hpp"
#include "deltadyn/dynamics/inverse_dynamics_derivatives.hpp"
#include "deltadyn/dynamics/joint_reactions.hpp"
#include "deltadyn/dynamics/mass_matrix.hpp"
#include "deltadyn/model/inertial_parameters.hpp"

namespace {

using namespace deltadyn;
using Layout = ParameterLayout<Delta4, Limbs::shared>;

template <class T>
Geometry<T, Delta4> geometry() {
  Geometry<T, Delta4> g;
  for (int i = 0; i < 3; ++i) {
    LimbGeometry<T>& limb = g.limbs[i];
    limb.azimuth = static_cast<T>(2.0943951023931953 * i);
    const Vector3<T> radial(std::cos(limb.azimuth), std::sin(limb.azimuth), T(0));
    limb.p_WD = T(0.2) * radial;
    limb.p_DE_0 = Vector3<T>(T(0.525), T(0), T(0));
    limb.strut = T(1.106);
    limb.p_BA = T(0.05) * radial;
  }
  return g;
}

/// A motion whose inputs the compiler does not know.
template <class T>
struct State {
  Vector<T, 4> q{T(0.1), T(-0.2), T(0.3), T(1)}, qd{T(1), T(-2), T(3), T(10)}, qdd{T(10), T(20), T(-30), T(100)};
  Vector<T, Layout::kColumns> p = Vector<T, Layout::kColumns>::Constant(T(0.1));
  State() {
    auto* known = q.data();
    benchmark::DoNotOptimize(known);
  }
};

/// Calls `work(geometry, state, motion)` once an iteration, after the posture and rates of the state.
template <class T, class Work>
void after_motion(benchmark::State& state, Work work) {
  const auto g = geometry<T>();
  State<T> s;
  Motion<T, Delta4> m;
  for (auto _ : state) {
    benchmark::ClobberMemory();
    Status status = motion_from_drives(g, s.q, s.qd, s.qdd, m);
    benchmark::DoNotOptimize(status);
    auto result = work(g, s, m);
    benchmark::DoNotOptimize(result);
  }
}

template <class T>
void motion(benchmark::State& state) {
  after_motion<T>(state, [](const auto&, const auto&, const auto& m) { return m.zdd; });
}

template <class T>
void torque(benchmark::State& state) {
  after_motion<T>(state,
                  [](const auto& g, const auto& s, const auto& m) { return inverse_dynamics<Layout>(g, m, s.p); });
}

template <class T>
void full_regressor(benchmark::State& state) {
  after_motion<T>(state, [](const auto& g, const auto&, const auto& m) {
    Matrix<T, 4, Layout::kColumns> Y;
    regressor<Layout>(g, m, Y);
    return Y;
  });
}

template <class T>
void inertia(benchmark::State& state) {
  after_motion<T>(state,
                  [](const auto& g, const auto& s, const auto& m) { return mass_matrix<Layout>(g, m.posture, s.p); });
}

/// Torques of the state serve as what to accelerate with.
template <class T>
void acceleration(benchmark::State& state) {
  after_motion<T>(state, [](const auto& g, const auto& s, const auto& m) {
    Vector<T, 4> qdd;
    const Status status = forward_dynamics<Layout, T, Delta4>(g, m.posture, s.qd, s.qdd, s.p, qdd);
    benchmark::DoNotOptimize(status);
    return qdd;
  });
}

template <class T>
void equations(benchmark::State& state) {
  after_motion<T>(state,
                  [](const auto& g, const auto& s, const auto& m) { return equations_of_motion<Layout>(g, m, s.p); });
}

template <class T>
void derivatives(benchmark::State& state) {
  after_motion<T>(state, [](const auto& g, const auto& s, const auto& m) {
    TorqueDerivatives<T, 4> d;
    const Status status = inverse_dynamics_derivatives<Layout>(g, m, s.p, d);
    benchmark::DoNotOptimize(status);
    return d;
  });
}

template <class T>
void reactions(benchmark::State& state) {
  after_motion<T>(state, [](const auto& g, const auto& s, const auto& m) {
    JointReactions<T, Delta4> loads;
    const Status status = joint_reactions<Layout>(g, m, s.p, loads);
    benchmark::DoNotOptimize(status);
    return loads;
  });
}

double worst(const std::vector<double>& times) {
  return *std::max_element(times.begin(), times.end());
}

#define DELTADYN_BENCHMARK(name)          \
  BENCHMARK(name)                         \
      ->Repetitions(20)                   \
      ->ReportAggregatesOnly()            \
      ->ComputeStatistics("worst", worst) \
      ->Unit(benchmark::kMicrosecond)

DELTADYN_BENCHMARK(motion<double>);
DELTADYN_BENCHMARK(motion<float>);
DELTADYN_BENCHMARK(torque<double>);
DELTADYN_BENCHMARK(torque<float>);
DELTADYN_BENCHMARK(full_regressor<double>);
DELTADYN_BENCHMARK(full_regressor<float>);
DELTADYN_BENCHMARK(inertia<double>);
DELTADYN_BENCHMARK(inertia<float>);
DELTADYN_BENCHMARK(acceleration<double>);
DELTADYN_BENCHMARK(acceleration<float>);
DELTADYN_BENCHMARK(equations<double>);
DELTADYN_BENCHMARK(equations<float>);
DELTADYN_BENCHMARK(derivatives<double>);
DELTADYN_BENCHMARK(derivatives<float>);
DELTADYN_BENCHMARK(reactions<double>);
DELTADYN_BENCHMARK(reactions<float>);

}  // namespace
