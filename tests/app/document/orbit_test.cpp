#include "app/document/orbit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "core/render/camera.h"
#include "core/scene/scene_fault.h"

namespace ivory {
namespace {

constexpr WindowSize size{1280, 720};

double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

double distance(const Camera& camera) { return length(camera.position - camera.target); }

void expect_near(const Vec3d& a, const Vec3d& b, double within) {
    EXPECT_LE(length(a - b), within)
        << a.x << ' ' << a.y << ' ' << a.z << " is not " << b.x << ' ' << b.y << ' ' << b.z;
}

// A view from anywhere, never near a pole.
Camera some_camera(std::mt19937_64& random) {
    std::uniform_real_distribution<double> coordinate(-5, 5);
    Camera camera;
    camera.target = {coordinate(random), coordinate(random), coordinate(random)};
    camera.position =
        camera.target + Vec3d{coordinate(random), 0.5 * coordinate(random), 6 + coordinate(random)};
    camera.fov = 20 + 8 * std::abs(coordinate(random));
    return camera;
}

Camera some_orthographic_camera(std::mt19937_64& random) {
    Camera camera = in_projection(some_camera(random), Camera::Projection::orthographic);
    if (random() % 4 == 0) camera.height.reset();
    return camera;
}

// Every other one orthographic.
Camera any_camera(std::mt19937_64& random, int trial) {
    return trial % 2 == 0 ? some_camera(random) : some_orthographic_camera(random);
}

TEST(Projection, PixelCentresLieOnThePrimaryRaysOfRender) {
    std::mt19937_64 random(1);
    for (int trial = 0; trial < 100; ++trial) {
        const Camera camera = any_camera(random, trial);
        const View view = make_view(camera);
        const Projection projection(camera, size);
        for (const auto& [i, j] : {std::pair{0, 0}, {640, 360}, {1279, 719}, {77, 600}}) {
            const Ray ray = primary_ray(view, size.width, size.height, i, j);
            const auto at = projection.project(ray.origin + 3.0 * ray.direction);
            ASSERT_TRUE(at);
            EXPECT_NEAR(at->x, i + 0.5, 1e-9);
            EXPECT_NEAR(at->y, j + 0.5, 1e-9);
            const Ray sight = projection.line_of_sight({i + 0.5, j + 0.5});
            expect_near(sight.direction, ray.direction, 1e-14);
            expect_near(sight.origin, ray.origin, 1e-13);
            EXPECT_NEAR(projection.distance_to(ray.origin + 3.0 * ray.direction), 3, 1e-12);
        }
    }
}

TEST(Projection, SeesNothingBehindTheCamera) {
    const Projection projection({{0, 0, 8}, {0, 0, 0}}, size);
    EXPECT_TRUE(projection.project({0, 0, 7.999}));
    EXPECT_FALSE(projection.project({0, 0, 8}));
    EXPECT_FALSE(projection.project({1, 2, 9}));
}

TEST(Projection, AnOrthographicOneSeesPlacesBeforeItsPlaneToo) {
    const Projection projection(
        {{0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 40, Camera::Projection::orthographic, 4.0}, size);
    const auto seen = projection.project({1, -1, 9});
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->x, size.width / 2.0 + 180);
    EXPECT_EQ(seen->y, size.height / 2.0 + 180);
    EXPECT_EQ(projection.distance_to({1, -1, 9}), -1);
}

TEST(Projection, MovedPlacesAreSeenExactlySoManyPixelsAway) {
    std::mt19937_64 random(2);
    for (int trial = 0; trial < 100; ++trial) {
        const Projection projection(any_camera(random, trial), size);
        const Vec3d place = projection.camera().target;
        const auto before = projection.project(place);
        const auto after = projection.project(projection.moved(place, 123, -45));
        ASSERT_TRUE(before && after);
        EXPECT_NEAR(after->x - before->x, 123, 1e-9);
        EXPECT_NEAR(after->y - before->y, -45, 1e-9);
    }
}

TEST(Orbit, KeepsDistanceTargetUpAndAngle) {
    std::mt19937_64 random(3);
    for (int trial = 0; trial < 100; ++trial) {
        const Camera before = any_camera(random, trial);
        const Camera after = orbited({before, size}, 137, -61);
        EXPECT_NEAR(distance(after), distance(before), 1e-12 * distance(before));
        EXPECT_EQ(after.target, before.target);
        EXPECT_EQ(after.up, before.up);
        EXPECT_EQ(after.fov, before.fov);
        EXPECT_EQ(after.height, before.height);
    }
}

TEST(Orbit, WithoutAMoveChangesNoBit) {
    std::mt19937_64 random(4);
    const Camera camera = some_camera(random);
    EXPECT_EQ(orbited({camera, size}, 0, 0), camera);
}

TEST(Orbit, AWholeTurnIsTwoHeights) {
    const Camera before{{1, 2, 7}, {0, 0, 0}};
    const Camera after = orbited({before, size}, 2 * size.height, 0);
    expect_near(after.position, before.position, 1e-12);
}

TEST(Orbit, TheSceneFollowsThePointer) {
    const Camera before{{0, 0, 8}, {0, 0, 0}};
    // what is nearest to the camera goes right and down with the pointer
    const Vec3d nearest{0, 0, 1};
    const Projection right(orbited({before, size}, 40, 0), size);
    EXPECT_GT(right.project(nearest)->x, size.width / 2.0);
    const Projection down(orbited({before, size}, 0, 40), size);
    EXPECT_GT(down.project(nearest)->y, size.height / 2.0);
}

TEST(Orbit, StopsBeforeThePolesAndKeepsTheHorizonLevel) {
    Camera camera{{0, 0, 8}, {0, 0, 0}};
    for (int step = 0; step < 200; ++step) {
        camera = orbited({camera, size}, 11, 25);
        ASSERT_FALSE(find_fault(camera));
        EXPECT_NEAR(Projection(camera, size).right().y, 0, 1e-12);
    }
    EXPECT_GT(camera.position.y, 7.99);
    for (int step = 0; step < 200; ++step) camera = orbited({camera, size}, 0, -25);
    EXPECT_LT(camera.position.y, -7.99);
}

TEST(Orbit, FromTheTopViewTheTurntableStandsUprightAgain) {
    const Camera top = along_axis({{{0, 0, 8}, {0, 0, 0}}, size}, 1, false);
    const Camera tilted = orbited({top, size}, 0, -90);
    EXPECT_EQ(tilted.up, (Vec3d{0, 1, 0}));
    EXPECT_GT(tilted.position.y, 0);
    EXPECT_GT(tilted.position.z, 0);  // towards where the front was
    expect_near(Projection(tilted, size).right(), Projection(top, size).right(), 1e-9);
}

TEST(Pan, ThePlaceAtTheTargetsDepthFollowsThePointer) {
    std::mt19937_64 random(5);
    for (int trial = 0; trial < 100; ++trial) {
        const Projection before(any_camera(random, trial), size);
        const Vec3d target = before.camera().target;
        const Projection after(panned(before, 31, -17), size);
        EXPECT_NEAR(after.project(target)->x, size.width / 2.0 + 31, 1e-8);
        EXPECT_NEAR(after.project(target)->y, size.height / 2.0 - 17, 1e-8);
        EXPECT_NEAR(distance(after.camera()), distance(before.camera()), 1e-12);
    }
}

TEST(Zoom, KeepsThePlaceUnderThePointerWhereItIs) {
    std::mt19937_64 random(6);
    for (const double steps : {1.0, -1.0, 3.5, -7.0}) {
        const Projection before(some_camera(random), size);
        const WindowPoint at{900.25, 200.75};
        // the place under the pointer, at the target's depth
        const Ray sight = before.line_of_sight(at);
        const double reach = distance(before.camera()) / -dot(sight.direction, before.back());
        const Vec3d place = sight.origin + reach * sight.direction;
        const Projection after(zoomed(before, at, steps), size);
        EXPECT_NEAR(after.project(place)->x, at.x, 1e-8);
        EXPECT_NEAR(after.project(place)->y, at.y, 1e-8);
        if (steps > 0) {
            EXPECT_LT(distance(after.camera()), distance(before.camera()));
        } else {
            EXPECT_GT(distance(after.camera()), distance(before.camera()));
        }
    }
}

TEST(Zoom, OfAnOrthographicCameraTheHeightChangesAndWhatIsUnderThePointerStays) {
    std::mt19937_64 random(16);
    for (const double steps : {1.0, -1.0, 3.5, -7.0}) {
        const Projection before(some_orthographic_camera(random), size);
        const WindowPoint at{900.25, 200.75};
        const Projection after(zoomed(before, at, steps), size);
        EXPECT_NEAR(seen_height(after.camera()),
                    std::pow(0.88, steps) * seen_height(before.camera()), 1e-12);
        EXPECT_NEAR(distance(after.camera()), distance(before.camera()), 1e-12);
        expect_near(after.line_of_sight(at).origin, before.line_of_sight(at).origin, 1e-11);
        expect_near(after.back(), before.back(), 1e-14);
    }
}

TEST(Zoom, EndsBeforeDoublesDo) {
    for (const auto projection :
         {Camera::Projection::perspective, Camera::Projection::orthographic}) {
        Camera camera = in_projection({{1, 2, 8}, {1, 2, 0}}, projection);
        for (int step = 0; step < 2000; ++step) {
            camera = zoomed({camera, size}, {100, 100}, 1);
            ASSERT_FALSE(find_fault(camera));
        }
        EXPECT_LT(seen_height(camera), 1e-8);
        for (int step = 0; step < 9000; ++step) {
            camera = zoomed({camera, size}, {100, 100}, -1);
            ASSERT_FALSE(find_fault(camera));
        }
    }
}

TEST(Frame, TheSphereAroundTheBoxFitsBothWays) {
    const Box3 box{{-1, 2, -4}, {3, 5, 1}};
    const Vec3d half = 0.5 * (box.hi - box.lo);
    for (const auto projection :
         {Camera::Projection::perspective, Camera::Projection::orthographic}) {
        for (const WindowSize shape : {WindowSize{1280, 720}, WindowSize{300, 900}}) {
            const Projection before(in_projection({{7, 3, 9}, {0, 1, 0}}, projection), shape);
            const Camera after = framed(before, box);
            expect_near(after.target, 0.5 * (box.lo + box.hi), 1e-12);
            const Projection view(after, shape);
            expect_near(view.back(), before.back(), 1e-12);
            for (const double angle : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) {
                const Vec3d around = std::cos(angle) * view.right() + std::sin(angle) * view.top();
                const auto seen = view.project(after.target + length(half) * around);
                ASSERT_TRUE(seen);
                EXPECT_TRUE((WindowRect{0, 0, shape.width, shape.height}.contains(*seen)));
            }
        }
    }
}

TEST(InProjection, WhatIsSeenAtTheTargetKeepsItsSizeToWithinAPixel) {
    std::mt19937_64 random(17);
    for (int trial = 0; trial < 50; ++trial) {
        const Camera before = some_camera(random);
        const Camera other = in_projection(before, Camera::Projection::orthographic);
        EXPECT_EQ(other.position, before.position);
        const Projection perspective(before, size), orthographic(other, size);
        const Vec3d beside = perspective.moved(before.target, 400, -300);
        EXPECT_NEAR(orthographic.project(beside)->x, size.width / 2.0 + 400, 1e-8);
        EXPECT_NEAR(orthographic.project(beside)->y, size.height / 2.0 - 300, 1e-8);
        // and back, however far the plane had to be moved
        Camera farther = other;
        farther.position = other.target + 7.5 * (other.position - other.target);
        for (const Camera& camera : {other, farther}) {
            const Camera back = in_projection(camera, Camera::Projection::perspective);
            expect_near(back.position, before.position, 1e-12);
            EXPECT_EQ(back.target, before.target);
            EXPECT_EQ(back.height, std::nullopt);
        }
    }
}

TEST(PlaneBefore, IsMovedOnlyWhereTheBoxReachesIt) {
    const Box3 box{{-1, 2, -4}, {3, 5, 1}};
    std::mt19937_64 random(18);
    for (int trial = 0; trial < 50; ++trial) {
        const Camera camera = some_orthographic_camera(random);
        const Camera moved = with_plane_before(camera, box);
        const Projection before(camera, size), after(moved, size);
        const bool was_before = plane_is_before(camera, box);
        EXPECT_EQ(moved == camera, was_before);
        EXPECT_TRUE(plane_is_before(moved, box));
        EXPECT_EQ(with_plane_before(moved, box), moved);
        EXPECT_EQ(moved.target, camera.target);
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3d at{(corner & 1) != 0 ? box.lo.x : box.hi.x,
                           (corner & 2) != 0 ? box.lo.y : box.hi.y,
                           (corner & 4) != 0 ? box.lo.z : box.hi.z};
            EXPECT_GT(after.distance_to(at), 0);
            EXPECT_NEAR(after.project(at)->x, before.project(at)->x, 1e-9);
            EXPECT_NEAR(after.project(at)->y, before.project(at)->y, 1e-9);
        }
    }
}

TEST(PlaneBefore, PerspectiveCamerasAndEmptyBoxesChangeNothing) {
    const Camera near{{0, 0, 1}, {0, 0, 0}};
    EXPECT_EQ(with_plane_before(near, {{-9, -9, -9}, {9, 9, 9}}), near);
    const Camera flat = in_projection(near, Camera::Projection::orthographic);
    EXPECT_EQ(with_plane_before(flat, {}), flat);
    constexpr double inf = std::numeric_limits<double>::infinity();
    EXPECT_EQ(with_plane_before(flat, {{-inf, -inf, -inf}, {inf, inf, inf}}), flat);
}

TEST(Centre, KeepsDistanceAndDirection) {
    const Camera before{{1, 2, 8}, {0, 0, 0}};
    const Camera after = centred({before, size}, {3, -1, 2});
    EXPECT_EQ(after.target, (Vec3d{3, -1, 2}));
    expect_near(after.position - after.target, before.position - before.target, 1e-14);
}

TEST(AxisView, LooksExactlyAlongTheAxis) {
    const Camera before{{1, 2, 8}, {0.5, 0.25, 1}};
    for (int axis = 0; axis < 3; ++axis) {
        for (const bool opposite : {false, true}) {
            const Camera after = along_axis({before, size}, axis, opposite);
            ASSERT_FALSE(find_fault(after));
            const Vec3d line = after.position - after.target;
            for (int k = 0; k < 3; ++k) {
                const double expected = k != axis  ? 0
                                        : opposite ? -distance(before)
                                                   : distance(before);
                EXPECT_NEAR(line[static_cast<std::size_t>(k)], expected, 1e-14);
            }
        }
    }
    // x to the right from the front and from above, y up from the front
    const Projection front(along_axis({before, size}, 2, false), size);
    expect_near(front.right(), {1, 0, 0}, 1e-15);
    expect_near(front.top(), {0, 1, 0}, 1e-15);
    const Projection top(along_axis({before, size}, 1, false), size);
    expect_near(top.right(), {1, 0, 0}, 1e-15);
}

}  // namespace
}  // namespace ivory
