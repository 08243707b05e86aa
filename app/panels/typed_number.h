// Numbers as a person writes and drags them.
#pragma once

#include <optional>
#include <string>

namespace ivory {

// What was typed, as a double; nothing where it is no finite number. `value` is what stands now:
// "+=1", "-=", "*=", "/=" change it.
[[nodiscard]] std::optional<double> parse_number(const std::string& text, double value);

// A power of ten: near a hundredth of |value|, for a drag that begins there.
[[nodiscard]] double step_for(double value);

}  // namespace ivory
