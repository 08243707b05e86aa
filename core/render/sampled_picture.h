// A picture of several samples a pixel: n x n of them, the pixels of a picture of n times as many columns
// and rows. What the picture shows is their mean in linear light.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/render/canvas.h"
#include "core/render/frame.h"

namespace ivory {

inline constexpr int most_samples_a_side = 8;

// What Task::sample paints on.
struct SampledPicture {
    int samples_a_side;   // n, 2 or more
    Plane<Rgba8> color;   // as a frame's
    Plane<double> depth;  // the least t of a pixel's samples, infinity: none; empty unless kept
    // By tile: how many of its pixels have each Status. A pixel is named after the sample that comes
    // first in the order unresolved, hit, claimed_hit, miss, claimed_miss.
    std::vector<std::array<std::uint16_t, 5>> pixels;

    // For a canvas of the picture's size. `keep_depth`: all samples are traced. Throws std::bad_alloc.
    SampledPicture(const Canvas& canvas, int n, bool keep_depth);
};

// Of a pixel of which some samples are known to be one and another has been found to be the other.
[[nodiscard]] Status named_after(Status one, Status other);

// From all pixels of the larger picture, on a canvas that keeps its surface; with the depth.
[[nodiscard]] SampledPicture mean_of(const Picture& picture, const Canvas& larger,
                                     int samples_a_side);

}  // namespace ivory
