// The rays of a tile's pixels, between tracing and the frame.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/render/camera.h"
#include "core/render/camera_lanes.h"
#include "core/render/frame.h"
#include "core/render/tiles.h"
#include "core/trace/ray_bundle.h"

namespace ivory {

inline constexpr int tile_side = TileGrid::tile_side;
inline constexpr std::size_t pixels_in_tile = tile_side * tile_side;

// Where the columns and rows of a tile pass the plane before the camera.
struct TilePlane {
    std::array<double, tile_side> u, v;

    TilePlane(const View& view, int width, int height, const PixelRect& rect) {
        for (int i = rect.x0; i < rect.x1; ++i)
            u[static_cast<std::size_t>(i - rect.x0)] = plane_u(view, width, height, i);
        for (int j = rect.y0; j < rect.y1; ++j)
            v[static_cast<std::size_t>(j - rect.y0)] = plane_v(view, height, j);
    }
};

// Rays and the pixels that they are of, in groups of 4 x 4 pixels within groups of 8 x 8, since
// neighbours walk alike.
struct TileRays {
    RayBundle rays;
    std::array<std::uint32_t, pixels_in_tile> pixel;  // in the picture
    std::array<std::uint16_t, pixels_in_tile> place;  // in the tile, row by row

    [[nodiscard]] std::size_t size() const { return rays.size(); }

    // Those of the pixels (i, j) of `rect`, a tile of a picture of that size, that are wanted. In parts:
    // with bundles for groups of them, as core/trace/descent.h wants them; which hold all rays of a
    // picture of n times as many columns and rows.
    template <class Wanted>
    void gather(const View& view, int width, int height, const PixelRect& rect, bool in_parts,
                const Wanted& wanted, int n = 1) {
        begin(view, width, height, rect, in_parts, n);
        for_squares(rect, [&](const PixelRect& square) {
            for (int j = square.y0; j < square.y1; ++j)
                for (int i = square.x0; i < square.x1; ++i)
                    if (wanted(i, j)) add(width, rect, i, j);
        });
        end(view);
    }
    // Those of the pixels around `rect`, in pieces of four side by side; the picture's edge is none to them.
    // `place`: of an array of two more columns and rows than the tile has.
    void gather_ring(const View& view, int width, int height, const PixelRect& rect, int n);

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

  private:
    void look_through(const View& view, int width, int height, int n);
    void begin(const View& view, int width, int height, const PixelRect& rect, bool in_parts,
               int n);
    // Calls visit(square) for the squares of 4 x 4 pixels, quarter by quarter of the tile; what it adds
    // belongs to the square's part.
    template <class Visit>
    void for_squares(const PixelRect& rect, const Visit& visit) {
        std::size_t part = 1, number = 5;
        for_quarters(rect, 8, [&](const PixelRect& quarter) {
            BundlePart& of_quarter = rays.parts[part++];
            of_quarter.first = static_cast<std::uint32_t>(rays.count);
            of_quarter.first_part = static_cast<std::uint32_t>(rays.part_count);
            for_quarters(quarter, 4, [&](const PixelRect& square) {
                const std::size_t first = rays.count;
                visit(square);
                if (in_parts_ && rays.count > first) add_part(number, square, first);
                ++number;
            });
            of_quarter.end = static_cast<std::uint32_t>(rays.count);
            of_quarter.end_of_parts = static_cast<std::uint32_t>(rays.part_count);
        });
    }
    void add(int width, const PixelRect& rect, int i, int j) {
        u_[rays.count] = plane_->u[static_cast<std::size_t>(i - rect.x0)];
        v_[rays.count] = plane_->v[static_cast<std::size_t>(j - rect.y0)];
        place[rays.count] = static_cast<std::uint16_t>((j - rect.y0) * rect.width() + i - rect.x0);
        pixel[rays.count++] = static_cast<std::uint32_t>(static_cast<std::size_t>(j) *
                                                             static_cast<std::size_t>(width) +
                                                         static_cast<std::size_t>(i));
    }
    void add_part(std::size_t number, const PixelRect& square, std::size_t first);
    void end(const View& view);
    [[nodiscard]] Bundle bundle(std::size_t number, const PixelRect& part_of_tile) const;

    // Calls visit(square) for the squares of that side that a rectangle of twice the side consists of.
    template <class Visit>
    static void for_quarters(const PixelRect& rect, int side, const Visit& visit) {
        for (int y = rect.y0; y < rect.y1; y += side)
            for (int x = rect.x0; x < rect.x1; x += side)
                visit(PixelRect{x, y, std::min(x + side, rect.x1), std::min(y + side, rect.y1)});
    }

    // Of the tile that is being gathered.
    std::optional<TilePlane> plane_;
    TileBundles bundles_;
    const View* view_ = nullptr;
    int all_width_ = 0, all_height_ = 0, n_ = 1;
    bool in_parts_ = false, is_whole_ = false;
    alignas(64) std::array<double, pixels_in_tile> u_, v_;
};

}  // namespace ivory
