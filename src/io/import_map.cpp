/// \file
/// The map that an import writes for its user to mend, and what it says of columns that it leaves.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "deltadyn/io/import_log.hpp"

#include "header_words.hpp"

namespace deltadyn {

void LogImport::note_joints_beyond(Quantity quantity) {
  const ChannelMap* first = map_.find(quantity, 1);
  if (first == nullptr) return;
  const HeaderWords words = read_header_words(first->source, "");
  std::vector<std::string> taken, left;
  for (const RecordedChannel& channel : recording_.channels) {
    if (read_header_words(channel.name, "").pattern != words.pattern) continue;
    (is_taken(channel) ? taken : left).push_back("'" + channel.name + "'");
  }
  if (left.empty()) return;
  recording_.notes.push_back(fmt::format("{}: the robot has {} drive{}, so as {} {} {} taken; {} {} not used", recording_.file,
                                         robot_.drives(), robot_.drives() == 1 ? "" : "s", word_of(quantity),
                                         fmt::join(taken, ", "), taken.size() == 1 ? "was" : "were", fmt::join(left, ", "),
                                         left.size() == 1 ? "is" : "are"));
}

bool LogImport::is_taken(const RecordedChannel& channel) const {
  const auto named = [&](const std::string& source) {
    return source == channel.name || std::find(channel.aliases.begin(), channel.aliases.end(), source) != channel.aliases.end();
  };
  const bool time = std::any_of(recording_.timelines.begin(), recording_.timelines.end(),
                                [&](const Timeline& line) { return line.name == channel.name; });
  return time || named(map_.time_source) ||
         std::any_of(map_.channels.begin(), map_.channels.end(), [&](const ChannelMap& one) { return named(one.source); });
}

/// Lines of a map for the columns that were not taken, as comments: the user fills in what the names do not say.
std::string LogImport::map_of_the_rest() const {
  std::string text;
  for (const RecordedChannel& channel : recording_.channels) {
    if (channel.clock || is_taken(channel)) continue;
    const HeaderWords words = read_header_words(channel.name, channel.unit);
    ChannelMap one;
    one.source = channel.name;
    if (log_unit(words.unit)) one.unit = words.unit;
    std::optional<Quantity> quantity = words.quantity;
    if (!channel.quantity.empty()) quantity = quantity_of_word(channel.quantity);
    if (quantity) one.quantity = *quantity;
    std::string lines = to_toml(one);
    const auto replace = [&lines](const std::string& from, const std::string& to) {
      lines.replace(lines.find(from), from.size(), to);
    };
    replace("drive = 0", "drive = DRIVE");
    if (!quantity) replace(fmt::format("\"{}\"", word_of(one.quantity)), "QUANTITY");
    if (one.unit.empty()) lines += "unit = \"UNIT\"\n";
    lines.pop_back();
    for (auto at = lines.find('\n'); at != std::string::npos; at = lines.find('\n', at + 3)) lines.replace(at, 1, "\n# ");
    text += "\n# " + lines + "\n";
  }
  if (text.empty()) return text;
  return "\n# Columns that are not taken. To take one, uncomment its lines and fill in DRIVE (from 1), QUANTITY (\"position\", "
         "\"velocity\",\n# \"acceleration\", \"torque\") and UNIT (rad deg turns m mm cnt; rad/s deg/s rpm; Nm mNm N A mA % "
         "permille).\n" +
         text;
}

std::string LogImport::map_text() const {
  std::vector<std::string> remarks = {fmt::format("Guessed from {}: {}.", recording_.file, recording_.form)};
  for (const Open& open : open_) {
    remarks.push_back("STILL OPEN: " + open.what);
    std::string mend = "  " + open.mend;
    for (auto at = mend.find('\n'); at != std::string::npos; at = mend.find('\n', at + 3)) mend.replace(at, 1, "\n# ");
    remarks.push_back(mend);
  }
  remarks.push_back("Every column of the recording, with its range:");
  for (const RecordedChannel& channel : recording_.channels) {
    const auto known = !channel.values.array().isNaN();
    if (channel.text_line > 0 || !known.any()) {
      remarks.push_back(fmt::format("  \"{}\"  no numbers", channel.name));
      continue;
    }
    const double high = known.select(channel.values.array(), -HUGE_VAL).maxCoeff(),
                 low = known.select(channel.values.array(), HUGE_VAL).minCoeff();
    remarks.push_back(fmt::format("  \"{}\"{}  {:.6g} to {:.6g}", channel.name,
                                  channel.unit.empty() ? "" : " [" + channel.unit + "]", low, high));
  }
  return to_toml(map_, remarks) + map_of_the_rest();
}

}  // namespace deltadyn
