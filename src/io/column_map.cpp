#include "deltadyn/io/column_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <iterator>
#include <numbers>

#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include "deltadyn/io/text_encoding.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

constexpr std::array kTimeKeys = {"source", "unit", "rate_hz", "tick_s"};
constexpr std::array kChannelKeys = {"drive",
                                     "quantity",
                                     "source",
                                     "unit",
                                     "scale",
                                     "offset",
                                     "sign",
                                     "gear_ratio",
                                     "torque_constant_Nm_A",
                                     "rated_torque_Nm",
                                     "counts_per_turn",
                                     "lead_m_turn",
                                     "wrap",
                                     "delay_s"};
constexpr std::array kTopKeys = {"time", "channel", "topic"};

/// Constants that must be positive.
constexpr std::pair<const char*, std::optional<double> ChannelMap::*> kConstants[] = {
    {"gear_ratio", &ChannelMap::gear_ratio},
    {"torque_constant_Nm_A", &ChannelMap::torque_constant},
    {"rated_torque_Nm", &ChannelMap::rated_torque},
    {"counts_per_turn", &ChannelMap::counts_per_turn},
    {"lead_m_turn", &ChannelMap::lead},
    {"wrap", &ChannelMap::wrap}};

/// Reads the tables of one map file and says where something is wrong.
class MapReader {
 public:
  MapReader(std::string path, const RobotDescription& robot) : path_(std::move(path)), robot_(robot) {}

  ColumnMap read() {
    const toml::table table = parse();
    refuse_unknown(table, kTopKeys, "the map");
    ColumnMap map;
    map.file = path_;
    if (const auto* topic = table.get("topic")) map.topic = text(*topic, "topic");
    if (const auto* node = table.get("time")) read_time(table_of(*node, "time"), map);
    if (const auto* node = table.get("channel")) {
      const toml::array* channels = node->as_array();
      if (channels == nullptr) fail(*node, "channel is no list of tables", "write [[channel]] above each channel");
      for (const toml::node& entry : *channels) map.channels.push_back(read_channel(table_of(entry, "channel"), map));
    }
    if (map.channels.empty() && table.get("time") == nullptr && map.topic.empty()) {
      throw Error("the map holds neither [time] nor a [[channel]]", path_,
                  "delta-log import FILE --robot ROBOT --map-out MAP writes one to begin with");
    }
    return map;
  }

