// Primary rays by the formula, cones that hold them, and the camera of a scene without one.
#include "core/render/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/math/direction.h"
#include "core/render/camera_lanes.h"
#include "core/scene/error.h"
#include "tests/error_line.h"

namespace ivory {
namespace {

// 64 bits of mantissa: eleven more than what is tested.
using Real = long double;
using Vec3l = Vec3<Real>;

Vec3l widened(const Vec3d& v) { return {v.x, v.y, v.z}; }

Real length(const Vec3l& v) { return std::sqrt(dot(v, v)); }

Vec3l normalized(const Vec3l& v) { return Real(1) / length(v) * v; }

Vec3l direction_by_the_formula(const Camera& camera, int width, int height, int i, int j) {
    const Vec3l forward = normalized(widened(camera.target) - widened(camera.position));
    const Vec3l right = normalized(cross(forward, widened(camera.up)));
    const Vec3l top = cross(right, forward);
    const Real s = std::tan(camera.fov / Real(2) * std::numbers::pi_v<Real> / 180);
    const Real u = (2 * (i + Real(0.5)) / width - 1) * s * width / height;
    const Real v = (1 - 2 * (j + Real(0.5)) / height) * s;
    return normalized(forward + u * right + v * top);
}

std::vector<Camera> cameras() {
    return {
        {{0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 40},
        {{2.2, 2.6, 7.2}, {0.1, 0, -0.3}, {0, 1, 0}, 40},
        {{-5, 1, 0.5}, {0, 0, 0}, {0.3, 0.2, 5}, 100},
        {{1e6, 1e6, 1e6}, {1e6 + 1, 1e6, 1e6}, {0, 0, 1}, 12},
        {{3e-7, 0, 1e-6}, {0, 0, 0}, {0, 1e9, 0}, 60},
        {{0, 5, 1e-7}, {0, 0, 0}, {0, 1, 0}, 170},
        {{0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 179.9999999},
        {{0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 1e-9},
    };
}

TEST(Camera, PrimaryRaysAreThoseOfTheFormula) {
    constexpr std::array<std::array<int, 2>, 4> sizes{{{1280, 720}, {33, 77}, {1, 1}, {2, 999}}};
    for (const Camera& camera : cameras()) {
        const View view = make_view(camera);
        // An up direction near the line of sight magnifies the rounding of their cross product.
        const Vec3l forward = normalized(widened(camera.target) - widened(camera.position));
        const Real tilt = length(cross(forward, normalized(widened(camera.up))));
        for (const auto& [width, height] : sizes) {
            for (const int i : {0, width / 3, width - 1}) {
                for (const int j : {0, height / 2, height - 1}) {
                    const Ray ray = primary_ray(view, width, height, i, j);
                    const Vec3l exact = direction_by_the_formula(camera, width, height, i, j);
                    EXPECT_EQ(ray.origin, camera.position);
                    EXPECT_LT(length(widened(ray.direction) - exact), 4e-15L * (1 + view.s) / tilt)
                        << camera.fov << " at " << i << ", " << j;
                    EXPECT_NEAR(static_cast<double>(length(widened(ray.direction))), 1, 4e-16);
                }
            }
        }
    }
}

TEST(Camera, RowsAreCountedFromTheTop) {
    const View view = make_view({{0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 40});
    EXPECT_GT(primary_ray(view, 8, 8, 0, 0).direction.y, 0);
    EXPECT_LT(primary_ray(view, 8, 8, 0, 0).direction.x, 0);
    EXPECT_LT(primary_ray(view, 8, 8, 7, 7).direction.y, 0);
    EXPECT_GT(primary_ray(view, 8, 8, 7, 7).direction.x, 0);
}

TEST(Camera, HugeAndTinyDistancesDoNotOverflow) {
    const View far = make_view({{0, 0, 1e300}, {0, 0, 0}, {0, 1e-300, 0}, 40});
    EXPECT_EQ(far.forward, (Vec3d{0, 0, -1}));
    EXPECT_EQ(far.top, (Vec3d{0, 1, 0}));
    const View near = make_view({{0, 0, 1e-300}, {0, 0, 0}, {0, 1e300, 0}, 40});
    EXPECT_EQ(near.right, (Vec3d{1, 0, 0}));
}

TEST(Camera, AFaultyCameraIsRefused) {
    EXPECT_NE(tests::error_line([] {
                  static_cast<void>(make_view({{0, 0, 8}, {0, 0, 8}, {0, 1, 0}, 40}));
              }).find("/target"),
              std::string::npos);
    EXPECT_NE(tests::error_line([] {
                  static_cast<void>(make_view({{0, 0, 8}, {0, 0, 0}, {0, 0, -2}, 40}));
              }).find("/up"),
              std::string::npos);
}

Real sine_between(const Vec3d& a, const Vec3d& b) {
    const Vec3l x = normalized(widened(a));
    const Vec3l y = normalized(widened(b));
    return length(cross(x, y));
}

TEST(Camera, AConeHoldsTheRaysOfItsRectangle) {
    constexpr int width = 200, height = 120;
    for (const Camera& camera : cameras()) {
        const View view = make_view(camera);
        for (const PixelRect& rect :
             {PixelRect{0, 0, 16, 16}, PixelRect{96, 48, 112, 64}, PixelRect{192, 112, 200, 120},
              PixelRect{37, 11, 38, 12}, PixelRect{64, 0, 128, 64}, PixelRect{0, 0, 200, 120}}) {
            const Cone cone = cone_around(view, width, height, rect);
            EXPECT_EQ(cone.apex, camera.position);
            for (int j = rect.y0; j < rect.y1; ++j) {
                for (int i = rect.x0; i < rect.x1; ++i) {
                    const Vec3d d = primary_ray(view, width, height, i, j).direction;
                    ASSERT_LE(sine_between(cone.axis, d), cone.sine) << i << ", " << j;
                    ASSERT_TRUE(cone.sine > 1 || dot(cone.axis, d) > 0);
                }
            }
        }
    }
}

// And are hardly wider than needed: bundle_around has 4 % to spare.
TEST(Camera, BundlesOfATileHoldTheRaysOfItsParts) {
    constexpr int width = 200, height = 120, i0 = 96, j0 = 48;
    int held = 0;
    for (const Camera& camera : cameras()) {
        const View view = make_view(camera);
        const TileBundles bundles = tile_bundles(view, width, height, i0, j0);
        for (int j = 0; j < 16; ++j) {
            for (int i = 0; i < 16; ++i) {
                const Vec3d d = primary_ray(view, width, height, i0 + i, j0 + j).direction;
                const int quarter = j / 8 * 2 + i / 8, square = j % 8 / 4 * 2 + i % 8 / 4;
                for (const int k : {0, 1 + quarter, 5 + quarter * 4 + square}) {
                    const Bundle& bundle = bundles[static_cast<std::size_t>(k)];
                    if (bundle.spread > 0.5) continue;  // too wide: nobody relies on it
                    ++held;
                    const Vec3l off = widened(d) - widened(bundle.axis);
                    ASSERT_LE(length(off), Real(bundle.spread)) << i << ", " << j << ", " << k;
                    ASSERT_LE(std::abs(length(widened(bundle.axis)) - 1), 0x1p-50L);
                }
            }
        }
        const Bundle whole = bundle_around(view, width, height, {i0, j0, i0 + 16, j0 + 16});
        if (whole.spread <= 0.5) {
            EXPECT_LT(bundles[0].spread, whole.spread);
        }
        EXPECT_LT(bundles[5].spread, bundles[1].spread);
    }
    EXPECT_GT(held, 256);
}

TEST(Camera, AnOrthographicCamerasBundlesHoldItsRays) {
    constexpr int width = 200, height = 120, i0 = 96, j0 = 48;
    for (const double far : {1.0, 1e9}) {
        Camera camera{{3 * far, 2, 7}, {3 * far + 1, 0.5, 0}, {0, 1, 0.2}, 40};
        camera.projection = Camera::Projection::orthographic;
        const View view = make_view(camera);
        EXPECT_NEAR(2 * view.s, height_of(camera), 1e-15 * view.s);
        const TileBundles bundles = tile_bundles(view, width, height, i0, j0);
        const auto expect_held = [&](const Bundle& bundle, int i, int j) {
            const Ray ray = primary_ray(view, width, height, i, j);
            const Vec3l aside = widened(ray.origin) - widened(bundle.origin);
            ASSERT_LE(length(aside), Real(bundle.radius)) << i << ", " << j;
            ASSERT_LE(std::abs(dot(aside, widened(bundle.axis))),
                      Real(bundle.spread) * Real(bundle.radius));
            ASSERT_LE(length(widened(ray.direction) - widened(bundle.axis)), Real(bundle.spread));
        };
        for (int j = 0; j < 16; ++j) {
            for (int i = 0; i < 16; ++i) {
                const int quarter = j / 8 * 2 + i / 8, square = j % 8 / 4 * 2 + i % 8 / 4;
                for (const int k : {0, 1 + quarter, 5 + quarter * 4 + square}) {
                    expect_held(bundles[static_cast<std::size_t>(k)], i0 + i, j0 + j);
                }
                expect_held(bundle_around(view, width, height, {i0, j0, i0 + 16, j0 + 16}), i0 + i,
                            j0 + j);
            }
        }
        if (far > 1) continue;
        // and are hardly wider than needed: half a diagonal
        const double pixel = height_of(camera) / height;
        EXPECT_LT(bundles[5].radius, 1.001 * 1.5 * std::sqrt(2.0) * pixel);
        EXPECT_LT(bundles[5].spread, 1e-12);
    }
}

TEST(Camera, AnOrthographicRayIsThatOfTheContract) {
    Camera camera{{1, 2, 7}, {0.5, -1, 0.25}, {0.1, 1, 0}, 40};
    camera.projection = Camera::Projection::orthographic;
    camera.height = 3;
    const View view = make_view(camera);
    const Ray ray = primary_ray(view, 320, 180, 17, 101);
    EXPECT_EQ(ray.direction, view.forward);
    const double u = (2 * 17.5 / 320 - 1) * (320.0 / 180) * 1.5, v = (1 - 2 * 101.5 / 180) * 1.5;
    const Vec3d expected = camera.position + u * view.right + v * view.top;
    const Vec3d off = ray.origin - expected;
    EXPECT_LT(std::sqrt(dot(off, off)), 1e-14);
    EXPECT_THROW((void)eye_of(view, Eye::left, 0.1), Error);
}

// Both eyes see a point of the window in the same pixel; one that is as far again behind it half the eyes'
// distance to the outside.
TEST(Camera, EyesLookThroughTheSameWindow) {
    const View view = make_view({{1, 2, 7}, {0.5, -1, 0.25}, {0.1, 1, 0}, 40});
    constexpr int width = 320, height = 180;
    const double z = std::sqrt(
        dot(view.camera.target - view.camera.position, view.camera.target - view.camera.position));
    EXPECT_DOUBLE_EQ(usual_eye_distance(view.camera), z / 30);
    for (const Eye eye : {Eye::left, Eye::right}) {
        const View seen = eye_of(view, eye, 0.4);
        for (const int i : {0, 50, 319}) {
            for (const int j : {0, 90, 179}) {
                const Ray from_eye = primary_ray(seen, width, height, i, j);
                const Ray from_middle = primary_ray(view, width, height, i, j);
                const double t_eye = z / dot(from_eye.direction, view.forward);
                const double t_middle = z / dot(from_middle.direction, view.forward);
                const Vec3d off = (from_eye.origin + t_eye * from_eye.direction) -
                                  (from_middle.origin + t_middle * from_middle.direction);
                EXPECT_LT(std::sqrt(dot(off, off)), 1e-13);
                // twice as far away
                const Vec3d behind = (from_eye.origin + 2 * t_eye * from_eye.direction) -
                                     (from_middle.origin + 2 * t_middle * from_middle.direction);
                EXPECT_NEAR(dot(behind, view.right), eye == Eye::left ? 0.2 : -0.2, 1e-13);
            }
        }
        const Cone cone = cone_around(seen, width, height, {32, 64, 48, 80});
        for (int j = 64; j < 80; ++j) {
            for (int i = 32; i < 48; ++i) {
                const Vec3d d = primary_ray(seen, width, height, i, j).direction;
                ASSERT_LE(sine_between(cone.axis, d), cone.sine);
            }
        }
    }
}

TEST(Camera, AConeIsNoWiderThanItsCorners) {
    const View view = make_view({{2.2, 2.6, 7.2}, {0.1, 0, -0.3}, {0, 1, 0}, 40});
    const PixelRect rect{16, 32, 32, 48};
    const Cone cone = cone_around(view, 1280, 720, rect);
    Real widest = 0;
    for (const int i : {rect.x0, rect.x1 - 1}) {
        for (const int j : {rect.y0, rect.y1 - 1}) {
            widest = std::max(
                widest, sine_between(cone.axis, primary_ray(view, 1280, 720, i, j).direction));
        }
    }
    EXPECT_LT(cone.sine, widest + 3e-14L);
    EXPECT_LT(cone_around(view, 1280, 720, {5, 5, 6, 6}).sine, 3e-14);
}

TEST(Camera, AConeOfMoreThanAHemisphereIsEveryDirection) {
    const View view = make_view({{0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 179.9999999});
    EXPECT_GT(cone_around(view, 64, 64, {0, 0, 64, 64}).sine, 1);
}

TEST(PrimaryDirections, AreThoseOfPrimaryRaysToTheBit) {
    const View view = make_view({{3.1, -2.7, 5.3}, {0.1, 0.2, -0.3}, {0.2, 1, 0.1}, 47.3});
    constexpr int width = 131, height = 77;
    std::array<double, 16> u{}, v{}, x{}, y{}, z{};
    for (int n = 0; n < width * height; ++n) {
        const auto to = static_cast<std::size_t>(n % 13);
        u[to] = plane_u(view, width, height, n % width);
        v[to] = plane_v(view, height, n / width);
        if (n % 13 != 12) continue;
        primary_directions(view, 13, u.data(), v.data(), x.data(), y.data(), z.data());
        for (int k = 0; k < 13; ++k) {
            const int pixel = n - 12 + k, i = pixel % width, j = pixel / width;
            const Ray ray = primary_ray(view, width, height, i, j);
            const auto at = static_cast<std::size_t>(k);
            ASSERT_EQ(ray.direction, (Vec3d{x[at], y[at], z[at]})) << i << ", " << j;
        }
    }
}

}  // namespace
}  // namespace ivory
