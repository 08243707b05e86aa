// The camera of a scene without one: the surface fills the picture, and none of it is outside.
#include "core/render/framing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/math/direction.h"
#include "core/render/render.h"
#include "core/scene/scene_json.h"
#include "tests/error_line.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

constexpr double aspects[] = {0.3, 1, 16.0 / 9, 3};

Scene scene_of(std::vector<Element> elements, double threshold = 0.5) {
    Scene scene;
    scene.threshold = threshold;
    scene.elements = std::move(elements);
    return scene;
}

// The pixels that may be hit, as shares of the picture's half width and half height from its
// middle.
struct Seen {
    std::size_t count = 0;
    double left = 1, right = -1, bottom = 1, top = -1;  // middles of pixels
    double width_share = 0, height_share = 0;           // spanned, whole pixels
};

Seen look(Scene scene, const Camera& camera, int width, int height) {
    scene.camera = camera;
    Canvas canvas(width, height, false);
    render(make_picture(scene, width, height, *find_method("proved"), {.tolerance = 1e-4}), canvas,
           {});
    Seen seen;
    for (int j = 0; j < height; ++j) {
        for (int i = 0; i < width; ++i) {
            if (!possibly_hit(canvas.frame.status[canvas.frame.at(i, j)])) continue;
            ++seen.count;
            const double x = 2 * (i + 0.5) / width - 1, y = 1 - 2 * (j + 0.5) / height;
            seen.left = std::min(seen.left, x);
            seen.right = std::max(seen.right, x);
            seen.bottom = std::min(seen.bottom, y);
            seen.top = std::max(seen.top, y);
        }
    }
    seen.width_share = 0.5 * (seen.right - seen.left) + 1.0 / width;
    seen.height_share = 0.5 * (seen.top - seen.bottom) + 1.0 / height;
    return seen;
}

// No pixel of a picture with twice the width and height around the same view is hit outside the
// middle; and of the picture itself so much is spanned.
void expect_framed(const Scene& scene, double aspect, double least_span) {
    constexpr int height = 256;
    const int width = static_cast<int>(std::lround(aspect * height));
    Scene bare = scene;
    bare.camera.reset();
    const Camera camera = camera_of(bare, compile(bare), width, height);
    const Seen seen = look(bare, camera, width, height);
    if (seen.count > 0) {
        EXPECT_GE(std::max(seen.width_share, seen.height_share), least_span)
            << seen.width_share << " x " << seen.height_share;
    }
    Camera wider = camera;
    const double s = std::tan(camera.fov / 2 * std::acos(-1.0) / 180);
    wider.fov = 2 * std::atan(2 * s) * 180 / std::acos(-1.0);
    const Seen around = look(bare, wider, width, height);
    if (around.count == 0) return;
    for (const double share : {around.left, around.right, around.bottom, around.top}) {
        EXPECT_LE(2 * std::abs(share), framed_share);
    }
}

TEST(Framing, TheScenesOfTheProjectFillTheirPictures) {
    for (const auto& entry :
         fs::directory_iterator(fs::path(IVORY_SOURCE_DIR) / "assets" / "scenes")) {
        const Scene scene = read_scene(entry.path());
        for (const double aspect : aspects) {
            SCOPED_TRACE(entry.path().filename().string() + " " + std::to_string(aspect));
            expect_framed(scene, aspect, 0.85);
        }
    }
}

TEST(Framing, RandomScenesFillTheirPictures) {
    const std::uint64_t seed = tools::announced_seed(20261128);
    std::uint64_t n = 0;
    for (const std::size_t elements : {1, 2, 3, 5, 9, 17, 40}) {
        for (const double scale : {1e-6, 1.0, 1e6}) {
            const Scene scene =
                tools::random_scene({.elements = elements, .scale = scale}, seed + ++n);
            const double aspect = aspects[n % std::size(aspects)];
            SCOPED_TRACE("scene " + std::to_string(seed + n) + " " + std::to_string(elements) +
                         " " + std::to_string(scale));
            expect_framed(scene, aspect, 0.75);
        }
    }
}

TEST(Framing, ClustersAreFramedAsElementsAre) {
    const Scene scene = tools::mixed_scene(3000, 7);
    ASSERT_FALSE(compile(scene).clusters.empty());
    for (const double aspect : {0.5, 1.5}) expect_framed(scene, aspect, 0.85);
}