 private:
  toml::table parse() const {
    std::ifstream file(path_, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    std::error_code ignored;
    if (!file.is_open() || file.bad() || std::filesystem::is_directory(path_, ignored)) {
      throw Error("cannot read the map", path_, "check the path and the permissions");
    }
    try {
      // An editor may have saved it in the computer's own characters.
      return toml::parse(decode_text(bytes).text, path_);
    } catch (const toml::parse_error& e) {
      const auto line = e.source().begin.line;
      throw Error(std::string(e.description()), line > 0 ? fmt::format("{}, line {}", path_, line) : path_,
                  line > 0 ? "the map is TOML: key = value, texts in quotes, [[channel]] above each channel"
                           : "check the path and the permissions");
    }
  }

  [[noreturn]] void fail(const toml::node& node, const std::string& what, const std::string& mend) const {
    throw Error(what, fmt::format("{}, line {}", path_, node.source().begin.line), mend);
  }

  const toml::table& table_of(const toml::node& node, const char* name) const {
    const toml::table* table = node.as_table();
    if (table == nullptr)
      fail(node, fmt::format("{} is no table", name), fmt::format("write [{}] and its keys below it", name));
    return *table;
  }

  template <std::size_t N>
  void refuse_unknown(const toml::table& table, const std::array<const char*, N>& known, const char* where) const {
    for (const auto& [key, node] : table) {
      const std::string_view name = key.str();
      if (std::ranges::find(known, name) == known.end()) {
        fail(node, fmt::format("the key '{}' is not known in {}", name, where),
             fmt::format("the keys are {}", fmt::join(known, ", ")));
      }
    }
  }

  std::string text(const toml::node& node, const char* key) const {
    const auto value = node.value<std::string>();
    if (!value) fail(node, fmt::format("{} is no text", key), fmt::format("write {} = \"...\" in quotes", key));
    return *value;
  }
  double number(const toml::node& node, const std::string& key) const {
    const auto value = node.value<double>();
    if (!value || !std::isfinite(*value))
      fail(node, fmt::format("{} is no number", key), fmt::format("write {} = 1.0 without quotes", key));
    return *value;
  }
  std::optional<double> positive(const toml::table& table, const char* key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return std::nullopt;
    const double value = number(*node, key);
    if (value <= 0)
      fail(*node, fmt::format("{} = {} is not positive", key, value), "a direction is turned by sign = -1");
    return value;
  }

  void read_time(const toml::table& table, ColumnMap& map) const {
    refuse_unknown(table, kTimeKeys, "[time]");
    if (const auto* node = table.get("source")) map.time_source = source_of(*node);
    if (const auto* node = table.get("unit")) {
      map.time_unit = text(*node, "unit");
      if (!time_unit_s(map.time_unit)) {
        fail(*node, fmt::format("'{}' is no known unit of time", map.time_unit),
             "give s, ms, us, ns, min, filetime, or tick_s = seconds of a tick");
      }
    }
    map.rate_hz = positive(table, "rate_hz");
    map.tick_s = positive(table, "tick_s");
    if (map.rate_hz && !map.time_source.empty()) {
      fail(*table.get("rate_hz"), "the map gives a time column and a rate", "leave one of them out");
    }
  }

  /// A name, or the number of the column from 1.
  std::string source_of(const toml::node& node) const {
    if (const auto number = node.value_exact<std::int64_t>()) return fmt::format("column{}", *number);
    return text(node, "source");
  }

  ChannelMap read_channel(const toml::table& table, const ColumnMap& map) const {
    refuse_unknown(table, kChannelKeys, "[[channel]]");
    for (const char* key : {"drive", "quantity", "source"}) {
      if (table.get(key) == nullptr)
        fail(table, fmt::format("this channel has no {}", key), "each [[channel]] needs drive, quantity and source");
    }
    ChannelMap channel;
    channel.line = static_cast<long>(table.source().begin.line);
    const auto drive = table.get("drive")->value_exact<std::int64_t>();
    if (!drive || *drive < 1 || *drive > robot_.drives()) {
      fail(*table.get("drive"), "this is no drive of the robot",
           fmt::format("the drives of {} are 1 to {}", robot_.type, robot_.drives()));
    }
    channel.drive = static_cast<int>(*drive);
    const std::string word = text(*table.get("quantity"), "quantity");
    const auto quantity = quantity_of_word(word);
    if (!quantity)
      fail(*table.get("quantity"), fmt::format("'{}' is no known quantity", word),
           "give position, velocity, acceleration or torque");
    channel.quantity = *quantity;
    channel.source = source_of(*table.get("source"));
    if (map.find(channel.quantity, channel.drive) != nullptr) {
      fail(table, fmt::format("the {} of drive {} is named twice", word_of(channel.quantity), channel.drive),
           "remove one of the two");
    }
    if (const auto* node = table.get("unit")) read_unit(*node, channel);
    read_numbers(table, channel);
    return channel;
  }

  void read_unit(const toml::node& node, ChannelMap& channel) const {
    channel.unit = text(node, "unit");
    const auto unit = log_unit(channel.unit);
    if (!unit || unit->quantity != channel.quantity) {
      // "rad" for a velocity is a slip, not another way of writing.
      fail(node, fmt::format("'{}' is no known unit of a {}", channel.unit, word_of(channel.quantity)),
           fmt::format("give one of {}", units_of(channel.quantity)));
    }
  }

  void read_numbers(const toml::table& table, ChannelMap& channel) const {
    if (const auto* node = table.get("scale")) channel.scale = number(*node, "scale");
    if (const auto* node = table.get("offset")) channel.offset = number(*node, "offset");
    if (const auto* node = table.get("delay_s")) channel.delay_s = number(*node, "delay_s");
    if (const auto* node = table.get("sign")) {
      channel.sign = number(*node, "sign");
      if (std::abs(channel.sign) != 1.0)
        fail(*node, "sign is neither 1 nor -1", "factors are given by scale or gear_ratio");
    }
    if (channel.scale == 0)
      fail(*table.get("scale"), "scale = 0 leaves nothing of the channel", "give the factor to the unit");
    for (const auto& [key, constant] : kConstants) channel.*constant = positive(table, key);
  }

  std::string path_;
  const RobotDescription& robot_;
};

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      result += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      result += c;
    }
  }
  return result + '"';
}

