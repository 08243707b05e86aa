// Pictures as the bytes of files.
#pragma once

#include <string>

#include "core/render/frame.h"

namespace ivory {

// PNG, 8 bits of sRGB, no alpha; quickly packed rather than tightly. Throws Error.
[[nodiscard]] std::string png_bytes(const Frame& frame);

// The depth as a PFM of one channel (`Pf`, little endian, rows bottom to top): t at the midpoint of
// its interval, nearest float, +inf where there is no root.
[[nodiscard]] std::string depth_bytes(const Frame& frame);

}  // namespace ivory
