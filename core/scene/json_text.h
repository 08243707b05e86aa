// What the parser and the reader know of JSON's texts and numbers.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
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

// Eight characters at once, the first in the lowest byte: to look for the first one of some kind
// among them takes no branch that depends on where it is.
inline constexpr std::ptrdiff_t eight = 8;

[[nodiscard]] inline std::uint64_t eight_at(const char* at) {
    std::uint64_t all = 0;
    std::memcpy(&all, at, sizeof all);
    return std::endian::native == std::endian::little ? all : __builtin_bswap64(all);
}

// The same in each byte.
[[nodiscard]] constexpr std::uint64_t each(unsigned char byte) {
    return 0x0101010101010101u * byte;
}

// How many of the eight come before the first that is no digit.
[[nodiscard]] inline int leading_digits(std::uint64_t characters) {
    const std::uint64_t d = characters ^ each('0');  // 0 to 9 for digits, else more
    const std::uint64_t others = (((d & each(0x7F)) + each(0x80 - 10)) | d) & each(0x80);
    return std::countr_zero(others) / 8;
}

// How many come before the first that does not stand for itself in a text. What is borrowed by a
// subtraction marks only bytes behind one that is found already.
[[nodiscard]] inline int leading_plain(std::uint64_t characters) {
    const auto below = [](std::uint64_t bytes, unsigned char least) {
        return (bytes - each(least)) & ~bytes & each(0x80);
    };
    const std::uint64_t others = below(characters, 0x20) | below(characters ^ each('"'), 1) |
                                 below(characters ^ each('\\'), 1);
    return std::countr_zero(others) / 8;
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
