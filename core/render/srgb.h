// Between linear light and sRGB (IEC 61966-2-1): to bytes by comparison, no power is computed.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/render/frame.h"
#include "core/scene/scene.h"

namespace ivory {

// For linear values from `darkest` to 1, as floats, by all but the last 16 of their bits: in no
// such bin, which is 1/256 of its values wide at least and 1/128 at most, more than one byte
// begins.
struct SrgbTable {
    static constexpr float darkest = 0x1p-13F;  // and all below is 0
    static constexpr std::uint32_t first_bits = std::bit_cast<std::uint32_t>(darkest);
    static constexpr std::size_t bins =
        (std::bit_cast<std::uint32_t>(1.0F) - first_bits) / 0x10000 + 1;

    // Of each bin the byte of its first value, times 2^24, and the last 16 bits of the least value
    // that has the next byte, or 2^16.
    std::array<std::uint32_t, bins> entry{};

    [[nodiscard]] std::uint8_t byte(float linear) const {
        const std::uint32_t bits =
            std::bit_cast<std::uint32_t>(std::min(std::max(darkest, linear), 1.0F)) - first_bits;
        const std::uint32_t at = entry[bits / 0x10000];
        return static_cast<std::uint8_t>((at >> 24) +
                                         (bits % 0x10000 >= (at & 0xffffff) ? 1U : 0U));
    }
};

[[nodiscard]] const SrgbTable& srgb_table();

// Linear RGB, clamped to 0..1, as bytes of sRGB: 255 times the curve, to nearest.
[[nodiscard]] Rgba8 to_srgb(const Color& linear);

// The light of a value of sRGB, 0..1 both; and of each byte.
[[nodiscard]] double linear_of_srgb(double value);
[[nodiscard]] const std::array<double, 256>& linear_of_bytes();

}  // namespace ivory
