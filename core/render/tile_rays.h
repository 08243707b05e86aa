// The rays of a tile's pixels, between tracing and the frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/render/camera.h"
#include "core/render/frame.h"
#include "core/render/tiles.h"
#include "core/trace/ray_bundle.h"

namespace ivory {

inline constexpr int tile_side = TileGrid::tile_side;
inline constexpr std::size_t pixels_in_tile = tile_side * tile_side;

// Where the columns and rows of a tile pass the plane before the camera.
struct TilePlane {
    std::array<double, tile_side> u, v;

    TilePlane(const View& view, const Frame& frame, const PixelRect& rect) {
        for (int i = rect.x0; i < rect.x1; ++i)
            u[static_cast<std::size_t>(i - rect.x0)] = plane_u(view, frame.width, frame.height, i);
        for (int j = rect.y0; j < rect.y1; ++j)
            v[static_cast<std::size_t>(j - rect.y0)] = plane_v(view, frame.height, j);
    }
};

// Rays and the pixels that they are of, in groups of 4 x 4 pixels within groups of 8 x 8, since
// neighbours walk alike.
struct TileRays {
    RayBundle rays;
    std::array<std::uint32_t, pixels_in_tile> pixel;  // in the frame
    std::array<std::uint16_t, pixels_in_tile> place;  // in the tile, row by row

    [[nodiscard]] std::size_t size() const { return rays.size(); }

    // Those of the pixels of `rect`, a tile, on `stride` but not on `coarser` (0: none is left out).
    // In parts: with bundles for groups of them, as core/trace/descent.h wants them.
    void gather(const View& view, const Frame& frame, const PixelRect& rect, int stride,
                int coarser, bool in_parts);

    // Calls visit.operator()<count>(k, p) for runs of rays, from k on, whose pixels stand side by
    // side in a row of the frame, from p on.
    template <class Visit>
    void for_runs(const Visit& visit) const {
        for (std::size_t k = 0; k < size();) {
            const std::size_t p = pixel[k];
            if (k + 4 <= size() && pixel[k + 3] == p + 3) {
                visit.template operator()<4>(k, p);
                k += 4;
            } else {
                visit.template operator()<1>(k, p);
                k += 1;
            }
        }
    }
};

}  // namespace ivory
