#pragma once

/// \file
/// How many threads the parallel parts of the library use.

namespace deltadyn {

/// \param threads at least 1; 0 takes as many as the machine has. Throws deltadyn::Error(usage) if negative.
void set_threads(int threads);

}  // namespace deltadyn
