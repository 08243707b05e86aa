// A field that follows its scene is the one that compile makes of it, or holds just as well.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "core/field/field.h"
#include "core/math/direction.h"
#include "tests/tools/kinds.h"
#include "tests/tools/move_element.h"
#include "tests/tools/parts.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using tools::move;
using tools::Random;

Scene crowd(std::size_t elements, std::uint64_t seed) {
    return tools::random_scene({.elements = elements, .scale = 0.1}, seed);
}

std::size_t visible_element(const Scene& scene, Random& random) {
    while (true) {
        const std::size_t i = random.below(scene.elements.size());
        if (scene.elements[i].visible) return i;
    }
}

TEST(Refit, IsWhatCompileMakes) {
    const std::uint64_t seed = tools::announced_seed(77);
    Random random(seed);
    for (const std::size_t elements : {7u, 200u, 2500u}) {
        Scene scene = crowd(elements, seed + elements);
        Field field = compile(scene);
        for (int edit = 0; edit < 12; ++edit) {
            SCOPED_TRACE(std::to_string(elements) + " elements, edit " + std::to_string(edit));
            const Scene before = scene;
            Element& element = scene.elements[visible_element(scene, random)];
            switch (edit % 6) {
                case 0:
                    scene.threshold *= random.uniform(0.9, 1.1);
                    break;
                case 1:
                    scene.threshold *= 16;
                    break;  // other powers of two for the floats
                case 2:
                    element.strength *= random.uniform(-2, 2);
                    break;
                case 3:
                    element.width *= random.uniform(0.3, 3);
                    break;
                case 4:
                    element.color = {0.25, 0.5, 1};
                    break;
                case 5:
                    break;
            }
            EXPECT_EQ(refit(field, before, scene), Refit::as_compiled);
            ASSERT_TRUE(field == compile(scene));
        }
    }
}

TEST(Refit, MovesAreFollowedWithoutClusters) {
    const std::uint64_t seed = tools::announced_seed(78);
    Random random(seed);
    Scene scene = crowd(100, seed);
    Field field = compile(scene);
    for (int edit = 0; edit < 20; ++edit) {
        const Scene before = scene;
        for (Element& element : scene.elements) move(element, random.in_cube(0.5));
        EXPECT_EQ(refit(field, before, scene), Refit::as_compiled);
        ASSERT_TRUE(field == compile(scene));
    }
}

// The elements are those of the scene, and every cluster holds its own.
TEST(Refit, ClustersFollowWhatMoves) {
    const std::uint64_t seed = tools::announced_seed(79);
    Random random(seed);
    Scene scene = crowd(3000, seed);
    Field field = compile(scene);
    ASSERT_FALSE(field.clusters.empty());
    for (int edit = 0; edit < 30; ++edit) {
        const Scene before = scene;
        for (int n = 0; n < 5; ++n) {
            move(scene.elements[visible_element(scene, random)], random.in_cube(2));
        }
        ASSERT_EQ(refit(field, before, scene), Refit::stretched);
    }
    const Field fresh = compile(scene);
    EXPECT_TRUE(field.box == fresh.box);
    EXPECT_TRUE(field.skeletons == fresh.skeletons);
    const Clusters& clusters = field.clusters;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
        const Vec3d center{clusters.x[c], clusters.y[c], clusters.z[c]};
        for (std::uint32_t i = clusters.first[c]; i < clusters.first[c + 1]; ++i) {
            const Element element = tools::element_of_part(scene, field, i);
            Vec3d off = place_of(element) - center;
            ASSERT_LE(std::sqrt(dot(off, off)), clusters.radius[c]);
            ASSERT_EQ(field.width[i], element.width);
            const Vec3d a =
                std::visit([](const auto& s) { return parts_of(s)[0].columns.a; },
                           has_numbers(field.shape[i]) ? scene.elements[field.source[i]].skeleton
                                                       : element.skeleton);
            ASSERT_EQ(field.a(i), a);
            off = a - center;
            ASSERT_NEAR(double{clusters.members.x[i]}, off.x / field.unit,
                        1e-6 * clusters.radius[c] / field.unit);
        }
    }
}

TEST(Refit, WhatItCannotFollowItLeaves) {
    Scene scene = crowd(2500, 80);
    const Field compiled = compile(scene);
    Field field = compiled;
    const Scene before = scene;
    const auto expect_impossible = [&](const Scene& after) {
        EXPECT_EQ(refit(field, before, after), Refit::impossible);
        EXPECT_TRUE(field == compiled);
    };
    Random random(80);
    const std::size_t i = visible_element(scene, random);
    scene.elements[i].visible = false;
    expect_impossible(scene);
    scene = before;
    scene.elements.pop_back();
    expect_impossible(scene);
    scene = before;
    for (const KernelKind kernel : tools::every_kernel) {
        if (kernel == before.elements[i].kernel) continue;
        scene.elements[i].kernel = kernel;
        expect_impossible(scene);
    }
    scene = before;
    for (const Shape shape : tools::every_shape) {
        if (shape == shape_of_skeleton(before.elements[i].skeleton)) continue;
        scene.elements[i].skeleton = tools::skeleton_of(shape);
        scene.elements[i].widths.clear();
        if (is_taper(shape)) scene.elements[i].widths = {0.5, 1};
        expect_impossible(scene);
    }
    scene = before;
    for (Element& element : scene.elements) element.width *= 2;
    expect_impossible(scene);
}

}  // namespace
}  // namespace ivory
