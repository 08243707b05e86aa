// The boxes hold the solid: f < 0 outside of them, by the reference of 256 bits.
#include "core/field/bounding_box.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>

#include "core/interval/rounding.h"
#include "core/scene/scene_json.h"
#include "tests/reference/level.h"
#include "tests/reference/reference.h"
#include "tests/tools/kinds.h"
#include "tests/tools/on_skeleton.h"
#include "tests/tools/parts.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using reference::Real;
using tools::Random;

bool certainly_outside(const reference::ReferenceField& field, const Vec3d& p) {
    return certainly_negative(field.at({p, {0, 0, 1}}, Real(0.0)).f);
}

// A point outside of the box: next to a face, a little off it, or far away.
Vec3d outside(const Box3& box, Random& random) {
    Vec3d p;
    for (std::size_t k = 0; k < 3; ++k) {
        const double margin = 0.2 * (box.hi[k] - box.lo[k]);
        p[k] = random.uniform(box.lo[k] - margin, box.hi[k] + margin);
    }
    const std::size_t axis = random.below(3);
    const bool above = random.chance(0.5);
    const double face = above ? box.hi[axis] : box.lo[axis];
    const double off =
        random.chance(0.3) ? 0 : (box.hi[axis] - box.lo[axis]) * std::exp(random.uniform(-36, 0));
    p[axis] = above ? next_up(face + off) : next_down(face - off);
    return p;
}

void expect_outside(const Scene& scene, const Box3& box, int points, Random& random) {
    const reference::ReferenceField exact(scene);
    for (int i = 0; i < points; ++i) {
        const Vec3d p = box.empty() ? random.in_cube(5) : outside(box, random);
        ASSERT_TRUE(certainly_outside(exact, p)) << p.x << ' ' << p.y << ' ' << p.z << " of\n"
                                                 << write_scene(scene);
    }
}

bool holds(const Box3& outer, const Box3& inner) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (!(outer.lo[k] <= inner.lo[k] && inner.hi[k] <= outer.hi[k])) return false;
    }
    return true;
}

double volume(const Box3& box) {
    return (box.hi.x - box.lo.x) * (box.hi.y - box.lo.y) * (box.hi.z - box.lo.z);
}

Scene figure_1() {
    return read_scene(std::string(IVORY_SOURCE_DIR) + "/assets/scenes/figure-1.ivory.json");
}

Scene one(const Element& element, double threshold) {
    Scene scene;
    scene.threshold = threshold;
    scene.elements = {element};
    return scene;
}

// The greatest coordinate of the skeleton along an axis, or with sign -1 the least.
double extreme(const Skeleton& skeleton, std::size_t axis, double sign) {
    Vec3d direction;
    direction[axis] = sign;
    return std::visit(
        [&]<class S>(const S& s) {
            double most = -infinity<double>;
            for (const SkeletonPart& part : parts_of(s)) {
                most = std::max(most, sign * S::farthest(part.seen(), {}, direction)[axis]);
            }
            return sign * most;
        },
        skeleton);
}

TEST(BoundingBox, FieldIsNegativeOutsideOfBothBoxes) {
    const std::uint64_t first = tools::announced_seed(31);
    for (std::uint64_t seed = first; seed < first + 24; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        tools::SceneRecipe recipe;
        recipe.elements = 1 + seed % 9;
        recipe.scale = seed % 4 == 0 ? 1e-6 : 1;
        recipe.shift = seed % 4 == 1 ? 1e6 : 0;
        const Scene scene = tools::random_scene(recipe, seed);
        const Field field = compile(scene);
        Random random(seed);
        ASSERT_NO_FATAL_FAILURE(expect_outside(scene, field.reach_box, 60, random));
        ASSERT_NO_FATAL_FAILURE(expect_outside(scene, field.box, 60, random));
        EXPECT_TRUE(field.box.empty() || holds(field.reach_box, field.box));
    }
}

