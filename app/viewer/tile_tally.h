// How many pixels of each tile are the wanted picture's own, and how many of all have each Status:
// what the status bar tells of the work, whatever is shown of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/render/canvas.h"
#include "core/trace/ray.h"

namespace ivory {

class TileTally {
  public:
    // Another size of the picture: nothing is there.
    void lay_out(std::size_t tiles) {
        own_.assign(tiles, 0);
        tile_statuses_.assign(tiles, {});
        statuses_ = {};
    }

    // Another picture.
    void begin() { tiles_traced_ = 0; }

    // A job begins that makes these tiles anew; those of `kept` show what is not this picture's.
    void expect(const std::vector<std::uint8_t>& selected, const std::vector<std::uint8_t>& kept) {
        pixels_ = 0;
        for (std::size_t tile = 0; tile < selected.size(); ++tile) {
            if (selected[tile] != 0 || kept[tile] != 0) own_[tile] = 0;
            pixels_ += own_[tile];
        }
    }

    // The tile is so now. How many more of its pixels are there.
    std::uint64_t take(std::size_t tile, const TileState& now, bool traced) {
        if (traced && own_[tile] == 0) ++tiles_traced_;
        name_anew(tile, now.pixels);
        const int sum = std::accumulate(now.pixels.begin(), now.pixels.end(), 0);
        const auto more = static_cast<std::uint64_t>(sum - own_[tile]);
        own_[tile] = static_cast<std::uint16_t>(sum);
        pixels_ += more;
        return more;
    }

    // All of the tile's pixels are there, and are named after several samples, or no longer so.
    void name_anew(std::size_t tile, const std::array<std::uint16_t, 5>& pixels) {
        for (std::size_t status = 0; status < statuses_.size(); ++status) {
            statuses_[status] += pixels[status];
            statuses_[status] -= tile_statuses_[tile][status];
        }
        tile_statuses_[tile] = pixels;
    }

    [[nodiscard]] std::size_t own(std::size_t tile) const { return own_[tile]; }
    [[nodiscard]] std::uint64_t pixels() const { return pixels_; }
    [[nodiscard]] std::uint64_t tiles_traced() const { return tiles_traced_; }
    [[nodiscard]] std::uint64_t count(Status status) const {
        return statuses_[static_cast<std::size_t>(status)];
    }

  private:
    std::vector<std::uint16_t> own_;  // by tile: its pixels that are this picture's
    std::vector<std::array<std::uint16_t, 5>> tile_statuses_;
    std::array<std::uint64_t, 5> statuses_{};  // of all tiles
    std::uint64_t pixels_ = 0, tiles_traced_ = 0;
};

}  // namespace ivory
