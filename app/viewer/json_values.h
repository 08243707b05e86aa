// Values of JSON as scripts name, compare and show them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace ivory {

// On one line, in at most 200 characters; numbers with the digits that read back to the same double.
[[nodiscard]] std::string shown(const nlohmann::json& value);

// Numbers, also those in lists of the same length, may be `within` of each other; all else is equal.
[[nodiscard]] bool equal_within(const nlohmann::json& is, const nlohmann::json& expected,
                                double within);

// The value at a JSON pointer (RFC 6901), or of a top-level key; nullptr where there is none.
[[nodiscard]] const nlohmann::json* find_value(const nlohmann::json& document,
                                               const std::string& where);

}  // namespace ivory
