#include "core/render/tile_rays.h"

namespace ivory {

// The one of that number, or of that rectangle where the tile is cut off.
Bundle TileRays::bundle(std::size_t number, const PixelRect& part_of_tile) const {
    return in_parts_ && is_whole_
               ? bundles_[number]
               : bundle_around(*view_, all_width_, all_height_, times(part_of_tile, n_));
}

void TileRays::look_through(const View& view, int width, int height, int n) {
    view_ = &view;
    n_ = n;
    all_width_ = width * n;
    all_height_ = height * n;
    rays.count = rays.part_count = 0;
}

void TileRays::begin(const View& view, int width, int height, const PixelRect& rect, bool in_parts,
                     int n) {
    look_through(view, width, height, n);
    in_parts_ = in_parts;
    is_whole_ = rect.width() == tile_side && rect.height() == tile_side;
    plane_.emplace(view, width, height, rect);
    if (in_parts && is_whole_) {
        bundles_ = tile_bundles(view, all_width_, all_height_, rect.x0 * n, rect.y0 * n, n);
    }
    rays.bundle = bundle(0, rect);
    if (!in_parts) return;
    rays.add_part(whole_of(rays.bundle));
    rays.parts[0].first_part = 1;
    std::size_t number = 1;
    for_quarters(rect, 8, [&](const PixelRect& quarter) {
        rays.add_part(whole_of(bundle(number++, quarter)));
    });
    rays.parts[0].end_of_parts = static_cast<std::uint32_t>(rays.part_count);
}

void TileRays::add_part(std::size_t number, const PixelRect& square, std::size_t first) {
    BundlePart part = whole_of(bundle(number, square));
    part.first = static_cast<std::uint32_t>(first);
    part.end = static_cast<std::uint32_t>(rays.count);
    rays.add_part(part);
}

void TileRays::end(const View& view) {
    primary_directions(view, rays.count, u_.data(), v_.data(), rays.dx.data(), rays.dy.data(),
                       rays.dz.data());
    rays.has_origins = view.is_orthographic();
    if (!rays.has_origins) return;
    for (std::size_t k = 0; k < rays.count; ++k) {
        const Vec3d origin = origin_on_plane(view, u_[k], v_[k]);
        rays.ox[k] = origin.x;
        rays.oy[k] = origin.y;
        rays.oz[k] = origin.z;
    }
}

void TileRays::gather_ring(const View& view, int width, int height, const PixelRect& rect, int n) {
    look_through(view, width, height, n);
    is_whole_ = false;
    in_parts_ = true;
    const PixelRect all = widened(rect, 1);
    rays.bundle = bundle(0, all);
    rays.add_part(whole_of(rays.bundle));
    const auto add_piece = [&](const PixelRect& piece) {
        const std::size_t first = rays.count;
        for (int j = piece.y0; j < piece.y1; ++j) {
            for (int i = piece.x0; i < piece.x1; ++i) {
                u_[rays.count] = plane_u(view, width, height, i);
                v_[rays.count] = plane_v(view, height, j);
                place[rays.count++] =
                    static_cast<std::uint16_t>((j - all.y0) * all.width() + i - all.x0);
            }
        }
        add_part(0, piece, first);
    };
    constexpr int side = 4;
    for (int x = all.x0; x < all.x1; x += side) {
        const int end = std::min(x + side, all.x1);
        add_piece({x, all.y0, end, rect.y0});
        add_piece({x, rect.y1, end, all.y1});
    }
    for (int y = rect.y0; y < rect.y1; y += side) {
        const int end = std::min(y + side, rect.y1);
        add_piece({all.x0, y, rect.x0, end});
        add_piece({rect.x1, y, all.x1, end});
    }
    rays.parts[0].first_part = 1;
    rays.parts[0].end_of_parts = static_cast<std::uint32_t>(rays.part_count);
    this->end(view);
}

}  // namespace ivory