/// Turns, of which there are 2 pi rad, into metres where a spindle or belt makes them so.
double metres_per_rad(const ChannelMap& channel, const std::string& where) {
  if (!channel.lead) {
    throw Error(fmt::format("the unit {} is of a motor that turns, but drive {} of the robot slides", channel.unit,
                            channel.drive),
                where,
                "give its travel per turn: delta-log import --lead-m-turn, or lead_m_turn in a column map (--map)");
  }
  return *channel.lead / (2.0 * std::numbers::pi);
}

[[noreturn]] void refuse_constant(const std::string& what, const std::string& flag, const std::string& key,
                                  const std::string& where) {
  throw Error(what, where, fmt::format("give delta-log import {}, or {} in a column map (--map)", flag, key));
}

double torque_factor(const ChannelMap& channel, const LogUnit& unit, bool turns, const std::string& where) {
  const double gear = channel.gear_ratio.value_or(1.0);
  const auto through_spindle = [&] { return turns ? 1.0 : 1.0 / metres_per_rad(channel, where); };
  const double at_motor = turns || !channel.lead ? 1.0 : through_spindle();
  switch (unit.dimension) {
    case Dimension::moment: return unit.factor * gear * through_spindle();
    case Dimension::force:
      if (turns) {
        throw Error(fmt::format("the unit {} is a force, but drive {} of the robot turns", channel.unit, channel.drive),
                    where, "give the robot file that fits the recording, or correct the unit");
      }
      return unit.factor * gear;
    case Dimension::current:
      if (!channel.torque_constant) {
        refuse_constant(fmt::format("the current [{}] needs a torque constant to become a torque", channel.unit),
                        "--torque-constant N m per A (as the current is given, peak or rms)", "torque_constant_Nm_A",
                        where);
      }
      return unit.factor * *channel.torque_constant * gear * at_motor;
    case Dimension::share_of_rated:
      if (!channel.rated_torque) {
        refuse_constant(fmt::format("a torque in {} of the rated torque needs that rated torque", channel.unit),
                        "--rated-torque N m (from the motor's data sheet)", "rated_torque_Nm", where);
      }
      return unit.factor * *channel.rated_torque * gear * at_motor;
    default: return unit.factor;
  }
}

}  // namespace

const ChannelMap* ColumnMap::find(Quantity quantity, int drive) const {
  for (const ChannelMap& channel : channels) {
    if (channel.quantity == quantity && channel.drive == drive) return &channel;
  }
  return nullptr;
}

bool ColumnMap::has(Quantity quantity) const {
  return std::ranges::find(channels, quantity, &ChannelMap::quantity) != channels.end();
}

void MapDefaults::validate(int drives) const {
  const auto demand = [&](const std::vector<double>& values, const char* flag) {
    if (values.size() > 1 && values.size() != static_cast<std::size_t>(drives)) {
      throw Error(fmt::format("{} has {} values", flag, values.size()), "",
                  fmt::format("give one, or {} separated by commas", drives), ExitCode::usage);
    }
    for (const double value : values) {
      if (!(value > 0) || !std::isfinite(value)) {
        throw Error(fmt::format("{} {} is not positive", flag, value), "",
                    "a direction is turned by sign = -1 in the column map", ExitCode::usage);
      }
    }
  };
  demand(gear_ratio, "--gear-ratio");
  demand(torque_constant, "--torque-constant");
  demand(rated_torque, "--rated-torque");
  demand(counts_per_turn, "--counts-per-turn");
  demand(lead, "--lead-m-turn");
  if (rate_hz) demand({*rate_hz}, "--rate-hz");
  for (const Quantity quantity : {Quantity::position, Quantity::velocity, Quantity::torque}) {
    const auto known = log_unit(unit(quantity));
    if (unit(quantity).empty() || (known && known->quantity == quantity)) continue;
    throw Error(
        fmt::format("--{}-unit {} is no known unit of a {}", word_of(quantity), unit(quantity), word_of(quantity)), "",
        fmt::format("give one of {}", units_of(quantity)), ExitCode::usage);
  }
  if (!time_unit.empty() && !time_unit_s(time_unit)) {
    throw Error(fmt::format("--time-unit {} is no known unit", time_unit), "", "give s, ms, us, ns, min or filetime",
                ExitCode::usage);
  }
}

std::string MapDefaults::unit(Quantity quantity) const {
  const std::string units[] = {position_unit, velocity_unit, "", torque_unit};
  return units[static_cast<std::size_t>(quantity)];
}