// A ball of radius r fills the picture from edge to edge of the middle.
TEST(Framing, ABallFillsThePicturesHeight) {
    const Scene ball = scene_of({{.skeleton = PointSkeleton{{1, -2, 3}}}});
    const Framing framing = frame_surface(compile(ball), {{0.4, 0.3, 1}, {0, 0, 0}}, 16.0 / 9);
    EXPECT_FALSE(framing.empty);
    const double radius = std::sqrt(std::log(2));
    const Vec3d back = framing.camera.position - framing.camera.target;
    const double distance = std::sqrt(dot(back, back));
    const double half_angle = std::atan(0.96 * std::tan(20 * std::acos(-1.0) / 180));
    EXPECT_NEAR(distance, radius / std::sin(half_angle), 0.01 * distance);
    EXPECT_GT(distance, radius / std::sin(half_angle));
    EXPECT_NEAR(framing.camera.target.x, 1, 1e-9);
    EXPECT_NEAR(framing.camera.target.y, -2, 1e-9);
    EXPECT_NEAR(framing.camera.target.z, 3, 1e-9);
    EXPECT_LT(framing.cells, 1000u);
    const Seen seen = look(ball, framing.camera, 455, 256);
    EXPECT_GE(seen.height_share, 0.93);
}

TEST(Framing, IsSeenFromTheDirectionOfTheContract) {
    const Camera camera = default_camera(
        compile(scene_of({{.skeleton = SegmentSkeleton{{0, 0, 0}, {3, 1, 2}}}})), 16.0 / 9);
    EXPECT_EQ(camera.fov, 40);
    EXPECT_EQ(camera.up, (Vec3d{0, 1, 0}));
    const Vec3d back = unit(camera.position - camera.target), wanted = unit(Vec3d{0.4, 0.3, 1});
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(back[k], wanted[k], 1e-12);
}

TEST(Framing, FarFromTheOriginItStillHolds) {
    for (const Vec3d at : {Vec3d{500000, 4500000, 120}, Vec3d{-5e6, 5e6, 5e6}}) {
        expect_framed(scene_of({{.skeleton = PointSkeleton{at}},
                                {.skeleton = PointSkeleton{at + Vec3d{1, 0.5, 0}}}}),
                      1.5, 0.85);
    }
}

TEST(Framing, AnyDirectionAndFieldOfView) {
    const Scene scene =
        scene_of({{.skeleton = CircleSkeleton{{0, 0, 0}, {1, 2, 3}, 2}, .width = 0.3},
                  {.skeleton = PointSkeleton{{1, 0, 0}}, .strength = -0.4}});
    const Field field = compile(scene);
    for (const Camera& from : {Camera{{0, 5, 1e-3}, {0, 0, 0}, {0, 0, 1}, 10},
                               Camera{{-3, 0, 1}, {0, 9, 0}, {0, 1, 0.5}, 120}}) {
        const Framing framing = frame_surface(field, from, 1.5);
        EXPECT_EQ(framing.camera.fov, from.fov);
        EXPECT_EQ(framing.camera.up, from.up);
        const Seen seen = look(scene, framing.camera, 384, 256);
        EXPECT_GE(std::max(seen.width_share, seen.height_share), 0.85);
        EXPECT_LE(std::max({-seen.left, seen.right, -seen.bottom, seen.top}), framed_share);
    }
}

// From any direction an orthographic picture is filled, and neither its sides nor its plane cut the
// surface: from twice as far away and twice as high the same is hit.
TEST(Framing, OrthographicPicturesAreFilledToo) {
    const std::uint64_t seed = tools::announced_seed(20261130);
    std::uint64_t n = 0;
    for (const std::size_t elements : {1, 2, 5, 17, 40}) {
        for (const double scale : {1e-6, 1.0, 1e6}) {
            const Scene scene =
                tools::random_scene({.elements = elements, .scale = scale}, seed + ++n);
            SCOPED_TRACE("scene " + std::to_string(seed + n));
            constexpr int height = 256;
            // even, so that the larger picture has the same rays
            const int width =
                2 * static_cast<int>(std::lround(aspects[n % std::size(aspects)] * height / 2));
            Camera from{{1.0 * static_cast<double>(n % 3) - 1, 0.3, 1}, {0, 0, 0}};
            from.projection = Camera::Projection::orthographic;
            const Framing framing =
                frame_surface(compile(scene), from, static_cast<double>(width) / height);
            const Camera& camera = framing.camera;
            EXPECT_EQ(camera.projection, from.projection);
            ASSERT_TRUE(camera.height);
            if (framing.empty) continue;
            const Seen seen = look(scene, camera, width, height);
            EXPECT_GE(std::max(seen.width_share, seen.height_share), 0.75);
            Camera wider = camera;
            wider.height = 2 * *camera.height;
            wider.position = camera.target + 2.0 * (camera.position - camera.target);
            const Seen around = look(scene, wider, 2 * width, 2 * height);
            EXPECT_EQ(around.count, seen.count);
            for (const double share : {around.left, around.right, around.bottom, around.top}) {
                EXPECT_LE(2 * std::abs(share), framed_share);
            }
        }
    }
}

