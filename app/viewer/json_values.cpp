#include "app/viewer/json_values.h"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <system_error>

#include "core/scene/text.h"

namespace ivory {

using nlohmann::json;

namespace {

// A key in a JSON pointer, as RFC 6901 writes it.
std::string unescaped(std::string_view key) {
    std::string plain;
    for (std::size_t i = 0; i < key.size(); ++i) {
        const bool escape = key[i] == '~' && i + 1 < key.size();
        plain += !escape ? key[i] : key[++i] == '1' ? '/' : '~';
    }
    return plain;
}

}  // namespace

std::string shown(const json& value) {
    if (value.is_number_float()) return number_text(value.get<double>());
    return printable(value.dump(-1, ' ', false, json::error_handler_t::replace), 200);
}

bool equal_within(const json& is, const json& expected, double within) {
    if (is.is_number() && expected.is_number())
        return std::abs(is.get<double>() - expected.get<double>()) <= within;
    if (is.is_array() && expected.is_array() && is.size() == expected.size()) {
        for (std::size_t i = 0; i < is.size(); ++i)
            if (!equal_within(is[i], expected[i], within)) return false;
        return true;
    }
    return is == expected;
}

const json* find_value(const json& document, const std::string& where) {
    if (!where.starts_with('/')) {
        const auto found = document.find(where);
        return found == document.end() ? nullptr : &*found;
    }
    const json* value = &document;
    for (std::string_view rest = where; !rest.empty();) {
        rest.remove_prefix(1);  // the slash
        const std::string_view escaped = rest.substr(0, rest.find('/'));
        rest.remove_prefix(escaped.size());
        const json* next = nullptr;
        if (value->is_object()) {
            const auto found = value->find(unescaped(escaped));
            if (found != value->end()) next = &*found;
        } else if (value->is_array()) {
            std::size_t index = 0;
            const char* const end = escaped.data() + escaped.size();
            const auto read = std::from_chars(escaped.data(), end, index);
            if (read.ec == std::errc() && read.ptr == end && index < value->size())
                next = &(*value)[index];
        }
        if (next == nullptr) return nullptr;
        value = next;
    }
    return value;
}

}  // namespace ivory
