// From linear light to the bytes of sRGB (IEC 61966-2-1), by comparison: no power is computed.
#pragma once

#include <array>
#include <cstdint>

#include "core/render/frame.h"
#include "core/scene/scene.h"

namespace ivory {

struct SrgbTable {
    static constexpr int bins = 4096;
    // least[k]: the least linear value that rounds to the byte k; the last: beyond 1.
    std::array<double, 257> least{};
    std::array<float, 257> least_float{};
    // first[n]: the byte of n / bins. In no bin more than one byte begins: where the curve is
    // steepest it rises by 255 * 12.92 / bins < 1.
    std::array<std::int32_t, bins + 1> first{};
};

[[nodiscard]] const SrgbTable& srgb_table();

// Linear RGB, clamped to 0..1, as bytes of sRGB: 255 times the curve, to nearest.
[[nodiscard]] Rgba8 to_srgb(const Color& linear);

}  // namespace ivory
