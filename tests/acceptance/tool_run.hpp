#pragma once

/// \file
/// Runs an installed tool as a user does, and looks at what it left behind.

#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iostream>
#include <map>
#include <signal.h>
#include <sstream>
#include <stdexcept>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "io/temporary_folder.hpp"

namespace deltadyn::acceptance {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

inline Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

inline std::string tool_path(const std::string& tool) {
  return std::string(DELTADYN_STAGE_DIR) + "/bin/" + tool;
}
inline std::string installed(const std::string& file) {
  return std::string(DELTADYN_STAGE_DIR) + "/share/deltadyn/" + file;
}

inline std::string read_text(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

struct ToolResult {
  int code = 0;  ///< exit code, or minus the signal that ended the tool (-14: it took too long)
  std::string out, err;
};

struct RunLimits {
  unsigned seconds = 300;             ///< of wall-clock time
  rlim_t file_bytes = RLIM_INFINITY;  ///< largest file the tool may write: the disk of the poor
};

/// A tool that runs. Its standard output and error go to files of their own outside `folder`s under test.
struct RunningTool {
  pid_t process = 0;
  std::string out_file, err_file;
};

/// words: tool and arguments.
inline RunningTool start(const Words& words, const RunLimits& limits = {}) {
  char out_name[] = "/tmp/deltadyn_out_XXXXXX";
  char err_name[] = "/tmp/deltadyn_err_XXXXXX";
  const int out = ::mkstemp(out_name);
  const int err = ::mkstemp(err_name);
  if (out < 0 || err < 0) throw std::runtime_error("no temporary file");
  std::vector<std::string> copy = words;
  copy[0] = tool_path(words[0]);
  std::vector<char*> arguments;
  for (std::string& word : copy) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {
    const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    if (limits.file_bytes != RLIM_INFINITY) {
      // As on a full disk, write() then returns an error instead of raising a signal.
      ::signal(SIGXFSZ, SIG_IGN);
      const rlimit size{limits.file_bytes, limits.file_bytes};
      ::setrlimit(RLIMIT_FSIZE, &size);
    }
    ::alarm(limits.seconds);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  ::close(out);
  ::close(err);
  return {child, out_name, err_name};
}

/// Waits until the tool has used so much processor time, or has ended: however slow and busy the machine is.
inline void wait_for_work(const RunningTool& tool, double cpu_s) {
  for (;;) {
    const std::string text = read_text("/proc/" + std::to_string(tool.process) + "/stat");
    const auto name_end = text.rfind(')');
    if (name_end == std::string::npos) return;
    std::istringstream fields(text.substr(name_end + 1));
    std::string state, skipped;
    double user = 0, system = 0;
    fields >> state;
    for (int k = 0; k < 10; ++k) fields >> skipped;
    fields >> user >> system;
    if (state == "Z" || (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK)) >= cpu_s) return;
    ::usleep(50000);
  }
}

inline ToolResult finish(const RunningTool& tool) {
  int status = 0;
  ::waitpid(tool.process, &status, 0);
  ToolResult result;
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  result.out = read_text(tool.out_file);
  result.err = read_text(tool.err_file);
  ::unlink(tool.out_file.c_str());
  ::unlink(tool.err_file.c_str());
  return result;
}

inline ToolResult run(const Words& words, const RunLimits& limits = {}) {
  return finish(start(words, limits));
}

/// Runs a tool that must succeed.
inline ToolResult succeed(const Words& words, const RunLimits& limits = {}) {
  const ToolResult result = run(words, limits);
  if (result.code != 0) {
    std::string line;
    for (const std::string& word : words) line += word + " ";
    ADD_FAILURE() << line << "ended with " << result.code << "\n" << result.out << result.err;
    throw std::runtime_error("a tool failed that the test needs");
  }
  return result;
}

/// Every file below a folder with its bytes.
inline std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder).string()] = read_text(entry.path());
  }
  return files;
}

/// key -> value of a --summary file.
inline std::map<std::string, std::string> read_summary(const std::string& file) {
  std::map<std::string, std::string> values;
  std::istringstream lines(read_text(file));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "key,value,unit") << file;
  while (std::getline(lines, line)) {
    const auto first = line.find(','), second = line.find(',', first + 1);
    if (second == std::string::npos) {
      ADD_FAILURE() << file << ": " << line;
      continue;
    }
    values[line.substr(0, first)] = line.substr(first + 1, second - first - 1);
  }
  return values;
}

inline double number(const std::map<std::string, std::string>& summary, const std::string& key) {
  const auto found = summary.find(key);
  if (found == summary.end()) {
    ADD_FAILURE() << "the summary has no " << key;
    return 0;
  }
  return std::stod(found->second);
}

/// Prints what was reached beside what was wanted, for reports, and checks it.
inline void figure(const std::string& name, double value, double target) {
  std::cout << "figure " << name << " " << value << " target " << target << (value <= target ? "" : "  MISSED")
            << std::endl;
  ::testing::Test::RecordProperty(name, std::to_string(value));
  EXPECT_LE(value, target) << name;
}

}  // namespace deltadyn::acceptance
