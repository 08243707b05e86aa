// The squares that a picture is cut into: regions of 256 pixels a side, blocks of 64, tiles of 16.
// Lists of elements are handed down from each to the next; work is dealt out in blocks.
#pragma once

#include <algorithm>
#include <cstddef>

namespace ivory {

// Columns x0 <= i < x1 and rows y0 <= j < y1, rows counted from the top.
struct PixelRect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    [[nodiscard]] constexpr int width() const { return x1 - x0; }
    [[nodiscard]] constexpr int height() const { return y1 - y0; }
    [[nodiscard]] constexpr std::size_t area() const {
        return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
    }
    friend constexpr bool operator==(const PixelRect&, const PixelRect&) = default;
};

// And so many pixels more on each side.
[[nodiscard]] constexpr PixelRect widened(const PixelRect& rect, int by) {
    return {rect.x0 - by, rect.y0 - by, rect.x1 + by, rect.y1 + by};
}

// The same part of a picture of so many times as many columns and rows.
[[nodiscard]] constexpr PixelRect times(const PixelRect& rect, int factor) {
    return {rect.x0 * factor, rect.y0 * factor, rect.x1 * factor, rect.y1 * factor};
}

// The squares of one size, numbered row by row from the top left; those at the right and at the
// bottom are cut off by the picture's edge.
//
//   0 1 2 .   side 16, picture 56 x 40: 4 across, 3 down
//   4 5 6 .
//   . . . .
class Squares {
  public:
    constexpr Squares(int width, int height, int side)
        : width_(width),
          height_(height),
          side_(side),
          across_((width + side - 1) / side),
          down_((height + side - 1) / side) {}

    [[nodiscard]] constexpr int across() const { return across_; }
    [[nodiscard]] constexpr int down() const { return down_; }
    [[nodiscard]] constexpr std::size_t size() const {
        return static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_);
    }

    [[nodiscard]] constexpr PixelRect rect(std::size_t square) const {
        const int x0 = static_cast<int>(square) % across_ * side_;
        const int y0 = static_cast<int>(square) / across_ * side_;
        return {x0, y0, std::min(x0 + side_, width_), std::min(y0 + side_, height_)};
    }

    // The square that holds the pixel.
    [[nodiscard]] constexpr std::size_t at(int i, int j) const {
        return static_cast<std::size_t>(j / side_) * static_cast<std::size_t>(across_) +
               static_cast<std::size_t>(i / side_);
    }

  private:
    int width_, height_, side_, across_, down_;
};

struct TileGrid {
    static constexpr int tile_side = 16, block_side = 64, region_side = 256;  // pixels

    Squares tiles, blocks, regions;

    constexpr TileGrid(int width, int height)
        : tiles(width, height, tile_side),
          blocks(width, height, block_side),
          regions(width, height, region_side) {}
};

// Calls visit(index) for each square of `squares` that lies in `rect`, row by row; `rect` is a
// square of a coarser size of the same picture.
template <class Visit>
constexpr void for_squares_in(const Squares& squares, const PixelRect& rect, const Visit& visit) {
    const std::size_t first = squares.at(rect.x0, rect.y0);
    const std::size_t last = squares.at(rect.x1 - 1, rect.y1 - 1);
    const auto across = static_cast<std::size_t>(squares.across());
    const std::size_t columns = last % across - first % across + 1;
    for (std::size_t row = first; row <= last; row += across) {
        for (std::size_t square = row; square < row + columns; ++square) visit(square);
    }
}

}  // namespace ivory
