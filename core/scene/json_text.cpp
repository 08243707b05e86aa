#include "core/scene/json_text.h"

#include <array>
#include <bit>
#include <cfloat>
#include <charconv>
#include <limits>
#include <optional>
#include <system_error>

#include "core/scene/text.h"

namespace ivory::json_text {
namespace {

void append_utf8(std::string& text, unsigned code_point) {
    const auto append = [&](unsigned byte) { text += static_cast<char>(byte); };
    const auto append_rest = [&](unsigned shift) { append(0x80 | (code_point >> shift & 0x3F)); };
    if (code_point < 0x80) {
        append(code_point);
    } else if (code_point < 0x800) {
        append(0xC0 | code_point >> 6);
        append_rest(0);
    } else if (code_point < 0x10000) {
        append(0xE0 | code_point >> 12);
        append_rest(6);
        append_rest(0);
    } else {
        append(0xF0 | code_point >> 18);
        append_rest(12);
        append_rest(6);
        append_rest(0);
    }
}

constexpr std::array<std::uint64_t, eight + 1> whole_powers{
    1, 10, 100, 1'000, 10'000, 100'000, 1'000'000, 10'000'000, 100'000'000};

constexpr int most_digits = 19;  // any number of so many fits into 64 bits

// 10^0 to 10^most_digits, as doubles without an error: 5^22 < 2^53.
constexpr std::array<double, most_digits + 1> powers_of_ten = [] {
    std::array<double, most_digits + 1> powers{1};
    for (std::size_t i = 1; i < powers.size(); ++i) powers[i] = 10 * powers[i - 1];
    return powers;
}();

// Digits that were read one behind the other.
struct Digits {
    const char* end;
    std::uint64_t number;
    int count;  // more than `most_digits`: the number is not theirs
};

// Those that stand at `before.end`, behind the others. They must end, and so eight characters
// before the end of the text.
inline Digits more_digits(Digits before, const char* end_of_text) {
    Digits all = before;
    while (end_of_text - all.end >= eight && all.count <= most_digits) {
        const std::uint64_t characters = eight_at(all.end);
        const int count = leading_digits(characters);
        if (count == 0) return all;
        // With zeros before them; then put together to pairs, to fours, to one number.
        std::uint64_t digits = (characters ^ each('0')) << 8 * (8 - count);
        digits = (10 * digits + (digits >> 8)) & 0x00FF00FF00FF00FFu;
        digits = (100 * digits + (digits >> 16)) & 0x0000FFFF0000FFFFu;
        digits = (10'000 * digits + (digits >> 32)) & 0xFFFFFFFFu;
        all.number = all.number * whole_powers[static_cast<std::size_t>(count)] + digits;
        all.end += count;
        all.count += count;
        if (count < eight) return all;
    }
    return {all.end, 0, most_digits + 1};
}

// What is written without an exponent and is a quotient of two doubles, which one division finds to
// nearest (Clinger 1990, "How to read floating point numbers accurately"). Nothing for the others,
// and for such as stand at the very end of the text.
std::optional<double> quotient_at(std::string_view text) {
    static_assert(FLT_EVAL_METHOD == 0);
    constexpr std::uint64_t most = std::uint64_t{1} << std::numeric_limits<double>::digits;
    const char* const end = text.data() + text.size();
    const bool negative = text.front() == '-';
    const Digits whole = more_digits({text.data() + (negative ? 1 : 0), 0, 0}, end);
    if (whole.count > most_digits) return std::nullopt;
    Digits all = whole;
    if (*whole.end == '.') all = more_digits({whole.end + 1, whole.number, whole.count}, end);
    if (all.count > most_digits || all.number > most) return std::nullopt;
    if (*all.end == 'e' || *all.end == 'E') return std::nullopt;
    const double value = static_cast<double>(all.number) /
                         powers_of_ten[static_cast<std::size_t>(all.count - whole.count)];
    // No branch: signs have no order.
    const std::uint64_t sign = std::uint64_t{negative} << 63;
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) | sign);
}

}  // namespace

unsigned hexadecimal(std::string_view digits) {
    unsigned value = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    return value;
}

std::string_view decoded(std::string_view json, std::size_t offset, std::string& buffer) {
    const std::size_t start = offset + 1;
    std::size_t at = start;
    while (json.size() - at >= eight) {
        const int plain = leading_plain(eight_at(json.data() + at));
        at += static_cast<std::size_t>(plain);
        if (plain < eight) break;
    }
    while (is_plain_in_text(json[at])) ++at;
    if (json[at] == '"') return json.substr(start, at - start);

    buffer.assign(json.substr(start, at - start));
    while (json[at] != '"') {
        if (json[at] != '\\') {
            buffer += json[at++];
            continue;
        }
        constexpr std::string_view letters = "bfnrt", meant = "\b\f\n\r\t";
        const char escaped = json[at + 1];
        at += 2;
        if (escaped == 'u') {
            unsigned code_point = hexadecimal(json.substr(at, 4));
            at += 4;
            if (is_high_surrogate(code_point)) {
                const unsigned low = hexadecimal(json.substr(at + 2, 4));
                code_point = 0x10000 + ((code_point - 0xD800) << 10) + (low - 0xDC00);
                at += 6;
            }
            append_utf8(buffer, code_point);
        } else {
            const std::size_t letter = letters.find(escaped);
            buffer += letter == std::string_view::npos ? escaped : meant[letter];
        }
    }
    return buffer;
}

double number_at(std::string_view text) {
    if (const std::optional<double> quotient = quotient_at(text)) return *quotient;
    double value = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ec != std::errc::result_out_of_range) return value;
    return rounded(std::string(text.data(), read.ptr));
}

}  // namespace ivory::json_text
