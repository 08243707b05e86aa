#include "core/scene/text.h"

#include <locale.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace ivory {
namespace {

struct CodePoint {
    char32_t value;
    std::size_t bytes;  // 0: the text does not begin with well-formed UTF-8
};

// Unicode 15, table 3-7: the first byte says the length and narrows the second, which rules out
// overlong forms, surrogates and everything beyond U+10FFFF.
CodePoint first_code_point(std::string_view text) {
    constexpr CodePoint ill_formed{0, 0};
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned first = byte(0);
    if (first < 0x80) return {first, 1};
    if (first < 0xC2 || first > 0xF4) return ill_formed;
    const std::size_t length = first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    if (text.size() < length) return ill_formed;
    const unsigned lowest = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
    const unsigned highest = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
    if (byte(1) < lowest || byte(1) > highest) return ill_formed;
    char32_t value = first & (0x7Fu >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0) != 0x80) return ill_formed;
        value = value << 6 | (byte(i) & 0x3F);
    }
    return {value, length};
}

// Controls, line separators, and the marks that turn the direction of writing.
bool harmful_in_a_line(char32_t c) {
    return c < 0x20 || (c >= 0x7F && c < 0xA0) || c == 0x061C || c == 0x200E || c == 0x200F ||
           (c >= 0x2028 && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069) || c == 0xFEFF;
}

std::string escape(const char* format, unsigned value) {
    std::array<char, 16> buffer{};
    std::snprintf(buffer.data(), buffer.size(), format, value);
    return buffer.data();
}

// Levenshtein's distance, one row of the table at a time.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    const auto lower = [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    };
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
        }
    }
    return row[b.size()];
}

}  // namespace

std::string number_text(double value) {
    std::string text;
    append_number(text, value);
    return text;
}

void append_number(std::string& text, double value) {
    if (value == 0) {
        text += std::signbit(value) ? "-0.0" : "0";  // a bare -0 is an integer to many
        return;
    }
    std::array<char, 64> buffer;
    char* const end = buffer.data() + buffer.size();
    const double magnitude = std::abs(value);
    const std::to_chars_result written =
        magnitude >= 1e-5 && magnitude < 1e16
            ? std::to_chars(buffer.data(), end, value, std::chars_format::fixed)
            : std::to_chars(buffer.data(), end, value);
    text.append(buffer.data(), written.ptr);
}

double rounded(const std::string& number) {
    static const locale_t c_locale = ::newlocale(LC_ALL_MASK, "C", nullptr);
    return ::strtod_l(number.c_str(), nullptr, c_locale);
}

std::optional<std::size_t> first_invalid_utf8(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
        if (static_cast<unsigned char>(text[at]) < 0x80) {
            ++at;
            continue;
        }
        const CodePoint c = first_code_point(text.substr(at));
        if (c.bytes == 0) return at;
        at += c.bytes;
    }
    return std::nullopt;
}

std::string printable(std::string_view text, std::size_t most_characters) {
    std::string line;
    for (std::size_t characters = 0; !text.empty(); ++characters) {
        if (characters == most_characters) return line + "...";
        const CodePoint c = first_code_point(text);
        const std::string_view raw = text.substr(0, std::max<std::size_t>(c.bytes, 1));
        if (c.bytes == 0) {
            line += escape("\\x%02x", static_cast<unsigned char>(raw[0]));
        } else if (c.value == '\n') {
            line += "\\n";
        } else if (c.value == '\r') {
            line += "\\r";
        } else if (c.value == '\t') {
            line += "\\t";
        } else if (harmful_in_a_line(c.value)) {
            line += escape(c.value < 0x80 ? "\\x%02x" : "\\u%04x", c.value);
        } else {
            line += raw;
        }
        text.remove_prefix(raw.size());
    }
    return line;
}

std::string in_quotes(std::string_view text) { return '"' + printable(text, 60) + '"'; }

std::string listed(std::span<const std::string_view> words, std::string_view conjunction) {
    std::string list;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (i > 0 && i + 1 == words.size()) {
            list.append(" ").append(conjunction).append(" ");
        } else if (i > 0) {
            list += ", ";
        }
        list += words[i];
    }
    return list;
}

std::string some_of(std::span<const std::string> words) {
    constexpr std::size_t most = 8;
    const std::span<const std::string> some = words.first(std::min(words.size(), most));
    std::vector<std::string> quoted;
    for (const std::string& word : some) quoted.push_back(in_quotes(word));
    return listed(std::vector<std::string_view>(quoted.begin(), quoted.end())) +
           (words.size() > most ? " and others" : "");
}

std::optional<std::string_view> nearest_word(std::string_view word,
                                             std::span<const std::string_view> words) {
    std::optional<std::string_view> nearest;
    std::size_t least = 3;
    for (const std::string_view candidate : words) {
        const std::size_t shorter = std::min(word.size(), candidate.size());
        const std::size_t longer = std::max(word.size(), candidate.size());
        if (longer - shorter >= least) continue;  // so many letters are missing at least
        const std::size_t distance = edit_distance(word, candidate);
        if (distance < least && 2 * distance < longer) {
            nearest = candidate;
            least = distance;
        }
    }
    return nearest;
}

}  // namespace ivory
