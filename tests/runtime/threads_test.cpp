#include "deltadyn/runtime/threads.hpp"

#include <gtest/gtest.h>

#include "deltadyn/runtime/error.hpp"

extern "C" int omp_get_max_threads();  // of the OpenMP runtime; its header is not with every compiler

namespace deltadyn {
namespace {

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
