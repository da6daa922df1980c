#include "deltadyn/io/log_units.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>
#include <numbers>

#include "recording/field.hpp"

namespace deltadyn {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kDegree = kTurn / 360.0;
constexpr double kInch = 0.0254;
constexpr double kPoundForce = 4.4482216152605;
constexpr double kKilogramForce = 9.80665;

struct Entry {
  std::string_view texts;  ///< as normalised() leaves them, with blanks between
  LogUnit unit;
};

using enum Quantity;
using enum Dimension;

constexpr Entry kUnits[] = {
    {"rad", {position, angle, 1.0}},
    {"mrad", {position, angle, 1e-3}},
    {"deg degree degrees", {position, angle, kDegree}},
    {"rev revs turn turns", {position, angle, kTurn}},
    {"m", {position, length, 1.0}},
    {"cm", {position, length, 1e-2}},
    {"mm", {position, length, 1e-3}},
    {"um", {position, length, 1e-6}},
    {"inch in", {position, length, kInch}},
    {"cnt cnts count counts inc incr increments ink pulse pulses lsb", {position, counts, 1.0}},
    {"rad/s", {velocity, angle, 1.0}},
    {"mrad/s", {velocity, angle, 1e-3}},
    {"deg/s", {velocity, angle, kDegree}},
    {"deg/min", {velocity, angle, kDegree / 60.0}},
    {"rpm 1/min min-1 r/min u/min rev/min", {velocity, angle, kTurn / 60.0}},
    {"mrpm", {velocity, angle, 1e-3 * kTurn / 60.0}},
    {"rev/s rps turns/s", {velocity, angle, kTurn}},
    {"m/s", {velocity, length, 1.0}},
    {"cm/s", {velocity, length, 1e-2}},
    {"mm/s", {velocity, length, 1e-3}},
    {"m/min", {velocity, length, 1.0 / 60.0}},
    {"mm/min", {velocity, length, 1e-3 / 60.0}},
    {"in/s", {velocity, length, kInch}},
    {"cnt/s counts/s inc/s", {velocity, counts, 1.0}},
    {"rad/s2", {acceleration, angle, 1.0}},
    {"deg/s2", {acceleration, angle, kDegree}},
    {"rev/s2", {acceleration, angle, kTurn}},
    {"rpm/s", {acceleration, angle, kTurn / 60.0}},
    {"m/s2", {acceleration, length, 1.0}},
    {"mm/s2", {acceleration, length, 1e-3}},
    {"cnt/s2 counts/s2", {acceleration, counts, 1.0}},
    // "n/m" from N_m; a stiffness is no drive's channel
    {"nm n/m n-m", {torque, moment, 1.0}},
    {"mnm nmm", {torque, moment, 1e-3}},
    {"unm", {torque, moment, 1e-6}},
    {"cnm ncm", {torque, moment, 1e-2}},
    {"knm", {torque, moment, 1e3}},
    {"kgfm", {torque, moment, kKilogramForce}},
    {"kgfcm", {torque, moment, kKilogramForce * 1e-2}},
    {"lbfin lbin inlb", {torque, moment, kPoundForce* kInch}},
    {"lbfft lbft ftlb", {torque, moment, kPoundForce * 12.0 * kInch}},
    {"ozin ozfin", {torque, moment, kPoundForce / 16.0 * kInch}},
    {"n", {torque, force, 1.0}},
    {"mn", {torque, force, 1e-3}},
    {"kn", {torque, force, 1e3}},
    {"kgf", {torque, force, kKilogramForce}},
    {"lbf", {torque, force, kPoundForce}},
    {"a arms amp amps ampere", {torque, current, 1.0}},
    {"ma marms", {torque, current, 1e-3}},
    {"% pct percent %rated %ofrated", {torque, share_of_rated, 1e-2}},
    {"permille promille permil permilleofrated 01% 1/1000 0/00 o/oo", {torque, share_of_rated, 1e-3}},
    {"pu", {torque, share_of_rated, 1.0}},
};

/// Lower case, without brackets, blanks, products and powers; "_" as "/", "sec" as "s".
std::string normalised(std::string_view text) {
  std::string plain = forms::lower(text);
  std::erase_if(plain, [](char c) { return std::string_view(" []{}()*^.,").find(c) != std::string_view::npos; });
  std::ranges::replace(plain, '_', '/');
  static constexpr std::pair<std::string_view, std::string_view> kPlain[] = {
      {"\xE2\x80\xB0", "permille"},  // before the degree sign of Latin-1, whose byte it holds
      {"\xC2\xB0", "deg"},           // degree sign
      {"\xB0", "deg"},               // the same in Latin-1
      {"\xC2\xB2", "2"},             // superscript 2
      {"\xC2\xB5", "u"},             // micro
      {"\xCE\xBC", "u"},             // Greek mu
      {"\xC2\xB7", ""},              // middle dot
      {"\xE2\x8B\x85", ""},          // dot operator
      {"sec", "s"},
      {"/s/s", "/s2"},
      {"radians", "rad"}};
  for (const auto& [from, to] : kPlain) plain = forms::with_each(std::move(plain), from, to);
  return plain;
}

bool is_index(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, forms::is_digit);
}

