// Numbers as a person would write them: where a drag leaves a value, it leaves few digits.
#pragma once

#include <cmath>

namespace ivory {

// The double nearest to the multiple of 10^exponent that is nearest to `value`; `value` itself
// where doubles are coarser than that. |exponent| <= 300.
[[nodiscard]] inline double tidy(double value, int exponent) {
    const double power = std::pow(10.0, std::abs(exponent));
    const double rounded =
        exponent < 0 ? std::round(value * power) / power : std::round(value / power) * power;
    return std::isfinite(rounded) ? rounded + 0.0 : value;  // + 0.0: no minus zero
}

// The least exponent with 10^exponent >= length > 0, within -300..300.
[[nodiscard]] inline int exponent_above(double length) {
    return static_cast<int>(std::fmin(std::fmax(std::ceil(std::log10(length)), -300), 300));
}

}  // namespace ivory
