// Pictures as the bytes of files.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/render/frame.h"
#include "core/render/tiles.h"

namespace ivory {

// Bytes of sRGB, row by row from the top.
struct PictureBytes {
    int width, height;  // pixels
    const Rgba8* color;
};

// PNG, 8 bits of sRGB, no alpha; quickly packed rather than tightly. Throws Error.
[[nodiscard]] std::string png_bytes(const PictureBytes& picture);
[[nodiscard]] std::string png_bytes(const Frame& frame);

// The same bytes of a picture that is still being painted: whoever paints the last pixel of some
// rows packs these.
class GrowingPng {
  public:
    // The pixels must outlive it. Throws std::bad_alloc.
    explicit GrowingPng(const PictureBytes& picture);
    ~GrowingPng();
    GrowingPng(const GrowingPng&) = delete;
    GrowingPng& operator=(const GrowingPng&) = delete;

    // Those pixels are painted, which they are once; of one tile, by any thread.
    void painted(const PixelRect& tile) noexcept;

    // What the threads that painted have spent on packing.
    [[nodiscard]] double seconds() const;

    // All pixels are painted, told or not. Throws Error.
    [[nodiscard]] std::string bytes();

  private:
    class Strips;
    std::unique_ptr<Strips> strips_;
};

// The depth as a PFM of one channel (`Pf`, little endian, rows bottom to top): t at the midpoint of
// its interval, nearest float, +inf where there is no root.
[[nodiscard]] std::string depth_bytes(const Frame& frame);
// t at the midpoints, infinity where there is no root.
[[nodiscard]] std::vector<double> depth_of(const Frame& frame);
// Of distances, row by row from the top.
[[nodiscard]] std::string depth_bytes(int width, int height, const double* depth);

}  // namespace ivory
