#pragma once

/// \file
/// Result files that are written whole or not at all.

#include <Eigen/Core>
#include <cstdio>
#include <fmt/format.h>
#include <string>
#include <string_view>
#include <vector>

namespace deltadyn {

/// A text or binary file under construction.
///
/// The bytes go to a temporary file in the folder of the result; commit() makes sure that every byte reached the disk
/// and then renames, so a reader sees the old file or the whole new one. Without commit() the destructor removes the
/// temporary file. A path that is not a regular file (a pipe, a terminal, /dev/null) is written to directly.
class OutputFile {
 public:
  /// Throws Error(bad_input) if the folder does not exist or is not writable.
  explicit OutputFile(std::string path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  /// Throws Error(bad_input) when the disk is full or the device fails.
  void write(std::string_view bytes);
  /// write(fmt::format(...)). A double printed with "{}" reads back exactly.
  template <class... Arguments>
  void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    write(fmt::format(format, std::forward<Arguments>(arguments)...));
  }
  /// Completes the file. Throws Error(bad_input) if any byte could not be written; then nothing is left behind.
  void commit();

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  void discard() noexcept;
  [[noreturn]] void fail(const char* doing, int error_number);

  std::string path_;       ///< as the user gave it, for messages
  std::string target_;     ///< with symbolic links followed
  std::string temporary_;  ///< empty when written directly
  std::FILE* file_ = nullptr;
};

/// Writes a whole file at once. Throws Error(bad_input).
void write_file(const std::string& path, std::string_view bytes);

/// Writes a table of numbers that read back exactly: the header, then in each row the time and that row of every block.
/// \param header  with what precedes it; without the end of its line
/// Throws Error(bad_input).
void write_table(const std::string& path, const std::string& header, const Eigen::VectorXd& t_s,
                 const std::vector<const Eigen::MatrixXd*>& blocks);

/// Throws Error(usage) if `output` is the same file as one of `inputs`, also through links or other spellings of the
/// path.
void refuse_overwrite(const std::string& output, const std::vector<std::string>& inputs);

}  // namespace deltadyn