TEST(Framing, ABallFillsAnOrthographicPicturesHeight) {
    const Scene ball = scene_of({{.skeleton = PointSkeleton{{1, -2, 3}}}});
    Camera from{{0.4, 0.3, 1}, {0, 0, 0}};
    from.projection = Camera::Projection::orthographic;
    const Camera camera = frame_surface(compile(ball), from, 16.0 / 9).camera;
    const double diameter = 2 * std::sqrt(std::log(2));
    EXPECT_GE(framed_share * *camera.height, diameter);
    EXPECT_NEAR(framed_share * *camera.height, diameter, 0.01 * diameter);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(camera.target[k], (Vec3d{1, -2, 3})[k], 1e-9);
}

TEST(Framing, AnEmptySurfaceIsTheUnitBox) {
    const Field none = compile(scene_of({}));
    const Camera box = default_camera(none, 1.5);
    EXPECT_TRUE(frame_surface(none, {{0.4, 0.3, 1}, {0, 0, 0}}, 1.5).empty);
    EXPECT_NEAR(box.target.x, 0, 0.2);
    // Balls that reach, and yet nowhere add up to T: known from the search alone.
    const Field two = compile(scene_of({{.skeleton = PointSkeleton{{5, 0, 0}}, .strength = 0.7},
                                        {.skeleton = PointSkeleton{{9, 0, 0}}, .strength = 0.7}},
                                       0.9));
    EXPECT_FALSE(two.box.empty());
    EXPECT_TRUE(frame_surface(two, {{0.4, 0.3, 1}, {0, 0, 0}}, 1.5).empty);
    EXPECT_EQ(default_camera(two, 1.5), box);
    // The strengths cancel.
    const Field carved =
        compile(scene_of({{.skeleton = PointSkeleton{{5, 0, 0}}},
                          {.skeleton = PointSkeleton{{5, 0, 0}}, .strength = -0.8}}));
    EXPECT_EQ(default_camera(carved, 1.5), box);
}

TEST(Framing, TheFieldIsTheSameForAnyThreadsAndSoIsTheCamera) {
    const Scene scene = tools::mixed_scene(20000, 3);
    const Camera one = default_camera(compile(scene, 1), 1.7);
    EXPECT_EQ(one, default_camera(compile(scene, 3), 1.7));
}

TEST(Framing, ItsWorkIsLimited) {
    for (const std::size_t elements : {1, 10, 100, 5000}) {
        const Scene scene = tools::mixed_scene(elements, 11);
        const Framing framing = frame_surface(compile(scene), {{0.4, 0.3, 1}, {0, 0, 0}}, 1.7);
        EXPECT_LE(framing.cells, 65700u) << elements;
        EXPECT_LE(framing.element_evaluations, 100000u + 80 * elements) << elements;
    }
}

// T is what the field has at its one maximum: the surface is a point, and not known to be empty.
TEST(Framing, ASurfaceThatIsAPointIsStillSeen) {
    for (const double at : {0.0, 1.0, -1e12}) {
        const Scene scene = scene_of({{.skeleton = PointSkeleton{{at, at, at}}}}, 1);
        EXPECT_NO_THROW(static_cast<void>(make_view(default_camera(compile(scene), 1)))) << at;
    }
}

TEST(Framing, WhatDoublesCannotFrameIsRefused) {
    const Scene scene =
        scene_of({{.skeleton = SegmentSkeleton{{-1e308, 0, 0}, {1.7e308, 1e308, 1}}}});
    EXPECT_NE(tests::error_line([&] {
                  static_cast<void>(default_camera(compile(scene), 1));
              }).find("give it a camera"),
              std::string::npos);
}

TEST(Framing, WidthsAtTheEdgesOfDoublesAreFramedOrRefused) {
    for (const double width : {1e-160, 1e-30, 1e30, 1e155, 1e300}) {
        const Scene scene = scene_of({{.skeleton = PointSkeleton{{0, 0, 0}}, .width = width}});
        try {
            const View view = make_view(default_camera(compile(scene), 1.5));
            EXPECT_TRUE(std::isfinite(view.camera.position.z)) << width;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("give it a camera"), std::string::npos);
        }
    }
}

TEST(Framing, TheScenesOwnCameraIsTaken) {
    Scene scene;
    scene.threshold = 0.5;
    scene.camera = Camera{{1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 25};
    EXPECT_EQ(camera_of(scene, compile(scene), 100, 50), *scene.camera);
    scene.camera.reset();
    EXPECT_EQ(camera_of(scene, compile(scene), 100, 50), default_camera(compile(scene), 2));
}

}  // namespace
}  // namespace ivory
