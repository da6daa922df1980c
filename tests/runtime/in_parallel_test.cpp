#include "deltadyn/runtime/in_parallel.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "deltadyn/runtime/error.hpp"

extern "C" int omp_get_max_threads();  // of the OpenMP runtime; its header is not with every compiler

namespace deltadyn {
namespace {

constexpr int kPasses = 800;

void rest_ms(int duration) {
  std::this_thread::sleep_for(std::chrono::milliseconds(duration));
}

TEST(InParallel, RunsEachPassOnce) {
  for (const int threads : {0, 1, 2, 3, 8}) {
    for (const int count : {0, 1, 2, 7, kPasses}) {
      std::vector<std::atomic<int>> runs(static_cast<std::size_t>(count));
      in_parallel(
          count, [&](int k) { ++runs[static_cast<std::size_t>(k)]; }, threads);
      for (const auto& times : runs) EXPECT_EQ(times, 1) << count << " passes on " << threads << " threads";
    }
  }
}

TEST(InParallel, ANegativeCountIsAnEmptyLoop) {
  in_parallel(-1, [](int) { FAIL(); });
}

TEST(InParallel, TakesTheIndexOfTheCaller) {
  in_parallel(std::size_t{3}, [](auto k) { static_assert(std::is_same_v<decltype(k), std::size_t>); });
}

TEST(InParallel, UsesAsManyThreadsAsAskedFor) {
  std::atomic<int> inside = 0, most = 0;
  const auto pass = [&](int) {
    most = std::max(most.load(), ++inside);
    rest_ms(5);
    --inside;
  };
  in_parallel(20, pass, 1);
  EXPECT_EQ(most, 1);
  in_parallel(20, pass, 4);
  EXPECT_GT(most, 1);
  EXPECT_LE(most, 4);
}

TEST(InParallel, ThrowsTheExceptionOfTheLowestPass) {
  for (const int threads : {1, 2, 4}) {
    for (int trial = 0; trial < 20; ++trial) {
      try {
        in_parallel(
            kPasses,
            [](int k) {
              if (k == 300) rest_ms(1);  // so that a later pass fails earlier
              if (k == 300 || k == 301 || k >= 500) throw std::runtime_error(std::to_string(k));
            },
            threads);
        FAIL() << "no exception on " << threads << " threads";
      } catch (const std::runtime_error& failure) {
        EXPECT_STREQ(failure.what(), "300");
      }
    }
  }
}

TEST(InParallel, RunsEveryPassBelowTheOneThatFails) {
  std::vector<std::atomic<int>> runs(kPasses);
  EXPECT_THROW(in_parallel(
                   kPasses,
                   [&](int k) {
                     ++runs[static_cast<std::size_t>(k)];
                     if (k == 700) throw 1;
                   },
                   3),
               int);
  for (std::size_t k = 0; k <= 700; ++k) EXPECT_EQ(runs[k], 1) << k;
}

TEST(InParallel, ALoopInsideAPassPassesItsExceptionOn) {
  EXPECT_THROW(in_parallel(4,
                           [](int k) {
                             in_parallel(4, [k](int l) {
                               if (k + l == 3) throw std::runtime_error("inner");
                             });
                           }),
               std::runtime_error);
}

TEST(InParallelInOrder, TakesEachResultOnceAndInOrder) {
  for (const int threads : {0, 1, 2, 3}) {
    std::vector<int> taken;
    in_parallel_in_order(
        kPasses, [](int k) { return std::make_unique<int>(2 * k); },
        [&](int k, std::unique_ptr<int> result) {
          EXPECT_EQ(*result, 2 * k);
          taken.push_back(k);
        },
        threads);
    ASSERT_EQ(taken.size(), kPasses);
    EXPECT_TRUE(std::is_sorted(taken.begin(), taken.end()));
  }
}

TEST(InParallelInOrder, ASumIsTheSameOnAnyNumberOfThreads) {
  const auto sum_on = [](int threads) {
    double sum = 0;
    in_parallel_in_order(
        kPasses, [](int k) { return 1.0 / (k + 0.1); }, [&](int, double part) { sum += part; }, threads);
    return sum;
  };
  const double alone = sum_on(1);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(sum_on(threads), alone);
}

TEST(InParallelInOrder, TakesNothingBehindTheFirstExceptionAndThrowsIt) {
  for (const bool in_take : {false, true}) {
    for (const int threads : {1, 2, 4}) {
      int last = -1;
      try {
        in_parallel_in_order(
            kPasses,
            [&](int k) {
              if (k == 400 && !in_take) rest_ms(1);
              if (k >= 400 && !in_take) throw std::runtime_error(std::to_string(k));
              return k;
            },
            [&](int k, int) {
              if (k >= 400) throw std::runtime_error(std::to_string(k));
              last = k;
            },
            threads);
        FAIL() << "no exception on " << threads << " threads";
      } catch (const std::runtime_error& failure) {
        EXPECT_STREQ(failure.what(), "400");
      }
      EXPECT_EQ(last, 399);
    }
  }
}

TEST(Threads, AreSetForTheParallelParts) {
  set_threads(3);
  EXPECT_EQ(omp_get_max_threads(), 3);
  set_threads(0);
  EXPECT_GE(omp_get_max_threads(), 1);
}

TEST(Threads, NegativeNumbersAreAUsageError) {
  try {
    set_threads(-1);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::usage);
  }
}

}  // namespace
}  // namespace deltadyn
