#include "core/render/stereo.h"

#include <algorithm>
#include <cstddef>

#include "core/render/srgb.h"

namespace ivory {

std::vector<Rgba8> side_by_side(const Rgba8* left, const Rgba8* right, int width, int height) {
    const auto across = static_cast<std::size_t>(width), down = static_cast<std::size_t>(height);
    std::vector<Rgba8> both(2 * across * down);
    for (std::size_t j = 0; j < down; ++j) {
        std::copy_n(left + j * across, across, &both[2 * j * across]);
        std::copy_n(right + j * across, across, &both[(2 * j + 1) * across]);
    }
    return both;
}

std::vector<Rgba8> red_cyan(const Rgba8* left, const Rgba8* right, int width, int height) {
    const std::array<double, 256>& linear = linear_of_bytes();
    const SrgbTable& table = srgb_table();
    const auto grey = [&](const Rgba8& color) {
        return table.byte(static_cast<float>(0.2126 * linear[color.r] + 0.7152 * linear[color.g] +
                                             0.0722 * linear[color.b]));
    };
    std::vector<Rgba8> both(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (std::size_t p = 0; p < both.size(); ++p) {
        const std::uint8_t seen_right = grey(right[p]);
        both[p] = {grey(left[p]), seen_right, seen_right, 255};
    }
    return both;
}

}  // namespace ivory