bool known(std::string_view unit) {
  return !unit.empty() && !is_index(unit) && (log_unit(unit) || time_unit_s(unit));
}

std::string trimmed_right(std::string text) {
  while (!text.empty() && std::string_view(" \t_/,:;").find(text.back()) != std::string_view::npos) text.pop_back();
  return text;
}

}  // namespace

const char* word_of(Quantity quantity) {
  static constexpr std::array kWords = {"position", "velocity", "acceleration", "torque"};
  return kWords[static_cast<std::size_t>(quantity)];
}

std::optional<Quantity> quantity_of_word(std::string_view word) {
  for (const Quantity quantity : {position, velocity, acceleration, torque}) {
    if (word == word_of(quantity)) return quantity;
  }
  if (word == "force" || word == "current" || word == "effort") return torque;
  return std::nullopt;
}

std::optional<LogUnit> log_unit(std::string_view text) {
  const std::string plain = fmt::format(" {} ", normalised(text));
  for (const Entry& entry : kUnits) {
    if (fmt::format(" {} ", entry.texts).find(plain) != std::string::npos) return entry.unit;
  }
  return std::nullopt;
}

std::optional<double> time_unit_s(std::string_view text) {
  const std::string plain = normalised(text);
  if (plain == "s" || plain == "sonds" || plain == "sond") return 1.0;  // "sec" was shortened
  if (plain == "ms" || plain == "msec" || plain == "millisonds") return 1e-3;
  if (plain == "us" || plain == "microsonds") return 1e-6;
  if (plain == "ns" || plain == "nanosonds") return 1e-9;
  if (plain == "min" || plain == "minutes") return 60.0;
  if (plain == "filetime" || plain == "100ns") return 1e-7;
  return std::nullopt;
}

NameAndUnit split_unit(const std::string& column) {
  if (column.size() > 2 && std::string_view("])}").find(column.back()) != std::string_view::npos) {
    const char open = column.back() == ']' ? '[' : (column.back() == ')' ? '(' : '{');
    const auto at = column.rfind(open);
    if (at != std::string::npos && at > 0) {
      const std::string inside = column.substr(at + 1, column.size() - at - 2);
      // Words in brackets that we do not know may still be a unit, but numbers are an index and names belong to the
      // column.
      if (known(inside)) return {trimmed_right(column.substr(0, at)), inside};
    }
  }
  for (const std::string_view mark : {" / ", ", ", " in ", " "}) {
    const auto at = column.rfind(mark);
    if (at == std::string::npos || at == 0) continue;
    const std::string rest = column.substr(at + mark.size());
    const bool letter = rest.size() == 1 && mark == " ";  // "Drive A" is a name
    if (!letter && known(rest)) return {trimmed_right(column.substr(0, at)), rest};
  }
  // q1_rad_s2: the longest known end. One letter alone may as well be a name ("drive_a").
  for (auto at = column.find('_'); at != std::string::npos; at = column.find('_', at + 1)) {
    if (at == 0) continue;
    const std::string rest = column.substr(at + 1);
    const bool letter = rest.size() == 1 && rest != "m" && rest != "s" && rest != "A" && rest != "N";
    if (!letter && rest != "in" && rest != "turn" && known(rest)) return {column.substr(0, at), rest};
  }
  return {column, ""};
}

const char* units_of(Quantity quantity) {
  static constexpr std::array kUsual = {"rad, deg, turns, m, mm, cnt", "rad/s, deg/s, rpm, m/s, mm/s, cnt/s",
                                        "rad/s2, deg/s2, m/s2, mm/s2", "Nm, mNm, N, A, mA, %, permille"};
  return kUsual[static_cast<std::size_t>(quantity)];
}

}  // namespace deltadyn
