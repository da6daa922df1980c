#pragma once

/// \file
/// Loops whose passes run on several threads. They are the only place of the library that starts threads, so that the
/// rules hold everywhere: an exception comes out of the loop, and what comes out does not depend on the number of
/// threads.

#include <concepts>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>

namespace deltadyn {

/// \param threads at least 1; 0 takes as many as the machine has. Throws deltadyn::Error(usage) if negative.
void set_threads(int threads);

namespace detail {

void run_in_parallel(std::size_t count, const std::function<void(std::size_t)>& pass, int threads);

/// \param compute  gives what is to be done with the result of a pass
void run_in_order(std::size_t count, const std::function<std::function<void()>(std::size_t)>& compute, int threads);

}  // namespace detail

/// Runs pass(k) for k = 0 .. count - 1, each once, on any thread and in any order; passes must write to places of their
/// own. If passes throw, the exception of the lowest k is thrown again after the loop; passes of higher k may then be
/// left out. A loop inside a pass runs on the thread of that pass.
/// \param threads  how many; 0 or less takes the number of set_threads()
template <std::integral Index, std::invocable<Index> Pass>
void in_parallel(Index count, Pass&& pass, int threads = 0) {
  if (count <= 0) return;
  detail::run_in_parallel(
      static_cast<std::size_t>(count), [&](std::size_t k) { pass(static_cast<Index>(k)); }, threads);
}

/// Runs compute(k) for k = 0 .. count - 1 as in_parallel() does, and hands each result to take(k, result), one at a
/// time and in the order of k, so that a sum is the same on any number of threads. Only as many results are held as
/// there are threads. If compute or take throws, the exception of the lowest k is thrown again after the loop, and
/// nothing of a higher k has been taken.
/// \param threads  how many; 0 or less takes the number of set_threads()
template <std::integral Index, std::invocable<Index> Compute,
          std::invocable<Index, std::invoke_result_t<Compute, Index>> Take>
void in_parallel_in_order(Index count, Compute&& compute, Take&& take, int threads = 0) {
  using Result = std::invoke_result_t<Compute, Index>;
  if (count <= 0) return;
  const auto computed = [&](std::size_t at) -> std::function<void()> {
    const auto k = static_cast<Index>(at);
    auto result = std::make_shared<Result>(compute(k));
    return [&take, k, result = std::move(result)] { take(k, std::move(*result)); };
  };
  detail::run_in_order(static_cast<std::size_t>(count), computed, threads);
}

}  // namespace deltadyn
