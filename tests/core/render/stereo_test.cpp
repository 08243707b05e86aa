// Two eyes' pictures as one.
#include "core/render/stereo.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>

namespace ivory {
namespace {

constexpr std::array<Rgba8, 4> left{Rgba8{255, 0, 0, 255}, Rgba8{0, 255, 0, 255},
                                    Rgba8{10, 20, 30, 255}, Rgba8{255, 255, 255, 255}};
constexpr std::array<Rgba8, 4> right{Rgba8{0, 0, 255, 255}, Rgba8{200, 100, 50, 255},
                                     Rgba8{0, 0, 0, 255}, Rgba8{1, 2, 3, 255}};

TEST(Stereo, TheLeftPictureStandsOnTheLeft) {
    const std::vector<Rgba8> both = side_by_side(left.data(), right.data(), 2, 2);
    const std::vector<Rgba8> expected{left[0], left[1], right[0], right[1],
                                      left[2], left[3], right[2], right[3]};
    EXPECT_EQ(both, expected);
}

// By the formulas of IEC 61966-2-1 and ITU-R BT.709.
int grey(const Rgba8& color) {
    const auto linear = [](int byte) {
        const double x = byte / 255.0;
        return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
    };
    const double light =
        0.2126 * linear(color.r) + 0.7152 * linear(color.g) + 0.0722 * linear(color.b);
    const double curve =
        light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
    return static_cast<int>(std::lround(255 * curve));
}

TEST(Stereo, RedIsTheLeftEyesGreyAndTheRestTheRights) {
    const std::vector<Rgba8> both = red_cyan(left.data(), right.data(), 2, 2);
    for (std::size_t p = 0; p < both.size(); ++p) {
        EXPECT_LE(std::abs(both[p].r - grey(left[p])), 1) << p;
        EXPECT_LE(std::abs(both[p].g - grey(right[p])), 1) << p;
        EXPECT_EQ(both[p].b, both[p].g);
    }
    EXPECT_EQ(both[3].r, 255);
    EXPECT_EQ(both[2].g, 0);
}

}  // namespace
}  // namespace ivory
