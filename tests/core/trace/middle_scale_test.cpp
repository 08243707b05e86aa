// The scale of a scene is no difficulty: with all lengths times a power of two, the answers are the same.
#include "core/field/middle_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/render/canvas.h"
#include "core/render/render.h"
#include "core/trace/trace.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

Ray scaled(Ray ray, int exponent) {
    for (Vec3d* const v : {&ray.origin, &ray.direction}) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            (*v)[axis] = std::ldexp((*v)[axis], exponent);
        }
    }
    return ray;
}

Answer answer_of(const Field& field, const Ray& ray, const Method& method) {
    Counts counts;
    return trace(field, all_elements(field), ray, method, {}, counts);
}

TEST(MiddleScale, AnswersAreThoseOfTheMiddle) {
    const std::uint64_t seed = tools::announced_seed(23);
    const Method& proved = *find_method("proved");
    int hits = 0;
    for (int trial = 0; trial < 12; ++trial) {
        const Scene scene = tools::random_scene({.elements = 5}, seed + trial);
        const Field field = compile(scene);
        ASSERT_EQ(field.middle, nullptr);
        const std::vector<Ray> rays =
            tools::nasty_rays(scene, tools::RayKind::random, 12, seed + trial);
        for (const int exponent : {-480, -300, 300, 480}) {
            const Field far = compile(in_middle(scene, exponent));
            ASSERT_NE(far.middle, nullptr) << exponent;
            for (const Ray& ray : rays) {
                // The grid of answers is that of the doubles' own scale.
                const Answer here = answer_of(field, ray, proved),
                             there = answer_of(far, scaled(ray, exponent), proved);
                EXPECT_EQ(here.isolation.status, there.isolation.status) << exponent;
                if (here.isolation.status != Status::hit) continue;
                ++hits;
                EXPECT_EQ(here.isolation.t.lo, there.isolation.t.lo) << exponent;
                EXPECT_EQ(here.isolation.t.hi, there.isolation.t.hi) << exponent;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    EXPECT_NEAR(here.surface.normal[axis], there.surface.normal[axis], 1e-12);
                    EXPECT_NEAR(here.surface.color[axis], there.surface.color[axis], 1e-12);
                }
            }
        }
    }
    EXPECT_GT(hits, 100);
}

TEST(MiddleScale, PicturesToo) {
    Scene scene = tools::random_scene({.elements = 4}, 5);
    scene.camera = Camera{.position = {0, 0, 7}, .target = {0, 0, 0}};
    const Method& proved = *find_method("proved");
    const auto statuses_of = [&](const Scene& of) {
        const Picture picture = make_picture(of, 24, 16, proved, {}, 1);
        Canvas canvas(24, 16, false);
        render(picture, canvas, {});
        std::vector<Status> statuses;
        for (std::size_t p = 0; p < canvas.frame.size(); ++p) {
            statuses.push_back(canvas.frame.status[p]);
        }
        return statuses;
    };
    const std::vector<Status> here = statuses_of(scene);
    ASSERT_GT(std::count(here.begin(), here.end(), Status::hit), 20);
    for (const int exponent : {-300, 300}) {
        Scene far = in_middle(scene, exponent);
        far.camera = scene.camera;
        far.camera->position.z = std::ldexp(7.0, exponent);
        EXPECT_EQ(here, statuses_of(far)) << exponent;
    }
}

TEST(MiddleScale, WhatIsNotExactStaysAsItIs) {
    Scene scene;
    scene.elements.push_back(
        Element{.skeleton = PointSkeleton{{0x1.23456789abcdfp600, 0, 0}}, .width = 0x1.fp-1000});
    EXPECT_EQ(exponent_to_middle(scene), 199);
    scene.elements.push_back(
        Element{.skeleton = PointSkeleton{{0x1.fffffffffffffp1023, 0x1p-1074, 0}}});
    EXPECT_EQ(exponent_to_middle(scene), 0);  // that would underflow
}

}  // namespace
}  // namespace ivory
