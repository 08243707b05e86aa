// The directions of primary rays (core/render/camera.h) for many pixels at a time in SIMD. Nothing
// is fused: every instruction set gives the same doubles.
#pragma once

#include <array>
#include <cstddef>

#include "core/render/camera.h"

namespace ivory {

// The directions of the primary rays through the places u[k], v[k] (plane_u, plane_v) for
// k < count, to the bit. The arrays have room for the next multiple of 8.
void primary_directions(const View& view, std::size_t count, const double* u, const double* v,
                        double* dx, double* dy, double* dz);

// The bundles (core/field/bundle.h) of a whole tile at the pixel (i, j): of itself, of its four
// quarters, and of the four quarters of each of these, row by row. Cheaper than bundle_around of
// each, and as good. Proof: camera_lanes.cpp.
using TileBundles = std::array<Bundle, 1 + 4 + 16>;
// `samples`: of a tile of so many times as many columns and rows.
[[nodiscard]] TileBundles tile_bundles(const View& view, int width, int height, int i, int j,
                                       int samples = 1);

}  // namespace ivory
