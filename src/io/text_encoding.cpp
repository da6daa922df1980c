#include "deltadyn/io/text_encoding.hpp"

#include <string_view>
#include <utility>

namespace deltadyn {
namespace {

void append_utf8(std::string& text, char32_t code) {
  static constexpr char32_t kFirstByte[] = {0, 0xC0, 0xE0, 0xF0};
  const int more = code < 0x80 ? 0 : code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;  // bytes that follow the first
  text += static_cast<char>(kFirstByte[more] | (code >> (6 * more)));
  for (int k = more - 1; k >= 0; --k) text += static_cast<char>(0x80 | ((code >> (6 * k)) & 0x3F));
}

/// Excel's "Unicode text".
std::string from_utf16(std::string_view bytes, bool little) {
  std::string text;
  const auto unit = [&](std::size_t i) {
    const auto low = static_cast<unsigned char>(bytes[i]), high = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<char32_t>(little ? low | (high << 8) : high | (low << 8));
  };
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    char32_t code = unit(i);
    if (code >= 0xD800 && code < 0xDC00 && i + 3 < bytes.size()) {
      code = 0x10000 + ((code - 0xD800) << 10) + ((unit(i + 2) - 0xDC00) & 0x3FF);
      i += 2;
    }
    append_utf8(text, code);
  }
  return text;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

/// Windows-1252 is Latin-1 with other characters in the place of its second control codes; unused codes stay controls.
std::string from_windows_1252(std::string_view bytes) {
  static constexpr char16_t kUpper[32] = {0x20AC, 0x81,   0x201A, 0x192,  0x201E, 0x2026, 0x2020, 0x2021,
                                          0x2C6,  0x2030, 0x160,  0x2039, 0x152,  0x8D,   0x17D,  0x8F,
                                          0x90,   0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                          0x2DC,  0x2122, 0x161,  0x203A, 0x153,  0x9D,   0x17E,  0x178};
  std::string text;
  text.reserve(bytes.size() + bytes.size() / 64);
  for (const char c : bytes) {
    const auto code = static_cast<unsigned char>(c);
    append_utf8(text,
                code >= 0x80 && code < 0xA0 ? static_cast<char32_t>(kUpper[code - 0x80]) : static_cast<char32_t>(code));
  }
  return text;
}

}  // namespace

std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const unsigned first = byte(0), second = byte(1);
  if (first < 0x80) return text.empty() ? 0 : 1;
  const std::size_t length = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0u) != 0x80u) return 0;
  const bool bad = (first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
                   (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F);
  return bad ? 0 : length;
}

DecodedText decode_text(std::string bytes) {
  const std::string_view head(bytes);
  if (head.starts_with("\xFF\xFE")) return {from_utf16(head.substr(2), true), false};
  if (head.starts_with("\xFE\xFF")) return {from_utf16(head.substr(2), false), false};
  if (head.starts_with("\xEF\xBB\xBF")) bytes.erase(0, 3);
  if (is_utf8(bytes)) return {std::move(bytes), false};
  return {from_windows_1252(bytes), true};
}

}  // namespace deltadyn
