// Runs the core under an allocator that counts. Every allocation of the process passes through the functions below,
// with or without NDEBUG and whatever Eigen's own switches say.

#include <Eigen/Core>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <gtest/gtest.h>
#include <new>
#include <string>
#include <vector>

#include "core_calls.hpp"
#include "effect_calls.hpp"

extern "C" {
// glibc's own allocator under its second name, so that the first one may be replaced.
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);
}

namespace {
thread_local int allocations = 0;
thread_local int releases = 0;
}  // namespace

extern "C" {
void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) noexcept {
  ++allocations;
  return __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
void free(void* block) noexcept {
  if (block != nullptr) ++releases;
  __libc_free(block);
}
}

namespace deltadyn::firmware_gate {
namespace {

/// Allocations and releases of this thread since it was made.
class AllocationCounter {
 public:
  [[nodiscard]] int allocated() const { return allocations - allocations_before_; }
  [[nodiscard]] int released() const { return releases - releases_before_; }

 private:
  int allocations_before_ = allocations;
  int releases_before_ = releases;
};

// The compiler may leave out an allocation whose result nobody sees.
template <class T>
void let_be_seen(T* pointer) {
  asm volatile("" : : "g"(pointer) : "memory");
}

TEST(AllocationCounter, SeesEveryWayToTheHeap) {
  const auto count = [](auto&& allocate) {
    const AllocationCounter counter;
    allocate();
    EXPECT_EQ(counter.allocated(), counter.released());
    return counter.allocated();
  };
  EXPECT_EQ(count([] {}), 0);
  EXPECT_EQ(count([] {
              int* p = new int(1);
              let_be_seen(p);
              delete p;
            }),
            1);
  EXPECT_EQ(count([] {
              void* p = std::malloc(10);
              let_be_seen(p);
              std::free(p);
            }),
            1);
  EXPECT_EQ(count([] {
              struct alignas(128) Wide {
                double values[16];
              };
              auto* p = new Wide();
              let_be_seen(p);
              delete p;
            }),
            1);
  EXPECT_EQ(count([] {
              std::vector<double> v(100);
              let_be_seen(v.data());
            }),
            1);
  EXPECT_EQ(count([] {
              Eigen::VectorXd v = Eigen::VectorXd::Zero(100);
              let_be_seen(v.data());
            }),
            1);
}

class CoreCalls : public testing::TestWithParam<int> {};

/// `precision` is what rounding may cost in the scalar.
template <class T>
void expect_sound_and_free_of_heap(Outcome (*run)(int, T), int robot, double precision) {
  for (const double phase : {0.3, 1.7, 4.1}) {
    const AllocationCounter counter;
    const Outcome outcome = run(robot, static_cast<T>(phase));
    const int allocated = counter.allocated();
    const int released = counter.released();
    EXPECT_EQ(allocated, 0) << "phase " << phase;
    EXPECT_EQ(released, 0) << "phase " << phase;
    // Calls that give up early allocate nothing either; these did their work.
    ASSERT_TRUE(outcome.ok) << "phase " << phase;
    EXPECT_GT(outcome.largest_torque, 0.1);
    EXPECT_LT(outcome.round_trip, precision);
    EXPECT_LT(outcome.regressor_gap, precision);
    EXPECT_LT(outcome.mass_asymmetry, precision);
    EXPECT_LT(outcome.acceleration_gap, 10 * precision);
    EXPECT_LT(outcome.equations_gap, precision);
    EXPECT_LT(outcome.slope_gap, precision);
    EXPECT_LT(outcome.reaction_gap, precision);
    EXPECT_LT(outcome.inertia_round_trip, precision);
    EXPECT_LT(outcome.inertia_jacobian_gap, precision);
    EXPECT_LT(outcome.feed_forward_gap, 10 * precision);
  }
}

TEST_P(CoreCalls, SinglePrecision) {
  expect_sound_and_free_of_heap(run_float, GetParam(), 2e-4);
}

TEST_P(CoreCalls, DoublePrecision) {
  expect_sound_and_free_of_heap(run_double, GetParam(), 1e-12);
}

/// A million set points for the robot with all parts, fewer for the others; no NaN reaches the drives, no call takes
/// heap.
void expect_finite_and_free_of_heap(EffectOutcome (*run)(int, long), int robot) {
  const long set_points = std::string(kRobotNames[robot]) == "delta4" ? 1'000'000 : 200'000;
  const AllocationCounter counter;
  const EffectOutcome outcome = run(robot, set_points);
  const int allocated = counter.allocated();
  EXPECT_EQ(allocated, 0);
  EXPECT_EQ(outcome.wrong, 0);
  EXPECT_TRUE(outcome.settings);
  EXPECT_GT(outcome.effects, 10);
  EXPECT_GT(outcome.ok, set_points / 4);
  EXPECT_GT(outcome.refused, set_points / 200);
  EXPECT_GT(outcome.largest_torque, 1);
}

TEST_P(CoreCalls, EffectsInSinglePrecision) {
  expect_finite_and_free_of_heap(run_effects_float, GetParam());
}

TEST_P(CoreCalls, EffectsInDoublePrecision) {
  expect_finite_and_free_of_heap(run_effects_double, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Robots, CoreCalls, testing::Range(0, kRobots), [](const testing::TestParamInfo<int>& robot) {
  return std::string(kRobotNames[robot.param]);
});

}  // namespace
}  // namespace deltadyn::firmware_gate
