#include "deltadyn/io/output_file.hpp"

#include <csignal>
#include <gmock/gmock.h>
#include <sstream>
#include <stdexcept>
#include <sys/resource.h>

#include "deltadyn/runtime/error.hpp"

#include "io/temporary_folder.hpp"

namespace deltadyn {
namespace {

using ::deltadyn::testing_support::TemporaryFolder;
using ::testing::HasSubstr;

TEST(OutputFile, AppearsOnCommitOnly) {
  const TemporaryFolder folder;
  (void)folder.write("out.csv", "old");
  {
    OutputFile file(folder.path("out.csv"));
    file.print("{},{}\n", 1, 0.1);
    EXPECT_EQ(folder.read("out.csv"), "old");
    file.commit();
  }
  EXPECT_EQ(folder.read("out.csv"), "1,0.1\n");
  EXPECT_EQ(folder.files(), 1);
}

TEST(OutputFile, ATableReadsBackExactlyWhateverItsLength) {
  const TemporaryFolder folder;
  const Eigen::VectorXd t_s = Eigen::VectorXd::LinSpaced(9000, 0.0, 9.0);
  const Eigen::MatrixXd a = (t_s * Eigen::RowVector2d(0.1, 1.0 / 3)).array().sin(), nothing, b = a.col(0) / 7;
  write_table(folder.path("out.csv"), "# a note\nt_s,a1,a2,b", t_s, {&a, &nothing, &b});
  std::istringstream lines(folder.read("out.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "# a note");
  std::getline(lines, line);
  EXPECT_EQ(line, "t_s,a1,a2,b");
  for (Eigen::Index row = 0; row < t_s.size(); ++row) {
    ASSERT_TRUE(std::getline(lines, line)) << row;
    ASSERT_EQ(line, fmt::format("{},{},{},{}", t_s(row), a(row, 0), a(row, 1), b(row, 0)));
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST(OutputFile, LeavesNothingBehindWithoutCommit) {
  const TemporaryFolder folder;
  try {
    OutputFile file(folder.path("out.csv"));
    file.write(std::string(100000, 'x'));
    throw std::runtime_error("a later step fails");
  } catch (const std::runtime_error&) {
  }
  EXPECT_EQ(folder.files(), 0);
}

TEST(OutputFile, FollowsLinksAndKeepsPermissions) {
  const TemporaryFolder folder;
  (void)folder.write("real.csv", "old");
  std::filesystem::permissions(folder.path("real.csv"), std::filesystem::perms{0640});
  std::filesystem::create_symlink("real.csv", folder.path("link.csv"));
  write_file(folder.path("link.csv"), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path("link.csv")));
  EXPECT_EQ(folder.read("real.csv"), "new");
  EXPECT_EQ(std::filesystem::status(folder.path("real.csv")).permissions(), std::filesystem::perms{0640});
}

TEST(OutputFile, ReportsFullDevice) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  for (const std::size_t bytes : {std::size_t{1}, std::size_t{1} << 20}) {
    try {
      write_file("/dev/full", std::string(bytes, 'x'));
      FAIL() << "no error for " << bytes << " bytes";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("/dev/full"));
      EXPECT_THAT(error.problem(), HasSubstr("No space left"));
      EXPECT_THAT(error.mend(), HasSubstr("free some space"));
      EXPECT_EQ(error.code(), ExitCode::bad_input);
    }
  }
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST(OutputFile, KeepsTheOldFileWhenTheDiskRunsFull) {
  const TemporaryFolder folder;
  (void)folder.write("out.csv", "old");
  struct rlimit before {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const struct rlimit small = {4096, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(write_file(folder.path("out.csv"), std::string(100000, 'x')), Error);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(folder.read("out.csv"), "old");
  EXPECT_EQ(folder.files(), 1);
}

TEST(OutputFile, SaysThatTheFolderIsMissing) {
  const TemporaryFolder folder;
  try {
    OutputFile file(folder.path("no/such/out.csv"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no/such/out.csv"));
    EXPECT_THAT(error.mend(), HasSubstr("create the folder"));
  }
  EXPECT_THROW(OutputFile file(std::filesystem::temp_directory_path().string()), Error);
}

TEST(RefuseOverwrite, SeesTheSameFileThroughOtherSpellings) {
  const TemporaryFolder folder;
  const std::string input = folder.write("log.csv", "x");
  std::filesystem::create_symlink("log.csv", folder.path("link.csv"));
  for (const std::string& output : {input, folder.path("./log.csv"), folder.path("link.csv")}) {
    try {
      refuse_overwrite(output, {folder.path("other.csv"), input});
      FAIL() << output;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::usage);
      EXPECT_THAT(error.what(), HasSubstr("log.csv"));
    }
  }
  EXPECT_NO_THROW(refuse_overwrite(folder.path("new.csv"), {input}));
  EXPECT_NO_THROW(refuse_overwrite("", {input}));
}

}  // namespace
}  // namespace deltadyn
