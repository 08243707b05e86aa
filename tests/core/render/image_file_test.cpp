// What is written reads back: PNG by libpng, PFM byte by byte.
#include "core/render/image_file.h"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <sstream>
#include <thread>
#include <vector>

namespace ivory {
namespace {

Frame noise(int width, int height) {
    Frame frame(width, height, false);
    std::mt19937 random(11);
    for (std::size_t p = 0; p < frame.size(); ++p) {
        const auto byte = [&] { return static_cast<std::uint8_t>(random()); };
        frame.color[p] = {byte(), byte(), byte(), 255};
        frame.status[p] = static_cast<Status>(random() % 5);
        frame.t_lo[p] = static_cast<double>(random()) / 1e6;
        frame.t_hi[p] = frame.t_lo[p] + 1e-7;
    }
    return frame;
}

TEST(ImageFile, APngReadsBackToTheSameBytes) {
    for (const auto& [width, height] : {std::pair{1, 1}, {37, 64}, {37, 65}, {640, 360}}) {
        const Frame frame = noise(width, height);
        const std::string bytes = png_bytes(frame);
        png_image image;
        std::memset(&image, 0, sizeof image);
        image.version = PNG_IMAGE_VERSION;
        ASSERT_NE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()), 0);
        EXPECT_EQ(image.width, static_cast<unsigned>(width));
        EXPECT_EQ(image.height, static_cast<unsigned>(height));
        EXPECT_EQ(image.format, static_cast<unsigned>(PNG_FORMAT_RGB));  // 8 bits, no alpha
        std::vector<png_byte> pixels(PNG_IMAGE_SIZE(image));
        ASSERT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0);
        for (std::size_t p = 0; p < frame.size(); ++p) {
            ASSERT_EQ(pixels[3 * p], frame.color[p].r);
            ASSERT_EQ(pixels[3 * p + 1], frame.color[p].g);
            ASSERT_EQ(pixels[3 * p + 2], frame.color[p].b);
        }
    }
}

// By several threads, tiles in any order, and where some are not told.
TEST(ImageFile, APictureThatIsPackedWhileItIsPaintedHasTheSameBytes) {
    for (const auto& [width, height] : {std::pair{1, 1}, {37, 64}, {37, 65}, {640, 360}}) {
        const Frame frame = noise(width, height);
        const std::string expected = png_bytes(frame);
        const Squares tiles = TileGrid(width, height).tiles;
        std::vector<std::size_t> order(tiles.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::shuffle(order.begin(), order.end(), std::mt19937(3));
        for (const std::size_t told : {tiles.size(), tiles.size() / 2, std::size_t{0}}) {
            Frame painted(width, height, false);
            GrowingPng png(PictureBytes{width, height, &painted.color[0]});
            std::atomic<std::size_t> next{0};
            const auto paint = [&] {
                for (std::size_t k = next++; k < order.size(); k = next++) {
                    const PixelRect rect = tiles.rect(order[k]);
                    for (int j = rect.y0; j < rect.y1; ++j) {
                        for (int i = rect.x0; i < rect.x1; ++i) {
                            painted.color[painted.at(i, j)] = frame.color[frame.at(i, j)];
                        }
                    }
                    if (k < told) png.painted(rect);
                }
            };
            {
                const std::jthread other(paint);
                paint();
            }
            EXPECT_TRUE(png.bytes() == expected) << width << "x" << height << ", " << told;
        }
    }
}

float little_endian_float(const char* bytes) {
    std::uint32_t bits = 0;
    for (int k = 3; k >= 0; --k) bits = bits << 8 | static_cast<unsigned char>(bytes[k]);
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

TEST(ImageFile, ADepthIsTheMidpointBottomRowFirst) {
    const Frame frame = noise(13, 7);
    const std::string bytes = depth_bytes(frame);
    const std::string header = "Pf\n13 7\n-1.0\n";
    ASSERT_TRUE(bytes.starts_with(header));
    ASSERT_EQ(bytes.size(), header.size() + 4 * frame.size());
    for (int j = 0; j < 7; ++j) {
        for (int i = 0; i < 13; ++i) {
            const std::size_t p = frame.at(i, j);
            const std::size_t at = static_cast<std::size_t>((6 - j) * 13 + i);
            const float depth = little_endian_float(bytes.data() + header.size() + 4 * at);
            EXPECT_EQ(depth, possibly_hit(frame.status[p])
                                 ? static_cast<float>(midpoint(frame.t(p)))
                                 : std::numeric_limits<float>::infinity());
        }
    }
}

TEST(ImageFile, ADepthBeyondTheFloatsIsInfinite) {
    Frame frame(1, 1, false);
    frame.status[0] = Status::unresolved;
    frame.t_lo[0] = 0;
    frame.t_hi[0] = std::numeric_limits<double>::infinity();
    const std::string bytes = depth_bytes(frame);
    EXPECT_TRUE(std::isinf(little_endian_float(bytes.data() + bytes.size() - 4)));
}

}  // namespace
}  // namespace ivory
