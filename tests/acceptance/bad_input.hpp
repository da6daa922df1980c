#pragma once

/// \file
/// One row of a table of wrong commands and files, and what must come of it.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <regex>

#include "acceptance/workshop.hpp"

namespace deltadyn::acceptance {

struct Row {
  const char* name;
  std::function<Words(const Workshop&)> command;  ///< prepares its inputs, too
  int code;
  std::vector<std::string> message;  ///< regular expressions that the error output must match
  RunLimits limits = {};
};

inline std::ostream& operator<<(std::ostream& out, const Row& row) {
  return out << row.name;
}

inline std::string name_of(const ::testing::TestParamInfo<Row>& one) {
  return one.param.name;
}

/// The command is refused with its message and exit code, its inputs stay as they are, and nothing new is left.
inline void expect_refused(const Row& row) {
  const Workshop workshop;
  const Words command = row.command(workshop);
  const auto before = contents(workshop.folder());
  const ToolResult result = run(command, row.limits);
  EXPECT_EQ(result.code, row.code);
  EXPECT_NE(result.err.find(command[0]), std::string::npos) << "the message does not name the tool";
  for (const std::string& piece : row.message) {
    EXPECT_TRUE(std::regex_search(result.err, std::regex(piece))) << "not in the message: " << piece;
  }
  const auto after = contents(workshop.folder());
  for (const auto& [file, bytes] : before) {
    EXPECT_TRUE(after.count(file) == 1 && after.at(file) == bytes) << file << " was changed";
  }
  for (const auto& [file, bytes] : after) EXPECT_EQ(before.count(file), 1U) << "left behind: " << file;
  if (::testing::Test::HasFailure()) std::cout << "exit code " << result.code << "\n" << result.out << result.err;
}

inline Words create_delta3(const std::string& file, double base, double plate, double arm, double strut) {
  const auto text = [](double x) { return fmt::format("{}", x); };
  return {"delta-model",       "create",    "delta3",      "--base-radius", text(base),
          "--platform-radius", text(plate), "--upper-arm", text(arm),       "--strut",
          text(strut),         "-o",        file};
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("no " + from);
  return text.replace(at, from.size(), to);
}

}  // namespace deltadyn::acceptance
