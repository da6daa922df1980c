#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace deltadyn {

struct ProcessResult {
  int start_error = 0;  ///< errno if the program could not be started
  int exit_code = -1;   ///< 128 + number if a signal ended it
  std::string output;
  std::string errors;
};

/// Runs a program found in PATH with these arguments, without a shell: feeds \p input to it and collects what it
/// writes.
ProcessResult run_process(const std::vector<std::string>& arguments, std::string_view input);

}  // namespace deltadyn
