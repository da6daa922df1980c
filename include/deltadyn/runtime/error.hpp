#pragma once

/// \file
/// The one exception above the core: what is wrong, where, and how to mend it.

#include <stdexcept>
#include <string>

namespace deltadyn {

/// Exit codes of the tools (part of their contract).
enum class ExitCode : int { done = 0, usage = 2, bad_input = 3, no_convergence = 4, not_trusted = 5 };

class Error : public std::runtime_error {
 public:
  /// \param what   what is wrong, in one sentence
  /// \param where  file, line and column name as far as known, e.g. "log.csv, line 12, column q1_rad" (may be empty)
  /// \param mend   what the user can do about it (may be empty)
  Error(std::string what, std::string where, std::string mend, ExitCode code = ExitCode::bad_input)
      : std::runtime_error((where.empty() ? "" : where + ": ") + what + (mend.empty() ? "" : "\n  mend: " + mend)),
        problem_(std::move(what)),
        where_(std::move(where)),
        mend_(std::move(mend)),
        code_(code) {}

  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] const std::string& where() const { return where_; }
  [[nodiscard]] const std::string& mend() const { return mend_; }
  [[nodiscard]] ExitCode code() const { return code_; }

 private:
  std::string problem_, where_, mend_;
  ExitCode code_;
};

}  // namespace deltadyn
