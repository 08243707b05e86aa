#include "app/viewer/picture_board.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "core/render/tiles.h"
#include "core/trace/ray.h"

namespace ivory {

void PictureBoard::begin(std::uint64_t new_number, const PictureRequest& new_request,
                         const std::vector<std::uint8_t>& missing, bool surface_empty) {
    number = new_number;
    request = new_request;
    if (laid_out_ != request.size) lay_out(request.size, missing.size());
    missing_ = 0;
    for (std::size_t tile = 0; tile < missing.size(); ++tile) {
        is_here_[tile] = missing[tile] == 0;
        missing_ += missing[tile] != 0;
    }
    seen_ = missing_ == 0 ? Seen::fine : Seen::nothing;
    coarse_ = {};
    fine_changed_ = true;
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
    is_here_.assign(tiles, 0);
    is_sampled_.assign(tiles, 0);
    tally.lay_out(tiles);
    laid_out_ = size;
}

void PictureBoard::fail(std::uint64_t new_number, const std::string& why) {
    number = new_number;
    seen_ = Seen::nothing;
    final = false;
    fault = why;
}

void PictureBoard::expect(const std::vector<std::uint8_t>& selected,
                          const std::vector<std::uint8_t>& kept, bool job_traces, bool to_be_seen) {
    tracing_ = job_traces;
    to_be_seen_ = to_be_seen;
    tally.expect(selected, kept);
}

// --- from the workers ---

std::uint64_t PictureBoard::take(const TileNotice& notice, const Canvas& canvas) {
    const TileState& tile = canvas.tiles[notice.tile];
    const PixelRect& rect = notice.rect;
    const bool stays = !to_be_seen_ && is_sampled_[notice.tile] != 0;
    // A job that was cancelled may have painted empty tiles and told nobody.
    const std::size_t corner = canvas.frame.at(rect.x0, rect.y0);
    if (!notice.same || color_[corner] != canvas.frame.color[corner]) {
        if (!stays) {
            take_colors(rect, canvas, canvas.frame.color);
            is_sampled_[notice.tile] = 0;
        }
        if (tracing_) take_depth(rect, canvas, tile.empty);  // else it is what it was
        has_changed(notice.tile, tracing_ ? 3 : 1);
    }
    if (is_here_[notice.tile] == 0) {
        is_here_[notice.tile] = 1;
        if (--missing_ == 0 && seen_ == Seen::nothing) seen_ = Seen::fine;
        fine_changed_ = fine_changed_ || seen_ == Seen::both;
    }
    return tally.take(notice.tile, tile, tracing_);
}

void PictureBoard::take_colors(const PixelRect& rect, const Canvas& canvas,
                               const Plane<Rgba8>& color) {
    for (int j = rect.y0; j < rect.y1; ++j) {
        const std::size_t first = canvas.frame.at(rect.x0, j);
        std::copy_n(&color[first], rect.width(), &color_[first]);
    }
}

void PictureBoard::take_depth(const PixelRect& rect, const Canvas& canvas, bool misses) {
    const Frame& frame = canvas.frame;
    const auto columns = static_cast<std::size_t>(rect.width());
    for (int j = rect.y0; j < rect.y1; ++j) {
        const std::size_t first = frame.at(rect.x0, j);
        std::fill_n(&depth_[first], columns, std::numeric_limits<float>::infinity());
        if (misses) continue;
        for (std::size_t p = first; p < first + columns; ++p)
            if (possibly_hit(frame.status[p])) depth_[p] = static_cast<float>(midpoint(frame.t(p)));
    }
}

void PictureBoard::has_changed(std::size_t tile, std::uint8_t what) {
    if (is_changed_[tile] == 0) changed_.push_back(tile);
    is_changed_[tile] |= what;
}

void PictureBoard::take_samples(const TileNotice& notice, const Canvas& canvas,
                                const SampledPicture& sampled) {
    take_colors(notice.rect, canvas, sampled.color);
    has_changed(notice.tile, 1);
    is_sampled_[notice.tile] = 1;
    tally.name_anew(notice.tile, sampled.pixels[notice.tile]);
}

void PictureBoard::leave_samples(const Canvas& canvas) {
    for (std::size_t tile = 0; tile < is_sampled_.size(); ++tile) {
        if (std::exchange(is_sampled_[tile], std::uint8_t{0}) == 0) continue;
        take_colors(canvas.grid.tiles.rect(tile), canvas, canvas.frame.color);
        has_changed(tile, 1);
        tally.name_anew(tile, canvas.tiles[tile].pixels);
    }
}

std::vector<std::uint8_t> PictureBoard::without_samples() const {
    std::vector<std::uint8_t> tiles(is_sampled_.size());
    for (std::size_t tile = 0; tile < tiles.size(); ++tile) tiles[tile] = is_sampled_[tile] == 0;
    return tiles;
}

void PictureBoard::take_coarse(CoarsePicture&& picture) {
    coarse_ = std::move(picture);
    coarse_is_handed_over_ = false;
    seen_ = Seen::coarse;
    fine_changed_ = true;
}

void PictureBoard::refine() {
    seen_ = Seen::both;
    fine_changed_ = true;
}

// --- to the window ---

void PictureBoard::set_fine(std::vector<std::uint8_t>& fine) const {
    if (seen_ == Seen::both)
        fine = is_here_;
    else
        fine.assign(is_here_.size(), seen_ == Seen::fine);
}

void PictureBoard::hand_over(ShownPicture& shown, PictureChange& change) {
    if (std::exchange(fine_changed_, false)) {
        set_fine(shown.fine);
        change.coarse = true;
        if (seen_ == Seen::fine) {
            shown.coarse = {};
        } else if (!std::exchange(coarse_is_handed_over_, true)) {
            shown.coarse = std::exchange(coarse_, {});
        }
    }
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

ShownPicture PictureBoard::copy() const {
    ShownPicture picture{request.size, {}, {}, {}, {}};
    if (seen_ == Seen::fine) {
        picture.color = color_;
        picture.depth = depth_;
    } else {
        picture.coarse = coarse_;
    }
    picture.fine.assign(is_here_.size(), seen_ == Seen::fine);
    return picture;
}

}  // namespace ivory
