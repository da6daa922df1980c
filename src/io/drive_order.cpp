#include "drive_order.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fmt/format.h>
#include <iterator>
#include <set>
#include <string_view>

#include "header_words.hpp"
#include "recording/field.hpp"

namespace deltadyn {
namespace {

using Words = std::vector<std::string>;

/// The words of each name that not all of them share.
std::vector<Words> told_apart(const std::vector<std::string>& names) {
  std::vector<Words> words;
  for (const std::string& name : names) {
    words.push_back(words_of(name));
    std::ranges::sort(words.back());
  }
  Words shared = words.front();
  for (const Words& one : words) {
    Words both;
    std::ranges::set_intersection(shared, one, std::back_inserter(both));
    shared = std::move(both);
  }
  for (Words& one : words) {
    Words rest;
    std::ranges::set_difference(one, shared, std::back_inserter(rest));
    rest.erase(std::unique(rest.begin(), rest.end()), rest.end());
    one = std::move(rest);
  }
  return words;
}

bool is_number(const std::string& word) {
  return forms::is_digit(word.front());
}
bool is_letter(const std::string& word) {
  return word.size() == 1 && std::isalpha(static_cast<unsigned char>(word.front())) != 0;
}

/// The one number, or the one letter, of each name; nothing if a name has none or several, or two have the same.
std::vector<long> keys_of(const std::vector<Words>& words, bool (*is_key)(const std::string&)) {
  std::vector<long> keys;
  for (const Words& one : words) {
    if (std::ranges::count_if(one, is_key) != 1) return {};
    const std::string& word = *std::ranges::find_if(one, is_key);
    keys.push_back(is_number(word) ? std::strtol(word.c_str(), nullptr, 10) : static_cast<long>(word.front()));
  }
  return std::set<long>(keys.begin(), keys.end()).size() == keys.size() ? keys : std::vector<long>{};
}

/// Place of each key among them, from 1.
std::vector<long> ranks(const std::vector<long>& keys) {
  std::vector<long> result;
  for (const long key : keys) {
    result.push_back(1 + std::ranges::count_if(keys, [&](long other) { return other < key; }));
  }
  return result;
}

bool run_from(const std::vector<long>& keys, std::initializer_list<long> firsts) {
  const auto [low, high] = std::ranges::minmax_element(keys);
  const bool gapless = *high - *low + 1 == static_cast<long>(keys.size());
  return gapless && std::ranges::find(firsts, *low) != firsts.end();
}

/// Places by numbers or letters that run without a gap; nothing if there are none.
std::vector<long> running_places(const std::vector<std::string>& names) {
  if (names.size() == 1) return {1};
  const std::vector<Words> words = told_apart(names);
  const std::vector<long> numbers = keys_of(words, is_number);
  if (!numbers.empty()) return run_from(numbers, {0, 1}) ? ranks(numbers) : std::vector<long>{};
  const bool any_number =
      std::ranges::any_of(words, [](const Words& one) { return std::ranges::any_of(one, is_number); });
  const std::vector<long> letters = any_number ? std::vector<long>{} : keys_of(words, is_letter);
  return !letters.empty() && run_from(letters, {'a', 'u', 'x'}) ? ranks(letters) : std::vector<long>{};
}

/// Words for the drive that turns the tool. Letters alone are those of machine tools: C turns about z.
bool is_yaw_word(const std::string& word, bool letters) {
  static const std::set<std::string_view> kWords = {"yaw",       "rot",    "rotation", "rotary",  "tool",   "telescope",
                                                    "wrist",     "swivel", "spin",     "gripper", "flange", "werkzeug",
                                                    "drehachse", "dreh",   "psi",      "rz"};
  return kWords.count(word) > 0 || (letters && (word == "c" || word == "r"));
}

/// The names that speak of the tool's drive, of words that are not in all of them.
std::vector<std::size_t> yaw_names(const std::vector<std::string>& names, bool letters) {
  const std::vector<Words> words = told_apart(names);
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (std::ranges::any_of(words[k], [&](const std::string& word) { return is_yaw_word(word, letters); }))
      found.push_back(k);
  }
  return found;
}

std::vector<std::string> without(std::vector<std::string> names, std::size_t index) {
  names.erase(names.begin() + static_cast<std::ptrdiff_t>(index));
  return names;
}

/// The places of all, where one name is the last drive and the others have `places`.
std::vector<long> with_last(std::vector<long> places, std::size_t index) {
  places.insert(places.begin() + static_cast<std::ptrdiff_t>(index), static_cast<long>(places.size()) + 1);
  return places;
}

/// One name is the tool's drive, and the others run.
DriveOrder order_with_one_apart(const std::vector<std::string>& names) {
  std::vector<std::pair<std::size_t, std::vector<long>>> fitting;
  for (std::size_t k = 0; k < names.size(); ++k) {
    auto places = running_places(without(names, k));
    if (!places.empty()) fitting.emplace_back(k, with_last(std::move(places), k));
  }
  for (const bool letters : {false, true}) {
    const std::vector<std::size_t> yaw = yaw_names(names, letters);
    for (const auto& [k, places] : fitting) {
      if (yaw.size() == 1 && yaw.front() == k) return {places, ""};
    }
  }
  const bool yaw_is_named = yaw_names(names, false).size() == 1;  // then another one is no yaw
  if (fitting.size() != 1 || yaw_is_named) return {};
  return {fitting.front().second,
          fmt::format("'{}' is left over and taken as the last drive, that of the yaw", names[fitting.front().first])};
}

}  // namespace

DriveOrder order_by_names(const std::vector<std::string>& names, bool has_yaw) {
  const bool apart = has_yaw && names.size() > 2;
  const std::vector<std::size_t> yaw = apart ? yaw_names(names, false) : std::vector<std::size_t>{};
  const std::vector<long> places = running_places(names);
  const bool yaw_is_last = places.empty() || yaw.size() != 1 || places[yaw.front()] == static_cast<long>(names.size());
  if (!places.empty() && yaw_is_last) return {places, ""};
  if (apart) {
    if (DriveOrder order = order_with_one_apart(names); !order.places.empty()) return order;
  }
  if (!places.empty()) {
    // "yaw_1, arm_2, arm_3, arm_4": the word says more than the number.
    return {with_last(ranks(keys_of(told_apart(without(names, yaw.front())), is_number)), yaw.front()),
            fmt::format("by its number '{}' would be drive {}, by its name it is the yaw and taken as the last",
                        names[yaw.front()], places[yaw.front()])};
  }
  const std::vector<long> numbers = keys_of(told_apart(names), is_number);
  if (numbers.empty()) return {};
  return {ranks(numbers), "the numbers in the names do not run from 1 or 0; the drives are taken in their order"};
}

bool is_named_as_drive(const std::string& joint, long drive) {
  return words_of(joint) == Words{"drive", std::to_string(drive)};
}

}  // namespace deltadyn
