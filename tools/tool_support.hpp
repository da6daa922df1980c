#pragma once

/// \file
/// What all command-line tools share: flags, exit codes, messages, progress.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <new>
#include <sstream>
#include <string>
#include <type_traits>
#include <unistd.h>
#include <utility>
#include <vector>

#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/summary.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/in_parallel.hpp"

namespace deltadyn::tools {

struct ToolText {
  std::string name;         ///< "delta-model"
  std::string description;  ///< one or two sentences
  std::string example;      ///< one or more command lines
};

/// What every tool knows besides its own flags. The tool adds its figures to `summary`, which is written when it has
/// succeeded or when it ends with not_trusted.
class ToolRun {
 public:
  Summary summary;
  std::uint64_t seed = 1;

  /// Sets what the tool does; with subcommands, what this subcommand does.
  /// \param work returns nothing, or the exit code: done, or not_trusted if a check failed. Errors are thrown.
  template <class Work>
  void on(CLI::App& command, Work work) {
    command.callback([this, work] {
      work_ = [work] {
        if constexpr (std::is_void_v<decltype(work())>) {
          work();
          return ExitCode::done;
        } else {
          return work();
        }
      };
    });
  }

  /// Refuses, before any work is done, outputs (the summary is one more) that would overwrite an input or one another,
  /// or whose folder cannot be written to. Empty names do not count. Throws Error(usage) or Error(bad_input).
  void check_files(std::vector<std::string> outputs, const std::vector<std::string>& inputs) const {
    outputs.push_back(summary_file_);
    std::vector<std::string> taken;
    for (const std::string& output : outputs) {
      if (output.empty()) continue;
      refuse_overwrite(output, inputs);
      try {
        refuse_overwrite(output, taken);
      } catch (const Error& e) {
        if (is_device(output)) continue;  // two results may go to /dev/null
        throw Error("two outputs have the same name", output, e.mend(), ExitCode::usage);
      }
      taken.push_back(output);
      if (!is_device(output)) const OutputFile can_be_written(output);  // not committed, so nothing changes
    }
  }

 private:
  static bool is_device(const std::string& path) {
    std::error_code ignored;
    const auto status = std::filesystem::status(path, ignored);
    return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
           !std::filesystem::is_directory(status);
  }

