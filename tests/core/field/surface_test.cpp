// Value, gradient and colour at a point, against 256 bits.
#include "core/field/surface.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "core/trace/methods/method.h"
#include "tests/reference/reference.h"
#include "tests/tools/kinds.h"
#include "tests/tools/parts.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using reference::PointValue;
using reference::Real;
using reference::RealInterval;
using tools::Random;

double nearest(const RealInterval& x) { return 0.5 * (x.lo.to_double() + x.hi.to_double()); }

// What the errors are measured by: the sums of the terms' sizes.
struct Scale {
    double value = 0, gradient = 0, positive = 0;
};

Scale scale_of(const reference::ReferenceField& field, const PointValue& at) {
    Scale scale;
    scale.value = field.threshold();
    for (const RealInterval& f : at.element) {
        scale.value += std::abs(nearest(f));
        scale.positive += std::max(nearest(f), 0.0);
    }
    for (const auto& rise : at.rise) {
        for (const RealInterval& x : rise) scale.gradient += std::abs(nearest(x));
    }
    return scale;
}

// `share` of relative error in every term.
void expect_exact(const reference::ReferenceField& field, const PointValue& at,
                  const FieldSample& sample, double least_width, double share) {
    const Scale scale = scale_of(field, at);
    EXPECT_NEAR(sample.value, nearest(at.f), share * scale.value);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(sample.gradient[k], nearest(at.gradient[k]),
                    share * (scale.gradient + scale.value / least_width));
        if (scale.positive > 1e-3) {
            EXPECT_NEAR(sample.color[k], nearest(at.color[k]), 100 * share / scale.positive);
        }
    }
}

class SurfaceOf : public testing::TestWithParam<tools::ElementKind> {};
INSTANTIATE_TEST_SUITE_P(Each, SurfaceOf, testing::ValuesIn(tools::every_kind),
                         tools::name_of_kind);

TEST_P(SurfaceOf, ValueGradientAndColorAreThoseOfTheReference) {
    const std::uint64_t first = tools::announced_seed(51);
    for (std::uint64_t seed = first; seed < first + 4; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        tools::SceneRecipe recipe{.elements = 6};
        if (seed % 4 != 0) recipe.only = GetParam();  // one scene of all kinds
        const Scene scene = tools::random_scene(recipe, seed);
        const Field field = compile(scene);
        const reference::ReferenceField exact(scene);
        Random random(seed);
        for (int i = 0; i < 60; ++i) {
            const Vec3d p = field.a(random.below(field.size())) + random.in_cube(1);
            const FieldSample here = sample(field, p);
            const PointValue at = exact.at({p, {0, 0, 1}}, Real(0.0));
            expect_exact(exact, at, here, field.least_width, 1e-13);
            double most = 0;
            for_elements(field, tools::all_parts(field), [&](std::span<const std::uint32_t> parts) {
                most = std::max(most, std::abs(element_value(field, parts, p)));
            });
            EXPECT_EQ(std::abs(element_value(field, std::array{here.strongest}, p)), most);
        }
    }
}

// The point is not rounded on the way: rounding p(t) at 1e9 would move it by 1e-7.
TEST_P(SurfaceOf, FarOriginsCostNoAccuracy) {
    const std::uint64_t first = tools::announced_seed(52);
    for (std::uint64_t seed = first; seed < first + 3; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Scene scene = tools::random_scene({.elements = 5, .only = GetParam()}, seed);
        const Field field = compile(scene);
        const reference::ReferenceField exact(scene);
        Random random(seed);
        for (int i = 0; i < 30; ++i) {
            const Vec3d p = field.a(random.below(field.size())) + random.in_cube(0.8);
            Vec3d d = random.in_cube(1);
            d = (1 / std::sqrt(dot(d, d))) * d;
            const double away = std::pow(10, random.uniform(3, 9));
            const Ray ray{p - away * d, d};
            // So that p(t) itself is near p though o and t d are not.
            const FieldSample here =
                sample(field, all_elements(field), ray.origin, ray.direction, away);
            expect_exact(exact, exact.at(ray, Real(away)), here, field.least_width, 1e-13);
        }
    }
}

TEST(Surface, ColorIsTheMeanOfColorsByPositiveFields) {
    Scene scene;
    scene.threshold = 0.5;
    scene.elements = {{.skeleton = PointSkeleton{{0, 0, 0}}, .color = {1, 0, 0}, .strength = 2},
                      {.skeleton = PointSkeleton{{1, 0, 0}}, .color = {0, 1, 0}},
                      {.skeleton = PointSkeleton{{0, 1, 0}}, .color = {0, 0, 1}, .strength = -1}};
    const Field field = compile(scene);
    const double red = 2 * std::exp(-0.25), green = std::exp(-0.25);
    const FieldSample here = sample(field, {0.5, 0, 0});
    EXPECT_NEAR(here.color.x, red / (red + green), 1e-15);
    EXPECT_NEAR(here.color.y, green / (red + green), 1e-15);
    EXPECT_EQ(here.color.z, 0);
    EXPECT_EQ(here.strongest, 0u);
}

