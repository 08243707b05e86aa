// A picture of few pixels with more of them between, so that what is left to the screen's own filter are
// steps too small to be seen.
#pragma once

#include <vector>

#include "app/platform/window_rect.h"
#include "app/viewer/shown_picture.h"
#include "core/render/frame.h"

namespace ivory {

struct SmoothPicture {
    WindowSize size;  // a power of two times the coarse picture's
    std::vector<Rgba8> color;
};

// Doubled in size until a pixel of it covers at most 3 x 3 of the window's. Each time every pixel
// becomes four, a quarter of its side from its middle, 3/4 of it and 1/4 of its neighbour along both
// axes, as light: corner cutting (Chaikin 1974), whose limit is a quadratic B-spline.
[[nodiscard]] SmoothPicture smoothed(const CoarsePicture& picture);

}  // namespace ivory