TEST(BoundingBox, FieldIsNegativeOutsideOfFigureOnesBox) {
    const Scene scene = figure_1();
    Random random(tools::announced_seed(32));
    const Field field = compile(scene);
    expect_outside(scene, field.reach_box, 100, random);
    expect_outside(scene, field.box, 300, random);
}

TEST(BoundingBox, FigureOnesBoxIsSmallerThanItsBoxOfReach) {
    const Field field = compile(figure_1());
    EXPECT_TRUE(holds(field.reach_box, field.box));
    EXPECT_LT(volume(field.box), 0.8 * volume(field.reach_box));
}

class BoundingBoxOf : public testing::TestWithParam<tools::ElementKind> {};
INSTANTIATE_TEST_SUITE_P(Each, BoundingBoxOf, testing::ValuesIn(tools::every_kind),
                         tools::name_of_kind);

// One element alone: what is within its reach is the solid. Of its box the skeleton's most distant
// places stand `reach` inside.
TEST_P(BoundingBoxOf, BoxOfOneElementTouchesItsSolid) {
    const std::uint64_t first = tools::announced_seed(35);
    const double q = reference::level(GetParam().kernel, 0.5).lo.to_double();
    for (std::uint64_t seed = first; seed < first + 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Scene scene = tools::random_scene({.elements = 1, .only = GetParam()}, seed);
        scene.threshold = 0.5 * scene.elements[0].strength;
        const Field field = compile(scene);
        const Box3& box = field.reach_box;
        for (std::size_t k = 0; k < 3; ++k) {
            double lo = infinity<double>, hi = -infinity<double>;
            for (std::size_t part = 0; part < field.size(); ++part) {
                const Element of_part = tools::element_of_part(scene, field, part);
                const std::vector<double>& widths = of_part.widths;
                const double reach =
                    q * (widths.empty() ? of_part.width : std::max(widths[0], widths[1]));
                lo = std::min(lo, extreme(of_part.skeleton, k, -1) - reach);
                hi = std::max(hi, extreme(of_part.skeleton, k, 1) + reach);
            }
            EXPECT_NEAR(box.lo[k], lo, 1e-12);
            EXPECT_NEAR(box.hi[k], hi, 1e-12);
        }
    }
}

TEST(BoundingBox, IsEmptyWhereNoElementReachesTheThreshold) {
    EXPECT_TRUE(compile(Scene{}).box.empty());
    const Element point{.skeleton = PointSkeleton{{0, 0, 0}}};
    EXPECT_TRUE(compile(one(point, 1.5)).reach_box.empty());
    EXPECT_FALSE(compile(one(point, 1.0)).box.empty());  // f = 0 at the point itself
    EXPECT_EQ(reach(compile(one(point, 1.5)), 0, 1), -1);
}

TEST(BoundingBox, InvisibleElementsTakeNoPart) {
    Element point{.skeleton = PointSkeleton{{0, 0, 0}}}, other = point;
    other.skeleton = PointSkeleton{{50, 0, 0}};
    other.visible = false;
    Scene scene = one(point, 0.5);
    const Field alone = compile(scene);
    scene.elements.push_back(other);
    const Field with = compile(scene);
    EXPECT_EQ(with.box.lo, alone.box.lo);
    EXPECT_EQ(with.box.hi, alone.box.hi);
    EXPECT_EQ(with.size(), 1u);
    EXPECT_EQ(count_positive(with), 1u);
}

TEST(BoundingBox, NegativeElementsNeedNoBallAndNeverEnlargeIt) {
    Element point{.skeleton = PointSkeleton{{0, 0, 0}}}, carves = point;
    carves.skeleton = PointSkeleton{{50, 0, 0}};
    carves.strength = -2;
    Scene scene = one(point, 0.5);
    const Field alone = compile(scene);
    scene.elements.push_back(carves);
    const Field with = compile(scene);
    EXPECT_EQ(with.reach_box.lo, alone.reach_box.lo);
    EXPECT_EQ(with.reach_box.hi, alone.reach_box.hi);
    EXPECT_EQ(count_positive(with), 1u);
    EXPECT_LT(reach(with, 1, 1), 0);
    EXPECT_TRUE(compile(one(carves, 0.5)).box.empty());
}

