#include "deltadyn/runtime/threads.hpp"

#include <fmt/format.h>
#include <omp.h>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

void set_threads(int threads) {
  if (threads < 0)
    throw Error(fmt::format("{} threads were asked for", threads), "", "give 1 or more, or 0 for all of the machine",
                ExitCode::usage);
  omp_set_num_threads(threads == 0 ? omp_get_num_procs() : threads);
}

}  // namespace deltadyn
