#include "app/panels/typed_number.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

namespace ivory {

std::optional<double> parse_number(const std::string& typed, double value) {
    std::string text = typed;
    const auto is_space = [](char c) { return c == ' ' || c == '\t'; };
    while (!text.empty() && is_space(text.back())) text.pop_back();
    while (!text.empty() && is_space(text.front())) text.erase(0, 1);
    char change = 0;
    if (text.size() > 2 && text[1] == '=' &&
        std::string_view("+-*/").find(text[0]) != std::string_view::npos) {
        change = text[0];
        text.erase(0, 2);
        while (!text.empty() && is_space(text.front())) text.erase(0, 1);
    }
    if (text.starts_with('+')) text.erase(0, 1);
    // a decimal comma, where it cannot be anything else
    if (std::count(text.begin(), text.end(), ',') == 1 && text.find('.') == std::string::npos)
        std::replace(text.begin(), text.end(), ',', '.');
    double number = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    if (text.empty() || error != std::errc() || rest != end) return std::nullopt;
    switch (change) {
        case '+':
            number = value + number;
            break;
        case '-':
            number = value - number;
            break;
        case '*':
            number = value * number;
            break;
        case '/':
            number = value / number;
            break;
        default:
            break;
    }
    if (!std::isfinite(number)) return std::nullopt;
    return number;
}

double step_for(double value) {
    if (value == 0 || !std::isfinite(value)) return 0.01;
    const double exponent = std::round(std::log10(std::abs(value))) - 2;
    return std::pow(10.0, std::clamp(exponent, -300.0, 300.0));
}

}  // namespace ivory
