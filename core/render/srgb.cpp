#include "core/render/srgb.h"

#include <cmath>
#include <cstddef>

namespace ivory {
namespace {

SrgbTable make_table() {
    // The least float that rounds to the byte k, as bits: they rise with it.
    const auto least_bits = [](std::uint32_t k) {
        const double least = linear_of_srgb((static_cast<double>(k) - 0.5) / 255);
        return std::bit_cast<std::uint32_t>(static_cast<float>(least));
    };
    SrgbTable table;
    std::uint32_t byte = 0;
    for (std::size_t bin = 0; bin < table.entry.size(); ++bin) {
        const std::uint32_t begin =
            SrgbTable::first_bits + static_cast<std::uint32_t>(bin) * 0x10000;
        while (byte < 255 && least_bits(byte + 1) <= begin) ++byte;
        const std::uint32_t next = byte < 255 ? least_bits(byte + 1) - begin : 0x10000;
        table.entry[bin] = byte << 24 | std::min(next, std::uint32_t{0x10000});
    }
    return table;
}

}  // namespace

const SrgbTable& srgb_table() {
    static const SrgbTable table = make_table();
    return table;
}

Rgba8 to_srgb(const Color& linear) {
    const SrgbTable& table = srgb_table();
    const auto byte = [&](double value) { return table.byte(static_cast<float>(value)); };
    return {byte(linear.x), byte(linear.y), byte(linear.z), 255};
}

double linear_of_srgb(double value) {
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

const std::array<double, 256>& linear_of_bytes() {
    static const std::array<double, 256> table = [] {
        std::array<double, 256> linear{};
        for (std::size_t byte = 0; byte < linear.size(); ++byte)
            linear[byte] = linear_of_srgb(static_cast<double>(byte) / 255);
        return linear;
    }();
    return table;
}

}  // namespace ivory
