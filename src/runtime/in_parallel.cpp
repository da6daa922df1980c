#include "deltadyn/runtime/in_parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <fmt/format.h>
#include <limits>
#include <mutex>
#include <omp.h>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

void set_threads(int threads) {
  if (threads < 0)
    throw Error(fmt::format("{} threads were asked for", threads), "", "give 1 or more, or 0 for all of the machine",
                ExitCode::usage);
  omp_set_num_threads(threads == 0 ? omp_get_num_procs() : threads);
}

namespace detail {

namespace {

// Few enough to hand out cheaply, many enough for all threads to end together
constexpr std::size_t kPortionsPerThread = 64;

/// The exception of the lowest pass. An exception must not leave an OpenMP region, which would end the program.
class FirstFailure {
 public:
  void keep(std::size_t pass, std::exception_ptr failure) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (pass >= pass_) return;
    pass_ = pass;
    failure_ = std::move(failure);
  }
  /// May the pass be left out? Passes below the lowest that failed must run, as one of them may be the first to fail.
  [[nodiscard]] bool before(std::size_t pass) const { return pass_ < pass; }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::mutex mutex_;
  std::atomic<std::size_t> pass_ = std::numeric_limits<std::size_t>::max();
  std::exception_ptr failure_;
};

/// No more than there are passes, so that a short loop does not wake all of them.
int team_of(int threads, std::size_t count) {
  const auto wanted = static_cast<std::size_t>(threads > 0 ? threads : omp_get_max_threads());
  return static_cast<int>(std::clamp<std::size_t>(count, 1, wanted));
}

}  // namespace

void run_in_parallel(std::size_t count, const std::function<void(std::size_t)>& pass, int threads) {
  FirstFailure failure;
  const int team = team_of(threads, count);
  const std::size_t portion = std::max<std::size_t>(1, count / (kPortionsPerThread * static_cast<std::size_t>(team)));
#pragma omp parallel for schedule(dynamic, portion) num_threads(team)
  for (std::size_t k = 0; k < count; ++k) {
    if (failure.before(k)) continue;
    try {
      pass(k);
    } catch (...) {
      failure.keep(k, std::current_exception());
    }
  }
  failure.rethrow();
}

void run_in_order(std::size_t count, const std::function<std::function<void()>(std::size_t)>& compute, int threads) {
  FirstFailure failure;
  const int team = team_of(threads, count);
#pragma omp parallel for ordered schedule(static, 1) num_threads(team)
  for (std::size_t k = 0; k < count; ++k) {
    std::function<void()> take;
    try {
      if (!failure.before(k)) take = compute(k);
    } catch (...) {
      failure.keep(k, std::current_exception());
    }
#pragma omp ordered
    try {
      if (take && !failure.before(k)) take();
    } catch (...) {
      failure.keep(k, std::current_exception());
    }
  }
  failure.rethrow();
}

}  // namespace detail
}  // namespace deltadyn
