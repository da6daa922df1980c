#include "guess_columns.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <map>
#include <tuple>

#include "deltadyn/signal/log_columns.hpp"

#include "drive_order.hpp"
#include "header_words.hpp"
#include "recorded_time.hpp"
#include "recording/field.hpp"

namespace deltadyn {
namespace {

struct Candidate {
  const RecordedChannel* channel;
  HeaderWords words;
};

/// Whether a unit comes to SI by a factor of its own: currents, shares of the rated torque and counts need a data
/// sheet.
bool is_direct(const std::string& unit) {
  const auto known = log_unit(unit);
  return known && known->dimension != Dimension::current && known->dimension != Dimension::share_of_rated &&
         known->dimension != Dimension::counts;
}

/// One column for each drive.
struct Set {
  std::vector<Candidate> of_drive;
  Origin origin = Origin::unstated;
  bool has_unit = true;
  bool direct = true;  ///< needs no constant of the motor or encoder to become SI
  std::string doubt;   ///< what the order of the drives rests on, if not on plain names

  [[nodiscard]] const Candidate& operator[](int drive) const { return of_drive[static_cast<std::size_t>(drive)]; }
};

/// Named as in a log of these tools, q1_rad, tau1_Nm: the number is the drive, and those beyond the robot's are not
/// used.
bool is_log_name(const Candidate& candidate) {
  const std::string& stem = candidate.words.stem;
  const auto digits = stem.find_first_of("0123456789");
  if (digits == std::string::npos || stem.find_first_not_of("0123456789", digits) != std::string::npos) return false;
  const std::string letters = stem.substr(0, digits);
  const bool known = letters == "q" || letters == "qd" || letters == "qdd" || letters == "tau";
  return known && candidate.channel->name.compare(0, stem.size() + 1, stem + "_") == 0;
}

/// Joints of one message: of many, those that are called as the drives of robot files (the passive joints are
/// published, too).
std::vector<Candidate> drives_among(const std::vector<Candidate>& members, int drives) {
  std::vector<Candidate> found;
  for (int drive = 1; drive <= drives; ++drive) {
    for (const Candidate& member : members) {
      if (is_named_as_drive(member.channel->joint, drive)) found.push_back(member);
    }
  }
  return found.size() == static_cast<std::size_t>(drives) ? found : members;
}

/// What the members of a group have in common, from the narrowest to the widest.
enum class Alike { words_and_unit, words, unit, quantity };

std::string key_of(const Candidate& candidate, Alike alike) {
  // The joints of one message belong together, whatever their names.
  const bool message = candidate.channel->place > 0;
  const std::string origin = std::to_string(static_cast<int>(candidate.words.origin));
  const std::string words = message ? "" : candidate.words.pattern;
  switch (alike) {
    case Alike::words_and_unit: return words + "|" + candidate.words.unit;
    case Alike::words: return words;
    case Alike::unit: return origin + "|" + candidate.words.unit;
    case Alike::quantity: return origin;
  }
  return "";
}

std::string names_of(const std::vector<Candidate>& members) {
  std::vector<std::string> names;
  for (const Candidate& member : members) names.push_back("'" + member.channel->name + "'");
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The guess for one quantity of one recording.
class Guess {
 public:
  Guess(const Recording& recording, const RobotDescription& robot, Quantity quantity, const MapDefaults& defaults)
      : recording_(recording), robot_(robot), quantity_(quantity), defaults_(defaults) {}

  std::optional<Error> run(ColumnMap& map, std::vector<std::string>& notes) const {
    const std::vector<Candidate> candidates = candidates_of(map);
    std::vector<Set> sets = sets_of(candidates);
    std::erase_if(sets, [&](const Set& set) { return contradicts(set, map); });
    if (sets.empty()) return missing(candidates);
    // Measured before unstated before commanded; among alike, those that state a unit, and of these a torque before a
    // current.
    const auto rank = [](const Set& set) { return std::tuple(static_cast<int>(set.origin), set.has_unit, set.direct); };
    std::ranges::stable_sort(sets, std::greater(), rank);
    const Set& best = sets.front();
    if (sets.size() > 1 && rank(sets[1]) == rank(best)) {
      return open(fmt::format("two sets of columns may be the {}: {} or {}", word_of(quantity_),
                              names_of(best.of_drive), names_of(sets[1].of_drive)),
                  "say which in a column map (delta-log import --map-out map.toml begins one)\n" +
                      example(best.of_drive[0].channel->name, unit_of(best.of_drive[0], 0), 0));
    }
    if (best.origin == Origin::commanded && quantity_ != Quantity::torque) {
      return open(fmt::format("only a commanded {} is in the file: {}", word_of(quantity_), names_of(best.of_drive)),
                  "record the measured one; to take the command all the same, say so in a column map\n" +
                      example(best.of_drive[0].channel->name, unit_of(best.of_drive[0], 0), 0));
    }
    if (!best.has_unit) return without_unit(best);
    for (int drive = 0; drive < robot_.drives(); ++drive)
      map.channels.push_back({.drive = drive + 1,
                              .quantity = quantity_,
                              .source = best[drive].channel->name,
                              .unit = unit_of(best[drive], drive)});
    const std::string note = recording_.file + ": " + best.doubt;
    if (!best.doubt.empty() && std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
    return std::nullopt;
  }

 private:
  [[nodiscard]] Error open(const std::string& what, const std::string& mend) const {
    return {what, recording_.file, mend};
  }

  /// A flag wins over the header, the header over what is custom, and messages of fixed meaning are SI.
  [[nodiscard]] std::string unit_of(const Candidate& candidate, int drive) const {
    if (const std::string flag = defaults_.unit(quantity_); !flag.empty()) return flag;
    if (log_unit(candidate.words.unit)) return candidate.words.unit;
    const std::string stem = candidate.channel->quantity.empty() ? candidate.words.stem : "/";
    return customary_unit(stem, quantity_, robot_.kind_of_drive(drive));
  }

  [[nodiscard]] std::vector<Candidate> candidates_of(const ColumnMap& map) const {
    std::vector<Candidate> found;
    for (const RecordedChannel& channel : recording_.channels) {
      if (channel.clock || channel.name == map.time_source ||
          channel.name == recording_.timelines[channel.timeline].name)
        continue;
      Candidate candidate{&channel, read_header_words(channel.name, channel.unit)};
      if (!channel.quantity.empty()) {
        candidate.words.quantity = quantity_of_word(channel.quantity);
        candidate.words.excluded = false;
      }
      if (!candidate.words.excluded && candidate.words.quantity == quantity_) found.push_back(std::move(candidate));
    }
    return found;
  }

  /// Drive of each member; what of it is a conclusion, or the bare order of the message, is said in `set.doubt`.
  std::vector<long> places_of(const std::vector<Candidate>& members, Set& set) const {
    std::vector<std::string> names;
    bool message = true;
    for (const Candidate& member : members) {
      message = message && member.channel->place > 0;
      names.push_back(member.channel->joint.empty() ? member.words.stem : member.channel->joint);
    }
    const DriveOrder order = order_by_names(names, robot_.telescope.has_value());
    if (!message) return order.doubt.empty() ? order.places : std::vector<long>{};
    std::vector<long> places = order.places;
    std::string why = order.doubt;
    if (places.empty()) {
      for (const Candidate& member : members) places.push_back(member.channel->place);
      why = "their names tell no order, so that of the message is taken";
    }
    if (why.empty()) return places;
    std::vector<std::string> taken;
    for (std::size_t k = 0; k < names.size(); ++k)
      taken.push_back(fmt::format("'{}' as drive {}", names[k], places[k]));
    set.doubt = fmt::format(
        "the joints {}: {}; check it, and where it is wrong set drive = in a column map (--map-out writes one)",
        fmt::join(taken, ", "), why);
    return places;
  }

  /// The set that a group of like-named columns makes, if it has one column for every drive and none beyond: of six
  /// joints and four drives nobody but the user knows which are meant.
  [[nodiscard]] std::optional<Set> set_of(std::vector<Candidate> members) const {
    const auto drives = static_cast<std::size_t>(robot_.drives());
    Set set;
    std::vector<long> places;
    if (members.size() > drives) members = drives_among(members, robot_.drives());
    if (std::ranges::all_of(members, is_log_name)) {
      for (const Candidate& member : members) places.push_back(member.words.numbers.back());
    } else if (members.size() != drives) {
      return std::nullopt;
    } else {
      places = drives == 1 ? std::vector<long>{1} : places_of(members, set);
    }
    set.of_drive.resize(drives, {nullptr, {}});
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (places[k] >= 1 && places[k] <= robot_.drives())
        set.of_drive[static_cast<std::size_t>(places[k] - 1)] = members[k];
    }
    for (int drive = 0; drive < robot_.drives(); ++drive) {
      if (set[drive].channel == nullptr) return std::nullopt;
      set.origin = set[drive].words.origin;
      const std::string unit = unit_of(set[drive], drive);
      set.has_unit = set.has_unit && !unit.empty();
      set.direct = set.direct && is_direct(unit);
    }
    return set;
  }

  /// Like-named columns: first those with one unit, and where that leaves no whole set (the fourth drive in other
  /// units), all. Where no names are alike (x axis, y axis, z axis; limb 1, limb 2, limb 3, yaw), their differences may
  /// still tell the drives.
  [[nodiscard]] std::vector<Set> sets_of(const std::vector<Candidate>& candidates) const {
    std::vector<Set> sets;
    for (const Alike alike : {Alike::words_and_unit, Alike::words, Alike::unit, Alike::quantity}) {
      if (robot_.drives() == 1 && alike > Alike::words) break;  // there only the names can tell which is meant
      std::map<std::string, std::vector<Candidate>> groups;
      for (const Candidate& candidate : candidates) groups[key_of(candidate, alike)].push_back(candidate);
      for (const auto& [key, members] : groups) {
        if (auto set = set_of(members)) sets.push_back(*std::move(set));
      }
      if (!sets.empty()) break;
    }
    return sets;
  }

  /// On a robot of one drive its number is not asked for, but position and torque of one drive do not carry different
  /// ones.
  [[nodiscard]] bool contradicts(const Set& set, const ColumnMap& map) const {
    const ChannelMap* position = map.find(Quantity::position, 1);
    if (robot_.drives() != 1 || position == nullptr) return false;
    const std::vector<long> theirs = read_header_words(position->source, "").numbers;
    const std::vector<long>& ours = set.of_drive[0].words.numbers;
    return !theirs.empty() && !ours.empty() && std::ranges::find_first_of(ours, theirs) == ours.end();
  }

  /// The lines of a map that would answer the question.
  [[nodiscard]] std::string example(const std::string& source, const std::string& unit, int drive) const {
    std::string text = to_toml(ChannelMap{.drive = drive + 1, .quantity = quantity_, .source = source, .unit = unit});
    text.pop_back();
    return "    " + forms::with_each(std::move(text), "\n", "\n    ");
  }

  [[nodiscard]] std::string si_unit(int drive) const {
    return customary_unit("/", quantity_, robot_.kind_of_drive(drive));
  }

  [[nodiscard]] Error missing(const std::vector<Candidate>& candidates) const {
    std::string what = fmt::format("the column {} is missing: no column is known as the {} of drive 1; the file has {}",
                                   contract_name(robot_, 0, quantity_), word_of(quantity_), list_channels(recording_));
    if (!candidates.empty()) {
      what = fmt::format(
          "the {} of the robot's {} drive{} cannot be told from the names: {} may be meant; the file has {}",
          word_of(quantity_), robot_.drives(), robot_.drives() == 1 ? "" : "s", names_of(candidates),
          list_channels(recording_));
    }
    return open(
        what,
        "write a column map (delta-log import --map-out map.toml begins one) and give it with --map; it needs for "
        "each drive\n" +
            example("NAME", si_unit(0), 0));
  }

  [[nodiscard]] Error without_unit(const Set& set) const {
    int drive = 0;
    while (!unit_of(set[drive], drive).empty()) ++drive;
    const std::string& name = set[drive].channel->name;
    const std::string wanted = contract_name(robot_, drive, quantity_);
    const bool angle = quantity_ == Quantity::position && robot_.kind_of_drive(drive) == DriveKind::revolute;
    return open(
        fmt::format(
            "the column {} is missing; the file has {}, which looks like the {} of drive {}, but states no unit",
            wanted, name, word_of(quantity_), drive + 1),
        fmt::format(
            "name the column {}{}; or give delta-log import --{}-unit, one of {}; or write a column map (--map)\n{}",
            wanted, angle ? fmt::format(" or q{}_deg", drive + 1) : "", word_of(quantity_), units_of(quantity_),
            example(name, si_unit(drive), drive)));
  }

  const Recording& recording_;
  const RobotDescription& robot_;
  const Quantity quantity_;
  const MapDefaults& defaults_;
};

}  // namespace

std::string contract_name(const RobotDescription& robot, int drive, Quantity quantity) {
  static constexpr std::string DriveColumns::*kColumns[] = {&DriveColumns::q, &DriveColumns::qd, &DriveColumns::qdd,
                                                            &DriveColumns::tau};
  return drive_columns(robot, drive).*kColumns[static_cast<std::size_t>(quantity)];
}

std::string customary_unit(const std::string& stem, Quantity quantity, DriveKind kind) {
  const bool turns = kind == DriveKind::revolute;
  static constexpr const char* kCustoms[] = {
      "/",          "field.",      "actual_q_",       "target_q_",       "actual_qd_",
      "target_qd_", "target_qdd_", "actual_current_", "target_current_", "target_moment_"};
  if (std::ranges::none_of(kCustoms, [&](const char* begin) { return stem.starts_with(begin); })) return "";
  switch (quantity) {
    case Quantity::position: return turns ? "rad" : "m";
    case Quantity::velocity: return turns ? "rad/s" : "m/s";
    case Quantity::acceleration: return turns ? "rad/s2" : "m/s2";
    case Quantity::torque: return stem.find("current") != std::string::npos ? "A" : (turns ? "Nm" : "N");
  }
  return "";
}

std::optional<Error> guess_channels(const Recording& recording, const RobotDescription& robot, Quantity quantity,
                                    const MapDefaults& defaults, ColumnMap& map, std::vector<std::string>& notes) {
  return Guess(recording, robot, quantity, defaults).run(map, notes);
}

}  // namespace deltadyn
