#include "core/render/tile_rays.h"

#include <algorithm>

#include "core/render/camera_lanes.h"

namespace ivory {
namespace {

// Whether column and row, counted from the picture's corner, fall on the stride: those of a tile do
// so alike, its corner being a multiple of 16.
bool on_stride(int i, int j, int stride) { return i % stride == 0 && j % stride == 0; }
int first_on(int stride, int from) { return (from + stride - 1) / stride * stride; }

// Calls visit(square) for the squares of that side that a rectangle of twice the side consists of.
template <class Visit>
void for_quarters(const PixelRect& rect, int side, const Visit& visit) {
    for (int y = rect.y0; y < rect.y1; y += side)
        for (int x = rect.x0; x < rect.x1; x += side)
            visit(PixelRect{x, y, std::min(x + side, rect.x1), std::min(y + side, rect.y1)});
}

}  // namespace

void TileRays::gather(const View& view, const Frame& frame, const PixelRect& rect, int stride,
                      int coarser, bool in_parts) {
    rays.part_count = 0;
    const bool is_whole = rect.width() == tile_side && rect.height() == tile_side;
    TileBundles bundles;
    if (in_parts && is_whole) {
        bundles = tile_bundles(view, frame.width, frame.height, rect.x0, rect.y0);
    }
    // The one of that number, or of that rectangle where the tile is cut off.
    const auto bundle = [&](std::size_t number, const PixelRect& part_of_tile) {
        return in_parts && is_whole ? bundles[number]
                                    : bundle_around(view, frame.width, frame.height, part_of_tile);
    };
    const auto add_part = [&](std::size_t number, const PixelRect& part_of_tile) {
        const Bundle of_part = bundle(number, part_of_tile);
        rays.add_part(whole_of(of_part));
    };
    rays.bundle = bundle(0, rect);
    if (in_parts) {
        rays.add_part(whole_of(rays.bundle));
        rays.parts[0].first_part = 1;
        std::size_t number = 1;
        for_quarters(rect, 8, [&](const PixelRect& quarter) { add_part(number++, quarter); });
        rays.parts[0].end_of_parts = static_cast<std::uint32_t>(rays.part_count);
    }
    std::size_t count = 0, part = 1, square_number = 5;
    alignas(64) std::array<double, pixels_in_tile> u, v;
    const TilePlane plane(view, frame, rect);
    for_quarters(rect, 8, [&](const PixelRect& quarter) {
        BundlePart& of_quarter = rays.parts[part++];
        of_quarter.first = static_cast<std::uint32_t>(count);
        of_quarter.first_part = static_cast<std::uint32_t>(rays.part_count);
        for_quarters(quarter, 4, [&](const PixelRect& square) {
            const auto first = static_cast<std::uint32_t>(count);
            for (int j = first_on(stride, square.y0); j < square.y1; j += stride) {
                for (int i = first_on(stride, square.x0); i < square.x1; i += stride) {
                    if (coarser > 0 && on_stride(i, j, coarser)) continue;
                    u[count] = plane.u[static_cast<std::size_t>(i - rect.x0)];
                    v[count] = plane.v[static_cast<std::size_t>(j - rect.y0)];
                    place[count] =
                        static_cast<std::uint16_t>((j - rect.y0) * rect.width() + i - rect.x0);
                    pixel[count++] = static_cast<std::uint32_t>(frame.at(i, j));
                }
            }
            const std::size_t number = square_number++;
            if (!in_parts || first == count) return;
            add_part(number, square);
            rays.parts[rays.part_count - 1].first = first;
            rays.parts[rays.part_count - 1].end = static_cast<std::uint32_t>(count);
        });
        of_quarter.end = static_cast<std::uint32_t>(count);
        of_quarter.end_of_parts = static_cast<std::uint32_t>(rays.part_count);
    });
    rays.count = count;
    primary_directions(view, count, u.data(), v.data(), rays.dx.data(), rays.dy.data(),
                       rays.dz.data());
    rays.has_origins = view.is_orthographic();
    if (!rays.has_origins) return;
    for (std::size_t k = 0; k < count; ++k) {
        const Vec3d origin = origin_on_plane(view, u[k], v[k]);
        rays.ox[k] = origin.x;
        rays.oy[k] = origin.y;
        rays.oz[k] = origin.z;
    }
}

}  // namespace ivory
