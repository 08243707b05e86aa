#include "app/viewer/picture_board.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/render/tiles.h"
#include "core/trace/ray.h"

namespace ivory {

Readiness PictureBoard::readiness() const {
    if (number == 0 || !blocks_.complete() || !fault.empty()) return Readiness::partial;
    return blocks_.all_fine() ? Readiness::fine : Readiness::coarse;
}

void PictureBoard::begin(std::uint64_t new_number, const PictureRequest& new_request,
                         const std::vector<std::uint8_t>& missing, bool surface_empty) {
    number = new_number;
    request = new_request;
    if (laid_out_ != request.size) lay_out(request.size, missing.size());
    blocks_.begin(missing);
    tally.begin();
    certainly_empty = surface_empty;
    final = false;
    fault.clear();
}

void PictureBoard::lay_out(WindowSize size, std::size_t tiles) {
    laid_out_ = {};  // until all of it is there
    const auto pixels =
        static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
    color_.resize(pixels);
    depth_.resize(pixels);
    changed_.clear();
    is_changed_.assign(tiles, 0);
    is_covered_.assign(tiles, 0);
    tally.lay_out(tiles);
    laid_out_ = size;
}

void PictureBoard::expect(const std::vector<std::uint8_t>& selected,
                          const std::vector<std::uint8_t>& kept, bool job_traces) {
    tracing_ = job_traces;
    tally.expect(selected, kept);
}

// --- from the workers ---

std::uint64_t PictureBoard::take(const TileNotice& notice, const Canvas& canvas) {
    const TileState& tile = canvas.tiles[notice.tile];
    const PixelRect& rect = notice.rect;
    const bool same = notice.same && is_covered_[notice.tile] == 0;
    is_covered_[notice.tile] = 0;
    if (!same && notice.stride == 1) {
        for (int j = rect.y0; j < rect.y1; ++j)
            take_row(canvas.frame, canvas.frame.at(rect.x0, j), rect.width(), tile.empty);
    } else if (!same) {
        take_blocks(notice, canvas.frame);
    }
    const bool stands_for_others = notice.square > TileGrid::tile_side;
    shows(notice.tile, stands_for_others ? notice.square : notice.stride, !same);
    if (stands_for_others) spread(notice, canvas);
    return tally.take(notice.tile, tile, tracing_);
}

void PictureBoard::take_pixel(const Frame& frame, std::size_t from, std::size_t to) {
    color_[to] = frame.color[from];
    depth_[to] = possibly_hit(frame.status[from]) ? static_cast<float>(midpoint(frame.t(from)))
                                                  : std::numeric_limits<float>::infinity();
}

void PictureBoard::take_row(const Frame& frame, std::size_t first, int count, bool misses) {
    const auto columns = static_cast<std::size_t>(count);
    std::copy_n(&frame.color[first], columns, &color_[first]);
    if (!tracing_) return;  // the depth is what it was
    std::fill_n(&depth_[first], columns, std::numeric_limits<float>::infinity());
    if (misses) return;
    for (std::size_t p = first; p < first + columns; ++p)
        if (possibly_hit(frame.status[p])) depth_[p] = static_cast<float>(midpoint(frame.t(p)));
}

// --- what is coarse: a pixel stands for those to its right and below that are not traced yet ---

void PictureBoard::take_blocks(const TileNotice& notice, const Frame& frame) {
    for (int j = notice.rect.y0; j < notice.rect.y1; ++j)
        for (int i = notice.rect.x0; i < notice.rect.x1; ++i)
            take_pixel(frame, frame.at(i - i % notice.stride, j - j % notice.stride),
                       frame.at(i, j));
}

// The first pixel of the tile over the others of its square that have nothing finer.
void PictureBoard::spread(const TileNotice& notice, const Canvas& canvas) {
    const Squares& tiles = canvas.grid.tiles;
    const std::size_t from = canvas.frame.at(notice.rect.x0, notice.rect.y0);
    const int x0 = notice.rect.x0 - notice.rect.x0 % notice.square;
    const int y0 = notice.rect.y0 - notice.rect.y0 % notice.square;
    const PixelRect square{x0, y0, std::min(x0 + notice.square, canvas.frame.width),
                           std::min(y0 + notice.square, canvas.frame.height)};
    for_squares_in(tiles, square, [&](std::size_t tile) {
        if (!blocks_.coarser(tile, notice.square)) return;
        const PixelRect rect = tiles.rect(tile);
        for (int j = rect.y0; j < rect.y1; ++j)
            for (int i = rect.x0; i < rect.x1; ++i)
                take_pixel(canvas.frame, from, canvas.frame.at(i, j));
        is_covered_[tile] = 1;
        shows(tile, notice.square);
    });
}

void PictureBoard::shows(std::size_t tile, int pixels_a_side, bool differs) {
    blocks_.set(tile, pixels_a_side);
    if (!differs) return;
    if (is_changed_[tile] == 0) changed_.push_back(tile);
    is_changed_[tile] |= tracing_ ? 3 : 1;
}

// --- to the window ---

void PictureBoard::hand_over(ShownPicture& shown, PictureChange& change) {
    if (shown.size != request.size) {
        shown.size = request.size;
        shown.color = color_;
        shown.depth = depth_;
        change.all = true;
        std::fill(is_changed_.begin(), is_changed_.end(), std::uint8_t{0});
        changed_.clear();
        return;
    }
    const Squares& tiles = TileGrid(shown.size.width, shown.size.height).tiles;
    for (const std::size_t tile : changed_) {
        const PixelRect rect = tiles.rect(tile);
        const bool with_depth = (is_changed_[tile] & 2) != 0;
        if (hand_over_tile(rect, with_depth, shown)) change.tiles.push_back(rect);
        is_changed_[tile] = 0;
    }
    changed_.clear();
}

// Whether that changed a byte of its colours: the texture needs no more.
bool PictureBoard::hand_over_tile(const PixelRect& rect, bool with_depth,
                                  ShownPicture& shown) const {
    bool differs = false;
    const auto columns = static_cast<std::size_t>(rect.width());
    for (int j = rect.y0; j < rect.y1; ++j) {
        const std::size_t row =
            static_cast<std::size_t>(j) * static_cast<std::size_t>(shown.size.width) +
            static_cast<std::size_t>(rect.x0);
        if (std::memcmp(&shown.color[row], &color_[row], columns * sizeof(Rgba8)) != 0) {
            differs = true;
            std::copy_n(&color_[row], columns, &shown.color[row]);
        }
        if (with_depth) std::copy_n(&depth_[row], columns, &shown.depth[row]);
    }
    return differs;
}

}  // namespace ivory
