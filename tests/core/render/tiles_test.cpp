// The squares of a picture cover it, each pixel once, and lie within each other.
#include "core/render/tiles.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace ivory {
namespace {

constexpr std::array<std::array<int, 2>, 7> sizes{
    {{1, 1}, {16, 16}, {17, 15}, {64, 64}, {65, 257}, {1280, 720}, {300, 1}}};

TEST(Tiles, EachPixelLiesInOneSquare) {
    for (const auto& [width, height] : sizes) {
        const TileGrid grid(width, height);
        for (const Squares& squares : {grid.tiles, grid.blocks, grid.regions}) {
            std::vector<int> covered(static_cast<std::size_t>(width * height));
            for (std::size_t square = 0; square < squares.size(); ++square) {
                const PixelRect rect = squares.rect(square);
                EXPECT_GT(rect.area(), 0u);
                for (int j = rect.y0; j < rect.y1; ++j) {
                    for (int i = rect.x0; i < rect.x1; ++i) {
                        ++covered[static_cast<std::size_t>(j * width + i)];
                        ASSERT_EQ(squares.at(i, j), square);
                    }
                }
            }
            EXPECT_EQ(covered, std::vector<int>(covered.size(), 1)) << width << "x" << height;
        }
    }
}

TEST(Tiles, TheTilesOfABlockAreThoseInside) {
    for (const auto& [width, height] : sizes) {
        const TileGrid grid(width, height);
        std::vector<int> visited(grid.tiles.size());
        for (std::size_t block = 0; block < grid.blocks.size(); ++block) {
            const PixelRect outer = grid.blocks.rect(block);
            for_squares_in(grid.tiles, outer, [&](std::size_t tile) {
                ++visited[tile];
                const PixelRect inner = grid.tiles.rect(tile);
                EXPECT_LE(outer.x0, inner.x0);
                EXPECT_LE(outer.y0, inner.y0);
                EXPECT_GE(outer.x1, inner.x1);
                EXPECT_GE(outer.y1, inner.y1);
            });
        }
        EXPECT_EQ(visited, std::vector<int>(visited.size(), 1)) << width << "x" << height;
    }
}

}  // namespace
}  // namespace ivory
