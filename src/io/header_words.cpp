#include "header_words.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <string_view>

#include "recording/field.hpp"

namespace deltadyn {
namespace {

using WordList = std::vector<std::string_view>;

/// Short words must stand alone; long ones may be part of a compound ("Istposition", "motortorque").
struct Vocabulary {
  WordList alone, within;
  [[nodiscard]] bool holds(std::string_view word) const {
    if (std::ranges::find(alone, word) != alone.end()) return true;
    return std::ranges::any_of(within,
                               [&](std::string_view part) { return word.find(part) != std::string_view::npos; });
  }
};

/// English and German words of drives, PLCs, ROS, UR and LinuxCNC for each quantity; pl, vl, il are Kollmorgen's loops.
const Vocabulary kQuantityWords[] = {
    {{"q", "pos", "phi", "theta", "ang", "pl", "lage", "enc", "qpos"},
     {"position", "angle", "winkel", "encoder", "lageist"}},
    {{"qd", "dq", "vel", "omega", "vl", "qdot", "qvel", "rpm", "spd"}, {"veloc", "speed", "geschwindig", "drehzahl"}},
    {{"qdd", "ddq", "acc", "qddot"}, {"accel", "beschleun"}},
    {{"tau", "trq", "tq", "iq", "il", "amps", "eff"},
     {"torque", "moment", "effort", "current", "strom", "kraft", "force"}}};
const Vocabulary kMeasured{{"act", "fb", "fbk", "meas", "ist", "real", "present"},
                           {"actual", "feedback", "measur", "istpos", "istwert", "lageist"}};
const Vocabulary kCommanded{{"cmd", "des", "ref", "set", "goal", "nominal", "qdes"},
                            {"command", "target", "soll", "setpoint", "demand", "desired", "refer"}};
/// "momentum" holds "moment"; a following error is a position of no drive.
const Vocabulary kExcluded{
    {"err", "tcp", "max", "min", "lag", "cart", "temp", "volt", "power", "std", "var", "window", "status", "mode",
     "bias"},
    {"error", "limit", "cartesian", "temperature", "voltage", "fehler", "schlepp", "following", "momentum"}};

/// The quantity of the words. Two of them: the unit decides, then "current position" (the present one) and like
/// adjectives give way to the noun behind them.
std::optional<Quantity> quantity_of(const std::vector<std::string>& words, const std::optional<LogUnit>& unit) {
  std::vector<Quantity> said;
  for (const std::string& word : words) {
    for (const Quantity quantity : {Quantity::acceleration, Quantity::velocity, Quantity::torque, Quantity::position}) {
      if (!kQuantityWords[static_cast<std::size_t>(quantity)].holds(word)) continue;
      if (std::ranges::find(said, quantity) == said.end()) said.push_back(quantity);
      break;
    }
  }
  if (unit) {
    const bool agrees = said.empty() || std::ranges::find(said, unit->quantity) != said.end();
    return agrees ? std::optional(unit->quantity) : std::nullopt;
  }
  if (said.empty()) return std::nullopt;
  return said.back();
}

}  // namespace

std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words;
  enum class Kind { mark, small, capital, digit };
  const auto kind_of = [](char c) {
    const auto u = static_cast<unsigned char>(c);
    if (forms::is_digit(c)) return Kind::digit;
    if (std::isupper(u) != 0) return Kind::capital;
    return std::isalpha(u) != 0 || u >= 0x80 ? Kind::small : Kind::mark;
  };
  Kind before = Kind::mark;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const Kind kind = kind_of(name[i]);
    // A new word begins at a change of kind, except after the first capital ("Act"), and before the last of several
    // ("TCPPose").
    bool begins = kind != before;
    if (before == Kind::capital && kind == Kind::small) begins = false;
    if (before == Kind::capital && kind == Kind::capital && i + 1 < name.size() && kind_of(name[i + 1]) == Kind::small)
      begins = true;
    if (kind != Kind::mark) {
      if (begins) words.emplace_back();
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(name[i])));
    }
    before = kind;
  }
  return words;
}

HeaderWords read_header_words(const std::string& column, const std::string& unit) {
  HeaderWords header;
  const NameAndUnit parts = split_unit(column);
  header.stem = parts.stem;
  header.unit = unit.empty() ? parts.unit : unit;
  const std::vector<std::string> words = words_of(header.stem);
  const auto any = [&](const Vocabulary& vocabulary) {
    return std::ranges::any_of(words, [&](const std::string& word) { return vocabulary.holds(word); });
  };
  const auto known = log_unit(header.unit);
  if (!known && time_unit_s(header.unit) && !header.unit.empty()) header.excluded = true;
  header.excluded = header.excluded || any(kExcluded);
  header.quantity = quantity_of(words, known);
  if (any(kMeasured)) header.origin = Origin::measured;
  if (any(kCommanded)) header.origin = Origin::commanded;
  for (const std::string& word : words) {
    const bool number = forms::is_digit(word.front());
    if (number) header.numbers.push_back(std::strtol(word.c_str(), nullptr, 10));
    header.pattern += (header.pattern.empty() ? "" : " ") + (number ? std::string("#") : word);
  }
  return header;
}

}  // namespace deltadyn
