// Text for messages and files: numbers that read back to the same double, and words of the user's
// that keep a message on one line.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace ivory {

// The shortest decimal that reads back to the same finite double, -0.0 included; plain digits where
// these stay short ("100000", not "1e+05"). Not finite: "inf", "-inf", "nan", which no reader
// takes.
[[nodiscard]] std::string number_text(double value);

// Appends `number_text(value)`.
void append_number(std::string& text, double value);

// The nearest double to a number as C writes it, in whatever locale; infinite beyond the largest.
// For what from_chars calls out of range, which is what is too small as well as what is too large.
[[nodiscard]] double rounded(const std::string& number);

// Offset of the first byte that does not belong to well-formed UTF-8 (Unicode 15, table 3-7), or
// nothing where all do.
[[nodiscard]] std::optional<std::size_t> first_invalid_utf8(std::string_view text);

// `text` with everything escaped that could break the line, steer a terminal or turn the direction
// of writing: control and format characters as \n, \t, \x1b, \u2028, bytes that are not UTF-8 as
// \xff. Of a longer text the first `most_characters`, then "...".
[[nodiscard]] std::string printable(std::string_view text,
                                    std::size_t most_characters = std::string_view::npos);

// The first 60 characters of `text`, printable, in double quotes.
[[nodiscard]] std::string in_quotes(std::string_view text);

// "a", "a and b", "a, b and c".
[[nodiscard]] std::string listed(std::span<const std::string_view> words,
                                 std::string_view conjunction = "and");

// The first eight of them in quotes, listed, "and others" if there are more.
[[nodiscard]] std::string some_of(std::span<const std::string> words);

// The word of `words` that `word` most likely was meant to be: at most two letters inserted, left
// out or replaced (upper case counts as lower case), and fewer than half of them.
[[nodiscard]] std::optional<std::string_view> nearest_word(std::string_view word,
                                                           std::span<const std::string_view> words);

}  // namespace ivory
