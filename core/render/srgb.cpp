#include "core/render/srgb.h"

#include <cmath>
#include <cstddef>

namespace ivory {
namespace {

double srgb_decode(double s) {
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

SrgbTable make_table() {
    SrgbTable table;
    for (std::size_t k = 1; k < table.least.size(); ++k) {
        table.least[k] = srgb_decode((static_cast<double>(k) - 0.5) / 255);
        table.least_float[k] = static_cast<float>(table.least[k]);
    }
    std::int32_t byte = 0;
    for (std::size_t bin = 0; bin < table.first.size(); ++bin) {
        const double x = static_cast<double>(bin) / SrgbTable::bins;
        while (x >= table.least[static_cast<std::size_t>(byte) + 1]) ++byte;
        table.first[bin] = byte;
    }
    return table;
}

std::uint8_t byte_of(double linear) {
    const SrgbTable& table = srgb_table();
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 255;
    const auto first =
        static_cast<std::size_t>(table.first[static_cast<std::size_t>(linear * SrgbTable::bins)]);
    return static_cast<std::uint8_t>(first + (linear >= table.least[first + 1] ? 1 : 0));
}

}  // namespace

const SrgbTable& srgb_table() {
    static const SrgbTable table = make_table();
    return table;
}

Rgba8 to_srgb(const Color& linear) {
    return {byte_of(linear.x), byte_of(linear.y), byte_of(linear.z), 255};
}

}  // namespace ivory
