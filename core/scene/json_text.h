// What the parser and the reader know of JSON's texts and numbers.
#pragma once

#include <string>
#include <string_view>

namespace ivory::json_text {

inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

// In well-formed UTF-8.
[[nodiscard]] inline bool starts_character(char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
}

[[nodiscard]] inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

[[nodiscard]] inline bool is_plain_in_text(char c) {
    return c != '"' && c != '\\' && static_cast<unsigned char>(c) >= 0x20;
}

[[nodiscard]] unsigned hexadecimal(std::string_view digits);

[[nodiscard]] inline bool is_high_surrogate(unsigned unit) {
    return unit >= 0xD800 && unit < 0xDC00;
}
[[nodiscard]] inline bool is_low_surrogate(unsigned unit) {
    return unit >= 0xDC00 && unit < 0xE000;
}

// What the text whose quote stands at `offset` stands for: a part of `json`, or of `buffer` where
// there are escapes. Of JSON that has been found right.
[[nodiscard]] std::string_view decoded(std::string_view json, std::size_t offset,
                                       std::string& buffer);

// Infinite beyond the largest double. `text` begins with a number as JSON writes it.
[[nodiscard]] double number_at(std::string_view text);

}  // namespace ivory::json_text