TEST(Surface, ColorIsBlackAndTheFieldMinusTWhereNoElementReaches) {
    Scene scene;
    scene.threshold = 0.5;
    scene.elements = {{.skeleton = PointSkeleton{{0, 0, 0}}, .kernel = KernelKind::wyvill}};
    const FieldSample here = sample(compile(scene), {3, 0, 0});
    EXPECT_EQ(here.value, -0.5);
    EXPECT_EQ(here.color, (Vec3d{}));
    EXPECT_EQ(here.gradient, (Vec3d{}));
    EXPECT_EQ(sample(compile(scene), ElementList{}, {0, 0, 0}, {1, 0, 0}, 0).value, -0.5);
}

TEST(Surface, NormalIsZeroAtAKinkOnACirclesAxis) {
    Scene scene;
    scene.threshold = 0.1;
    scene.elements = {{.skeleton = CircleSkeleton{{0, 0, 0}, {0, 0, 1}, 1}}};
    const Field field = compile(scene);
    const FieldSample on_axis = sample(field, {0, 0, 0.3});
    EXPECT_EQ(on_axis.gradient, (Vec3d{}));
    EXPECT_EQ(outward_normal(on_axis.gradient), (Vec3d{}));
    EXPECT_NE(outward_normal(sample(field, {1e-3, 0, 0.3}).gradient), (Vec3d{}));
}

// Beyond its support a circle has no gradient that could be undefined.
TEST(Surface, KinkOutOfReachLeavesTheNormalAlone) {
    Scene scene;
    scene.threshold = 0.1;
    scene.elements = {
        {.skeleton = PointSkeleton{{0, 0, 0}}},
        {.skeleton = CircleSkeleton{{0, 0, 0}, {0, 0, 1}, 3}, .kernel = KernelKind::wyvill}};
    const Vec3d normal = outward_normal(sample(compile(scene), {0, 0, 0.5}).gradient);
    EXPECT_NEAR(normal.z, 1, 1e-15);
}

TEST(Surface, CircleOfRadiusZeroIsAPoint) {
    Scene circle;
    circle.threshold = 0.1;
    circle.elements = {{.skeleton = CircleSkeleton{{0, 0, 0}, {0, 0, 1}, 0}}};
    const FieldSample here = sample(compile(circle), {0, 0, 0.5});
    EXPECT_NEAR(here.gradient.z, -std::exp(-0.25), 1e-15);
}

// However narrow an element is, what it adds far away is nothing.
TEST(Surface, ElementsOfTinyWidthLeaveTheGradientFarFromThemAlone) {
    Scene scene;
    scene.elements = {{.skeleton = PointSkeleton{{0, 0, 0}}},
                      {.skeleton = PointSkeleton{{3, 0.5, 0}}}};
    for (const KernelKind kernel : tools::every_kernel) {
        for (const double width : {1e-60, 1e-95, 1e-130, 1e-200, 1e-308}) {
            SCOPED_TRACE(std::string(kernel_word(kernel)) + ", width " + std::to_string(width));
            scene.elements[1].kernel = kernel;
            scene.elements[1].width = width;
            const Vec3d gradient = sample(compile(scene), {0, 0.5, -0.8}).gradient;
            const double k = std::exp(-0.89);
            EXPECT_NEAR(gradient.x, 0, 1e-15);
            EXPECT_NEAR(gradient.y, -k, 1e-15);
            EXPECT_NEAR(gradient.z, 1.6 * k, 1e-15);
        }
    }
}

TEST(OutwardNormal, HasUnitLengthAtAnySizeAndIsZeroWhereThereIsNone) {
    for (const double size : {1e-300, 1e-160, 1.0, 1e160, 1e300}) {
        const Vec3d n = outward_normal({3 * size, 0, -4 * size});
        EXPECT_NEAR(n.x, -0.6, 1e-15);
        EXPECT_NEAR(n.z, 0.8, 1e-15);
    }
    EXPECT_EQ(outward_normal({}), (Vec3d{}));
    EXPECT_EQ(outward_normal({infinity<double>, 0, 0}), (Vec3d{}));
    EXPECT_EQ(outward_normal({1, std::nan(""), 0}), (Vec3d{}));
}

}  // namespace
}  // namespace ivory
