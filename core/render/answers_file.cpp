#include "core/render/answers_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <system_error>

#include "core/render/camera.h"
#include "core/scene/error.h"
#include "core/scene/text.h"

namespace ivory {
namespace {

constexpr std::size_t longest_number = 32;  // characters of any double, shortest or hexadecimal

void append_shortest(std::string& text, double value) {
    std::array<char, longest_number> buffer;
    const auto written = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    text.append(buffer.data(), written.ptr);
}

void append_numbers(std::string& text, const Vec3d& v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        text += ',';
        append_shortest(text, v[axis]);
    }
}

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

double parse_number(std::string_view word) {
    std::string_view digits = word;
    const bool negative = digits.starts_with('-');
    if (negative || digits.starts_with('+')) digits.remove_prefix(1);
    const bool hexadecimal = digits.starts_with("0x") || digits.starts_with("0X");
    if (hexadecimal) digits.remove_prefix(2);

    double value = 0;
    const auto format = hexadecimal ? std::chars_format::hex : std::chars_format::general;
    const char* const end = digits.data() + digits.size();
    const auto read = std::from_chars(digits.data(), end, value, format);
    const bool signed_twice = digits.starts_with('-') || digits.starts_with('+');
    if (signed_twice || read.ec == std::errc::invalid_argument || read.ptr != end) {
        throw Error(in_quotes(word) + " is not a number; write it like 0.25, 1e-3 or 0x1p-2");
    }
    if (read.ec == std::errc::result_out_of_range) {
        value = rounded((hexadecimal ? "0x" : "") + std::string(digits));
    }
    if (!std::isfinite(value)) {
        throw Error(in_quotes(word) +
                    " is not finite as a double; write a number of less than 1.8e308");
    }
    return negative ? -value : value;
}

}  // namespace

std::string_view status_word(Status status) {
    switch (status) {
        case Status::hit:
            return "hit";
        case Status::miss:
            return "miss";
        case Status::unresolved:
            return "unresolved";
        case Status::claimed_hit:
            return "claimed_hit";
        case Status::claimed_miss:
            return "claimed_miss";
    }
    return "";
}

void append_hexadecimal(std::string& text, double value) {
    std::array<char, longest_number> buffer;
    const auto written = std::to_chars(buffer.data(), buffer.data() + buffer.size(),
                                       std::abs(value), std::chars_format::hex);
    text += std::signbit(value) ? "-0x" : "0x";
    text.append(buffer.data(), written.ptr);
}

void append_answer(std::string& text, const Answer& answer) {
    text += status_word(answer.isolation.status);
    if (!possibly_hit(answer.isolation.status)) {
        text += ",,,,,,,,";
        return;
    }
    text += ',';
    append_shortest(text, answer.isolation.t.lo);
    text += ',';
    append_shortest(text, answer.isolation.t.hi);
    append_numbers(text, answer.surface.normal);
    append_numbers(text, answer.surface.color);
}

void append_row(std::string& text, const Picture& picture, const Frame& frame, int j) {
    for (int i = 0; i < frame.width; ++i) {
        const Ray ray = primary_ray(picture.view, frame.width, frame.height, i, j);
        for (const Vec3d& v : {ray.origin, ray.direction}) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                append_hexadecimal(text, v[axis]);
                text += ',';
            }
        }
        const std::size_t p = frame.at(i, j);
        Answer answer{{frame.status[p], {}}, {}};
        if (possibly_hit(frame.status[p]))
            answer = {{frame.status[p], frame.t(p)}, frame.surface[p]};
        append_answer(text, answer);
        text += '\n';
    }
}

std::optional<Ray> parse_ray(std::string_view line) {
    constexpr std::size_t numbers_in_ray = 6;
    line = line.substr(0, line.find('#'));
    std::array<double, numbers_in_ray> numbers{};
    std::size_t count = 0;
    // A comma stands between two numbers: `after_comma` or the line's beginning want one to come.
    bool after_comma = false;
    for (std::size_t at = 0; at < line.size();) {
        if (is_space(line[at])) {
            ++at;
            continue;
        }
        if (line[at] == ',') {
            if (count == 0 || after_comma) {
                throw Error("a number is missing before a comma; a ray is ox oy oz dx dy dz");
            }
            after_comma = true;
            ++at;
            continue;
        }
        const std::size_t begin = at;
        while (at < line.size() && !is_space(line[at]) && line[at] != ',') ++at;
        const double number = parse_number(line.substr(begin, at - begin));
        if (count < numbers_in_ray) numbers[count] = number;
        ++count;
        after_comma = false;
    }
    if (count == 0) return std::nullopt;
    if (after_comma) throw Error("a number is missing after a comma; a ray is ox oy oz dx dy dz");
    if (count != numbers_in_ray) {
        throw Error(std::to_string(count) + (count == 1 ? " number" : " numbers") +
                    " where a ray has 6: ox oy oz dx dy dz");
    }
    const Ray ray{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
    if (ray.direction == Vec3d{0, 0, 0}) {
        throw Error(
            "the direction is 0, 0, 0 and points nowhere; one of the last three numbers must "
            "not be 0");
    }
    return ray;
}

}  // namespace ivory
