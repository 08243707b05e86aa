// Pictures as the bytes of files.
#pragma once

#include <string>
#include <vector>

#include "core/render/frame.h"

namespace ivory {

// Bytes of sRGB, row by row from the top.
struct PictureBytes {
    int width, height;  // pixels
    const Rgba8* color;
};

// PNG, 8 bits of sRGB, no alpha; quickly packed rather than tightly. Throws Error.
[[nodiscard]] std::string png_bytes(const PictureBytes& picture);
[[nodiscard]] std::string png_bytes(const Frame& frame);

// The depth as a PFM of one channel (`Pf`, little endian, rows bottom to top): t at the midpoint of
// its interval, nearest float, +inf where there is no root.
[[nodiscard]] std::string depth_bytes(const Frame& frame);
// t at the midpoints, infinity where there is no root.
[[nodiscard]] std::vector<double> depth_of(const Frame& frame);
// Of distances, row by row from the top.
[[nodiscard]] std::string depth_bytes(int width, int height, const double* depth);

}  // namespace ivory
