// Bytes of sRGB, and what light has to do whatever its taste.
#include "core/render/shade.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/math/direction.h"

namespace ivory {
namespace {

double srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

TEST(Srgb, IsTheCurveToTheNearestByte) {
    for (int n = 0; n <= 200000; ++n) {
        const double linear = n / 200000.0;
        const double exact = 255 * srgb(linear);
        const double byte = to_srgb({linear, 0, 0}).r;
        ASSERT_LE(std::abs(byte - exact), 0.5 + 1e-4) << linear;
    }
}

// Bytes begin where the curve says, whatever bin that is in: at the floats next to each beginning.
TEST(Srgb, EveryByteBeginsWhereItShould) {
    for (int k = 1; k < 256; ++k) {
        const double s = (k - 0.5) / 255;
        const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
        const auto least = static_cast<float>(linear);
        EXPECT_EQ(srgb_table().byte(least), k);
        EXPECT_EQ(srgb_table().byte(std::nextafter(least, 0.0F)), k - 1);
        EXPECT_EQ(srgb_table().byte(std::nextafter(least, 1.0F)), k);
    }
    EXPECT_EQ(srgb_table().byte(std::nextafter(1.0F, 0.0F)), 255);
}

TEST(Srgb, IsClampedAndOpaque) {
    EXPECT_EQ(to_srgb({-1, 0, 1e-300}), (Rgba8{0, 0, 0, 255}));
    EXPECT_EQ(to_srgb({1, 1.0001, 1e300}), (Rgba8{255, 255, 255, 255}));
    EXPECT_EQ(to_srgb({std::nan(""), 0.5, std::nextafter(1.0, 0.0)}), (Rgba8{0, 188, 255, 255}));
}

View front_view() { return make_view({{0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 40}); }

int brightness(const Rgba8& color) { return color.r + color.g + color.b; }

TEST(Shade, TheBackgroundIsTheScenes) {
    Scene scene;
    scene.background = {1, 0, 0.5};
    EXPECT_EQ(make_lighting(scene, front_view()).background, (Rgba8{255, 0, 188, 255}));
}

TEST(Shade, NoSideIsBlackWithoutALamp) {
    Scene scene;
    scene.lights.emplace();
    const Lighting dark = make_lighting(scene, front_view());
    for (const Vec3d& normal : {Vec3d{0, 1, 0}, Vec3d{0, -1, 0}, Vec3d{0, 0, 1}}) {
        EXPECT_GT(brightness(shade(dark, {0, 0, -1}, {normal, {0.5, 0.5, 0.5}})), 30);
    }
}

TEST(Shade, ALampMakesNothingDarker) {
    Scene scene;
    scene.lights.emplace();
    const Lighting dark = make_lighting(scene, front_view());
    scene.lights->push_back({{1, 1, 1}, {1, 0.9, 0.8}, 0.7, false});
    const Lighting lit = make_lighting(scene, front_view());
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    for (int n = 0; n < 1000; ++n) {
        const Vec3d d = unit(Vec3d{normal(random), normal(random), normal(random)});
        const SurfacePoint point{unit(Vec3d{normal(random), normal(random), normal(random)}),
                                 {0.7, 0.4, 0.2}};
        const Rgba8 without = shade(dark, d, point);
        const Rgba8 with = shade(lit, d, point);
        ASSERT_GE(with.r, without.r);
        ASSERT_GE(with.g, without.g);
        ASSERT_GE(with.b, without.b);
    }
}

TEST(Shade, ASideSeenFromInsideIsLitLikeTheOutside) {
    const Lighting lighting = make_lighting(Scene{}, front_view());
    const Color color{0.3, 0.6, 0.9};
    const Vec3d normal = unit(Vec3d{0.2, 0.5, 0.8});
    EXPECT_EQ(shade(lighting, {0, 0, -1}, {normal, color}),
              shade(lighting, {0, 0, -1}, {-normal, color}));
}

TEST(Shade, WithoutANormalTheSurfaceFacesTheViewer) {
    const Lighting lighting = make_lighting(Scene{}, front_view());
    EXPECT_EQ(shade(lighting, {0, 0, -1}, {{0, 0, 0}, {0.5, 0.5, 0.5}}),
              shade(lighting, {0, 0, -1}, {{0, 0, 1}, {0.5, 0.5, 0.5}}));
}

TEST(Shade, LampsOfTheCameraTurnWithIt) {
    Scene scene;
    scene.lights = {Light{{1, 0, 0}, {1, 1, 1}, 1, true}, Light{{0, 0, 2}, {1, 1, 1}, 1, true},
                    Light{{0, 3, 0}, {1, 1, 1}, 0.5, false}};
    const View side = make_view({{8, 0, 0}, {0, 0, 0}, {0, 1, 0}, 40});
    const Lighting lighting = make_lighting(scene, side);
    ASSERT_EQ(lighting.lamps.size(), 3u);
    EXPECT_EQ(lighting.lamps[0].direction, (Vec3d{0, 0, -1}));  // right of a view along -x
    EXPECT_EQ(lighting.lamps[1].direction, (Vec3d{1, 0, 0}));   // back
    EXPECT_EQ(lighting.lamps[2].direction, (Vec3d{0, 1, 0}));
    EXPECT_EQ(lighting.lamps[2].radiance, (Color{0.5, 0.5, 0.5}));
}

TEST(Shade, LampsBehindTheSurfaceDoNotReachIt) {
    Scene scene;
    scene.lights.emplace();
    const Lighting dark = make_lighting(scene, front_view());
    // One opposite to the viewer too, where halfway between the two is nowhere.
    scene.lights = {Light{{0, 0, -1}, {1, 1, 1}, 1, false}, Light{{0, 1, -1}, {1, 1, 1}, 1, false}};
    const Lighting behind = make_lighting(scene, front_view());
    const SurfacePoint point{{0, 0, 1}, {0.5, 0.5, 0.5}};
    EXPECT_EQ(shade(behind, {0, 0, -1}, point), shade(dark, {0, 0, -1}, point));
}

}  // namespace
}  // namespace ivory