TEST(BoundingBox, ShrinkingKeepsEveryPointWhereTheFieldIsNotNegative) {
    const std::uint64_t first = tools::announced_seed(33);
    for (std::uint64_t seed = first; seed < first + 10; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Scene scene = tools::random_scene({.elements = 6}, seed);
        const Field field = compile(scene);
        if (field.reach_box.empty()) continue;
        const reference::ReferenceField exact(scene);
        Random random(seed);
        for (int i = 0; i < 200; ++i) {
            Vec3d p;
            for (std::size_t k = 0; k < 3; ++k) {
                p[k] = random.uniform(field.reach_box.lo[k], field.reach_box.hi[k]);
            }
            bool inside = true;
            for (std::size_t k = 0; k < 3; ++k) {
                inside = inside && field.box.lo[k] <= p[k] && p[k] <= field.box.hi[k];
            }
            if (inside) continue;
            ASSERT_TRUE(certainly_outside(exact, p)) << p.x << ' ' << p.y << ' ' << p.z;
        }
    }
}

class SkeletonBoxOf : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Each, SkeletonBoxOf, testing::ValuesIn(tools::every_shape),
                         tools::name_of_kind);

TEST_P(SkeletonBoxOf, HoldsTheSkeletonAndIsTight) {
    const std::uint64_t first = tools::announced_seed(36);
    for (std::uint64_t seed = first; seed < first + 40; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        const Scene scene = tools::random_scene(
            {.elements = 1, .only = tools::ElementKind{GetParam(), KernelKind{}}}, seed);
        const Field field = compile(scene);
        const std::size_t part = random.below(field.size());
        const Skeleton skeleton = tools::element_of_part(scene, field, part).skeleton;
        const Box3 box = skeleton_box(field, part);
        for (int n = 0; n < 50; ++n) {
            const Vec3d p = tools::on_skeleton(skeleton, random);
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_GE(p[k], box.lo[k] - 1e-13);
                EXPECT_LE(p[k], box.hi[k] + 1e-13);
            }
        }
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(box.lo[k], extreme(skeleton, k, -1), 1e-13);
            EXPECT_NEAR(box.hi[k], extreme(skeleton, k, 1), 1e-13);
        }
    }
}

TEST(SkeletonBox, OfACircleHoldsItExactlyAndIsTight) {
    Random random(tools::announced_seed(34));
    for (int i = 0; i < 200; ++i) {
        const Vec3d center = random.in_cube(10);
        Vec3d normal = random.in_cube(1);
        if (i % 5 == 0) normal = {0, 0, 0}, normal[random.below(3)] = 1e-200;
        const double r = random.uniform(0, 3);
        const Field field = compile(one({.skeleton = CircleSkeleton{center, normal, r}}, 0.5));
        const Box3 box = skeleton_box(field, 0);
        const double largest =
            std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
        const Vec3d m{normal.x / largest, normal.y / largest, normal.z / largest};
        for (std::size_t k = 0; k < 3; ++k) {
            // In long double, whose errors are far below the margin of 1e-15 that is granted.
            const long double x = m[k], y = m[(k + 1) % 3], z = m[(k + 2) % 3];
            const long double extent = r * std::sqrt((y * y + z * z) / (x * x + y * y + z * z));
            EXPECT_LE(box.lo[k], center[k] - extent);
            EXPECT_GE(box.hi[k], center[k] + extent);
            EXPECT_NEAR(box.lo[k], static_cast<double>(center[k] - extent), 1e-13);
            EXPECT_NEAR(box.hi[k], static_cast<double>(center[k] + extent), 1e-13);
        }
    }
}

}  // namespace
}  // namespace ivory