  friend int run_tool(int, char**, const ToolText&, const std::function<void(CLI::App&, ToolRun&)>&);
  std::function<ExitCode()> work_;
  std::string summary_file_;
  int threads_ = 0;
};

/// Help text of a subcommand's examples.
inline void set_example(CLI::App& command, const std::string& example) {
  command.footer("\nExample:\n  " + example);
}

/// Parses, runs, and maps every way to fail to its exit code: 0 done, 2 usage, 3 bad input, 4 no convergence, 5 not
/// trusted.
/// \param setup adds the tool's own flags to the app and calls ToolRun::on.
inline int run_tool(int argc, char** argv, const ToolText& text,
                    const std::function<void(CLI::App&, ToolRun&)>& setup) {
  CLI::App app(text.description, text.name);
  ToolRun run;
  const auto fail = [&](const char* kind, const std::string& words, ExitCode code) {
    std::fflush(stdout);
    std::fprintf(stderr, "%s: %s: %s\n", text.name.c_str(), kind, words.c_str());
    return static_cast<int>(code);
  };
  try {
    app.set_version_flag("--version", text.name + " (deltadyn) " DELTADYN_VERSION);
    app.set_config("--config", "", "TOML file with values for the flags; flags on the command line win")
        ->type_name("FILE");
    app.add_option("--summary", run.summary_file_, "CSV key,value,unit with the figures the tool prints")
        ->type_name("FILE");
    app.add_option("--seed", run.seed, "seed of everything random; the same seed gives the same output")
        ->capture_default_str();
    app.add_option("--threads", run.threads_, "number of threads, 0: as many as the machine has")
        ->check(CLI::Range(0, 4096))
        ->capture_default_str();
    app.allow_config_extras(CLI::config_extras_mode::error);  // a misspelt key must not go unseen
    set_example(app, text.example);
    app.fallthrough();  // subcommands take these flags, too
    setup(app, run);
    for (CLI::App* command : app.get_subcommands({})) command->fallthrough();
    app.parse(argc, argv);
    set_threads(run.threads_);
    const ExitCode code = run.work_ ? run.work_() : ExitCode::done;
    run.summary.write(run.summary_file_);
    std::fflush(stdout);
    return static_cast<int>(code);
  } catch (const CLI::FileError& e) {
    return fail("error", e.what(), ExitCode::bad_input);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // prints the help or the version
    std::string command = text.name;
    for (const CLI::App* part : app.get_subcommands()) command += " " + part->get_name();
    return fail("error", std::string(e.what()) + "\n  mend: " + command + " --help shows the flags", ExitCode::usage);
  } catch (const Error& e) {
    return fail("error", e.what(), e.code());
  } catch (const std::bad_alloc&) {
    return fail("error", "out of memory\n  mend: give a shorter input or use a larger machine", ExitCode::bad_input);
  } catch (const std::exception& e) {
    return fail("unexpected error", e.what(), ExitCode::bad_input);
  }
}

/// A list of numbers of one flag: "1" for all, or one for each of `count`, separated by commas.
/// Throws Error(usage) that names the flag.
inline std::vector<double> spread(const std::vector<double>& values, std::size_t count, const std::string& flag) {
  if (values.size() == 1) return std::vector<double>(count, values[0]);
  if (values.size() != count)
    throw Error(flag + " has " + std::to_string(values.size()) + " values", "",
                "give one, or " + std::to_string(count) + " separated by commas", ExitCode::usage);
  return values;
}

/// Ranges "lo,hi" for all, or "lo,hi;lo,hi;..." for each of `count`. Throws Error(usage) that names the flag.
inline std::vector<std::pair<double, double>> spread_ranges(const std::string& text, std::size_t count,
                                                            const std::string& flag) {
  std::vector<std::pair<double, double>> ranges;
  std::istringstream entries(text);
  for (std::string entry; std::getline(entries, entry, ';');) {
    double low = 0, high = 0;
    char comma = 0;
    std::string rest;
    std::istringstream words(entry);
    if (!(words >> low >> comma >> high) || comma != ',' || words >> rest || !(low < high))
      throw Error(flag + ": '" + entry + "' is not a range", "", "write lower,upper with lower < upper, e.g. -0.7,1.5",
                  ExitCode::usage);
    ranges.emplace_back(low, high);
  }
  if (ranges.size() == 1) ranges.resize(count, ranges[0]);
  if (ranges.size() != count)
    throw Error(flag + " has " + std::to_string(ranges.size()) + " ranges", "",
                "give one, or " + std::to_string(count) + " separated by semicolons", ExitCode::usage);
  return ranges;
}

/// A bar on stderr, only on a terminal and only when the work lasts over a second.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label) : label_(std::move(label)), on_terminal_(isatty(STDERR_FILENO) != 0) {}
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() {
    if (shown_) std::fprintf(stderr, "\r\033[K");
  }
  /// \param share done, 0 to 1
  void update(double share) {
    using namespace std::chrono;
    const auto now = steady_clock::now();
    if (!on_terminal_ || now - start_ < seconds(1) || now - last_ < milliseconds(100)) return;
    last_ = now;
    shown_ = true;
    constexpr int kWidth = 40;
    const int full = static_cast<int>(std::lround(kWidth * std::min(1.0, std::max(0.0, share))));
    std::fprintf(stderr, "\r%s [%s%s] %3d %%", label_.c_str(), std::string(static_cast<std::size_t>(full), '#').c_str(),
                 std::string(static_cast<std::size_t>(kWidth - full), ' ').c_str(), full * 100 / kWidth);
    std::fflush(stderr);
  }

 private:
  std::string label_;
  bool on_terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_ = start_;
};

}  // namespace deltadyn::tools
