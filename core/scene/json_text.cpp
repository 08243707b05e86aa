#include "core/scene/json_text.h"

#include <charconv>
#include <limits>
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

}  // namespace

unsigned hexadecimal(std::string_view digits) {
    unsigned value = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    return value;
}

std::string_view decoded(std::string_view json, std::size_t offset, std::string& buffer) {
    const std::size_t start = offset + 1;
    std::size_t at = start;
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
    double value = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ec != std::errc::result_out_of_range) return value;
    return rounded(std::string(text.data(), read.ptr));
}

}  // namespace ivory::json_text
