/// \file
/// The map that an import writes for its user to mend, and what it says of columns that it leaves.

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>
#include <utility>

#include "deltadyn/io/import_log.hpp"

#include "common_grid.hpp"
#include "guess_columns.hpp"
#include "header_words.hpp"
#include "recording/field.hpp"

namespace deltadyn {
namespace {

/// Constants of motor and encoder without which the unit does not come to SI, as lines to fill in.
std::vector<std::string> open_constants(const ChannelMap& channel, DriveKind kind) {
  const auto unit = log_unit(channel.unit);
  if (!unit) return {};
  std::vector<std::string> lines;
  const auto want = [&lines](const char* key, const char* what) {
    lines.push_back(fmt::format("# {} = NUMBER   # STILL OPEN: {}\n", key, what));
  };
  if (unit->dimension == Dimension::current && !channel.torque_constant)
    want("torque_constant_Nm_A", "of the motor [N m per A, as the current is given, peak or rms]");
  if (unit->dimension == Dimension::share_of_rated && !channel.rated_torque)
    want("rated_torque_Nm", "of the motor [N m, data sheet]");
  if (unit->dimension == Dimension::counts && !channel.counts_per_turn) want("counts_per_turn", "of the encoder");
  const bool of_motor = unit->dimension == Dimension::angle || unit->dimension == Dimension::counts ||
                        unit->dimension == Dimension::moment;
  if (kind == DriveKind::prismatic && of_motor && !channel.lead)
    want("lead_m_turn", "travel for a turn of the motor [m]");
  return lines;
}

}  // namespace

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
  recording_.notes.push_back(fmt::format("{}: the robot has {} drive{}, so as {} {} {} taken; {} {} not used",
                                         recording_.file, robot_.drives(), robot_.drives() == 1 ? "" : "s",
                                         word_of(quantity), fmt::join(taken, ", "), taken.size() == 1 ? "was" : "were",
                                         fmt::join(left, ", "), left.size() == 1 ? "is" : "are"));
}

bool LogImport::is_taken(const RecordedChannel& channel) const {
  const auto named = [&](const std::string& source) {
    return source == channel.name || std::ranges::find(channel.aliases, source) != channel.aliases.end();
  };
  const bool time =
      std::ranges::any_of(recording_.timelines, [&](const Timeline& line) { return line.name == channel.name; });
  return time || named(map_.time_source) ||
         std::ranges::any_of(map_.channels, [&](const ChannelMap& one) { return named(one.source); });
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
    const DriveKind kind = robot_.kind_of_drive(0);
    const std::string stem = channel.quantity.empty() ? words.stem : "/";
    if (one.unit.empty() && quantity) one.unit = customary_unit(stem, *quantity, kind);
    std::string lines = to_toml(one);
    const auto replace = [&lines](const std::string& from, const std::string& to) {
      lines.replace(lines.find(from), from.size(), to);
    };
    replace("drive = 0", "drive = DRIVE");
    if (!quantity) replace(fmt::format("\"{}\"", word_of(one.quantity)), "QUANTITY");
    if (one.unit.empty()) lines += "unit = \"UNIT\"\n";
    lines.pop_back();
    text += "\n# " + forms::with_each(lines, "\n", "\n# ") + "\n" +
            fmt::format("{}", fmt::join(open_constants(one, kind), ""));
  }
  if (text.empty()) return text;
  return "\n# Columns that are not taken. To take one, uncomment its lines and fill in DRIVE (from 1), QUANTITY "
         "(\"position\", \"velocity\",\n# \"acceleration\", \"torque\") and UNIT (rad deg turns m mm cnt; rad/s deg/s "
         "rpm; Nm mNm N A mA % permille).\n" +
         text;
}

/// The time as far as it is known: a live block where nothing is, so that one line is all that is to be filled in.
std::string LogImport::open_time() const {
  const bool known = std::ranges::all_of(recording_.timelines, [](const Timeline& t) { return t.t_s.size() > 0; });
  if (known) return "";
  if (map_.time_source.empty()) {
    return "\n[time]\n# source = NUMBER_OR_NAME   # STILL OPEN: the column of the time and its unit = \"ms\", or "
           "rate_hz = 1000\n";
  }
  return "# unit = \"UNIT\"   # STILL OPEN: s, ms, us, ns, min or filetime; or tick_s = seconds of a tick\n";
}

std::string mend_in_map(std::string mend, const std::string& map) {
  const std::string here = fmt::format("mend {} (what is open is marked there)", map);
  for (const auto& [from, to] : {std::pair<std::string, std::string>{
                                     "write a column map (delta-log import --map-out map.toml begins one)", here},
                                 {"write a column map (--map)", here + " and give it with --map"},
                                 {"a column map (delta-log import --map-out map.toml begins one)", map},
                                 {"in a column map (--map)", fmt::format("in {} and give that with --map", map)}}) {
    const auto at = mend.find(from);
    if (at == std::string::npos) continue;
    mend.replace(at, from.size(), to);
    return mend;
  }
  return mend;
}

std::string LogImport::map_text() const {
  std::vector<std::string> remarks = {fmt::format("Guessed from {}: {}.", recording_.file, recording_.form)};
  std::set<std::string> constants;
  for (const ChannelMap& channel : map_.channels) {
    for (const std::string& line : open_constants(channel, robot_.kind_of_drive(channel.drive - 1)))
      constants.insert(line.substr(2));
  }
  for (const std::string& constant : constants)
    remarks.push_back("STILL OPEN below: " + constant.substr(0, constant.find(' ')));
  for (const Error& open : open_) {
    remarks.push_back("STILL OPEN: " + open.problem());
    remarks.push_back("  " + forms::with_each(mend_in_map(open.mend(), "this map"), "\n", "\n# "));
  }
  remarks.push_back("Every column of the recording, with its range:");
  for (const RecordedChannel& channel : recording_.channels) {
    if (channel.text_line > 0 || channel.values.array().isNaN().all()) {
      remarks.push_back(fmt::format("  \"{}\"  no numbers", channel.name));
      continue;
    }
    const ValueRange range = range_of(channel.values);
    remarks.push_back(fmt::format("  \"{}\"{}  {:.6g} to {:.6g}", channel.name,
                                  channel.unit.empty() ? "" : " [" + channel.unit + "]", range.low, range.high));
  }
  ColumnMap head = map_;
  head.channels.clear();
  std::string text = to_toml(head, remarks) + open_time();
  for (const ChannelMap& channel : map_.channels) {
    text += "\n" + to_toml(channel) +
            fmt::format("{}", fmt::join(open_constants(channel, robot_.kind_of_drive(channel.drive - 1)), ""));
  }
  return text + map_of_the_rest();
}

}  // namespace deltadyn
