#pragma once

/// \file
/// The forms of export: each recogniser has a file of its own, recognisers.cpp holds the list.

#include <optional>
#include <string>
#include <string_view>

#include "deltadyn/io/recording.hpp"

namespace deltadyn::forms {

/// A text export in memory.
struct TextFile {
  std::string path;
  std::string text;              ///< UTF-8 without byte-order mark
  bool is_windows_1252 = false;  ///< it was in Windows-1252
};

/// All of a file. Throws Error(bad_input): missing, unreadable, a folder.
/// \param instead_of_folder  what to give instead, for the message
[[nodiscard]] std::string read_bytes(const std::string& path, const char* instead_of_folder);

/// Throws Error(bad_input) if there is a zero byte: no text has one.
void refuse_zero_bytes(const std::string& path, std::string_view text);

/// Reads a text file as UTF-8. Throws Error(bad_input): missing, a folder, empty, not a text.
[[nodiscard]] TextFile read_text_file(const std::string& path);

/// Throws Error(bad_input) with the next step if the first bytes are those of a binary form that is not read.
void refuse_binary_form(const std::string& path, std::string_view head);

/// Each returns nothing if the text is not of its form, and throws Error(bad_input) if it is but is damaged.
[[nodiscard]] std::optional<Recording> read_twincat(const TextFile& file);
[[nodiscard]] std::optional<Recording> read_halscope(const TextFile& file);
/// Takes any text.
[[nodiscard]] Recording read_delimited(const TextFile& file);

/// Whether the file is an SQLite database, or a folder that holds one, and which.
[[nodiscard]] std::optional<std::string> rosbag2_database(const std::string& path);
[[nodiscard]] Recording read_rosbag2(const std::string& database, const std::string& wanted_topic);

}  // namespace deltadyn::forms