void MapDefaults::apply(ColumnMap& map) const {
  const auto set = [](const std::vector<double>& values, int drive, std::optional<double>& to) {
    if (!values.empty()) to = values[values.size() == 1 ? 0 : static_cast<std::size_t>(drive - 1)];
  };
  for (ChannelMap& channel : map.channels) {
    set(gear_ratio, channel.drive, channel.gear_ratio);
    set(lead, channel.drive, channel.lead);
    if (channel.quantity == Quantity::torque) {
      set(torque_constant, channel.drive, channel.torque_constant);
      set(rated_torque, channel.drive, channel.rated_torque);
    } else {
      set(counts_per_turn, channel.drive, channel.counts_per_turn);
    }
    if (const std::string given = unit(channel.quantity); !given.empty()) channel.unit = given;
  }
}

ColumnMap read_column_map(const std::string& path, const RobotDescription& robot) {
  return MapReader(path, robot).read();
}

std::string to_toml(const ChannelMap& channel) {
  std::string text = fmt::format("[[channel]]\ndrive = {}\nquantity = \"{}\"\nsource = {}\n", channel.drive,
                                 word_of(channel.quantity), quoted(channel.source));
  if (!channel.unit.empty()) text += fmt::format("unit = {}\n", quoted(channel.unit));
  if (channel.scale != 1) text += fmt::format("scale = {}\n", channel.scale);
  if (channel.offset != 0) text += fmt::format("offset = {}\n", channel.offset);
  if (channel.sign != 1) text += fmt::format("sign = {}\n", channel.sign);
  for (const auto& [key, constant] : kConstants) {
    if (channel.*constant) text += fmt::format("{} = {}\n", key, *(channel.*constant));
  }
  if (channel.delay_s != 0) text += fmt::format("delay_s = {}\n", channel.delay_s);
  return text;
}

std::string to_toml(const ColumnMap& map, const std::vector<std::string>& remarks) {
  std::string text =
      "# Column map of delta-log import (--map of it and of all tools that read logs).\n"
      "# A channel at the drive in SI units is sign * (scale * recorded + offset) [unit], through its constants and "
      "its gear.\n"
      "# Further keys of a channel: scale, offset, sign (1 or -1), gear_ratio (motor turns per drive turn, where the "
      "recording is of\n"
      "# the motor), torque_constant_Nm_A (unit A), rated_torque_Nm (unit % or permille), counts_per_turn (unit cnt), "
      "lead_m_turn\n"
      "# (motors of sliding drives), wrap (the number begins again after this much), delay_s (the value is older than "
      "its stamp).\n";
  for (const std::string& remark : remarks) text += "# " + remark + "\n";
  if (!map.topic.empty()) text += fmt::format("\ntopic = {}\n", quoted(map.topic));
  if (!map.time_source.empty() || map.rate_hz) {
    text += "\n[time]\n";
    if (!map.time_source.empty()) text += fmt::format("source = {}\n", quoted(map.time_source));
    if (!map.time_unit.empty()) text += fmt::format("unit = {}\n", quoted(map.time_unit));
    if (map.rate_hz) text += fmt::format("rate_hz = {}\n", *map.rate_hz);
    if (map.tick_s) text += fmt::format("tick_s = {}\n", *map.tick_s);
  }
  for (const ChannelMap& channel : map.channels) text += "\n" + to_toml(channel);
  return text;
}

double si_factor(const ChannelMap& channel, DriveKind kind, const std::string& where) {
  const auto unit = log_unit(channel.unit);
  if (!unit || unit->quantity != channel.quantity) {
    throw Error(fmt::format("'{}' is no known unit of a {}", channel.unit, word_of(channel.quantity)), where,
                fmt::format("give one of {} in the column map", units_of(channel.quantity)));
  }
  const bool turns = kind == DriveKind::revolute;
  if (channel.quantity == Quantity::torque) return torque_factor(channel, *unit, turns, where);
  double factor = unit->factor / channel.gear_ratio.value_or(1.0);
  switch (unit->dimension) {
    case Dimension::length:
      if (turns) {
        throw Error(fmt::format("the unit {} is for a prismatic drive, but drive {} of the robot is revolute",
                                channel.unit, channel.drive),
                    where, "give the robot file that fits the recording, or correct the unit");
      }
      return factor;
    case Dimension::counts:
      if (!channel.counts_per_turn) {
        refuse_constant("encoder counts need the number of counts in a turn", "--counts-per-turn N", "counts_per_turn",
                        where);
      }
      factor *= 2.0 * std::numbers::pi / *channel.counts_per_turn;
      break;
    default: break;
  }
  return turns ? factor : factor * metres_per_rad(channel, where);
}

}  // namespace deltadyn
