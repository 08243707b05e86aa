// Pictures for two eyes (core/render/camera.h: eye_of).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/render/frame.h"

namespace ivory {

enum class Stereo : std::uint8_t {
    none,
    side_by_side,  // twice as wide, the left eye's picture on the left
    red_cyan,      // both turned to grey: red of the left eye's, green and blue of the right's
};
inline constexpr std::array<std::string_view, 2> stereo_words{"side-by-side", "red-cyan"};

// Both of width * height pixels, row by row from the top; so is what comes back, of twice the width side by
// side.
[[nodiscard]] std::vector<Rgba8> side_by_side(const Rgba8* left, const Rgba8* right, int width,
                                              int height);
// Grey is the luminance of linear light, 0.2126 R + 0.7152 G + 0.0722 B (ITU-R BT.709).
[[nodiscard]] std::vector<Rgba8> red_cyan(const Rgba8* left, const Rgba8* right, int width,
                                          int height);

}  // namespace ivory
