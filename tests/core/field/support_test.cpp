// Lists of elements stand for the whole field on the rays of their cones, by the reference.
#include "core/field/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/trace/ray.h"
#include "tests/reference/reference.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using reference::Real;
using reference::RealInterval;
using tools::Random;

double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

// A ray of the cone, often on its rim (within the roundings that `sine` leaves room for).
Ray ray_in(const Cone& cone, Random& random) {
    const Vec3d axis = (1 / length(cone.axis)) * cone.axis;
    Vec3d side = cross(axis, random.in_cube(1));
    side = (1 / length(side)) * side;
    const double part = random.chance(0.4) ? 1 - 1e-9 : random.uniform(0, 1);
    const double sine = std::min(cone.sine, 1.0) * part;
    const Vec3d direction = std::sqrt(1 - sine * sine) * axis + sine * side;
    return {cone.apex, std::exp(random.uniform(-3, 3)) * direction};
}

Cone some_cone(const Field& field, Random& random) {
    const std::size_t i = random.below(field.size());
    Cone cone;
    cone.apex = random.in_cube(12);
    cone.axis = random.chance(0.6) ? field.a(i) - cone.apex : random.in_cube(1);
    cone.axis = std::exp(random.uniform(-20, 20)) * cone.axis;
    cone.sine = std::exp(random.uniform(-8, -0.7));
    return cone;
}

// A cone around half of its parent's rays, from the same apex.
Cone part_of(const Cone& parent, Random& random) {
    Cone cone = parent;
    Cone narrower = parent;
    narrower.sine = 0.4 * parent.sine;
    cone.axis = ray_in(narrower, random).direction;
    cone.sine = 0.4 * parent.sine;
    return cone;
}

// The exact sum over all elements lies in the exact sum over the list plus rest: what is left out
// sums to a member of rest.
void expect_stands_for_all(const Field& field, const std::vector<std::size_t>& visible,
                           const reference::PointValue& at, const ElementList& list) {
    RealInterval dropped(0.0);
    std::size_t next = 0;
    bool is_kept = false;  // some part of the element
    for (std::size_t i = 0; i < field.size(); ++i) {
        if (next < list.elements.size() && list.elements[next] == i) {
            ++next;
            is_kept = true;
        }
        if (field.joins_next(i)) continue;
        if (!is_kept) dropped = dropped + at.element[visible[field.source[i]]];
        is_kept = false;
    }
    ASSERT_EQ(next, list.elements.size()) << "not ascending indices";
    ASSERT_TRUE(Real(list.left_out.lo) <= dropped.hi && dropped.lo <= Real(list.left_out.hi))
        << "rest [" << list.left_out.lo << ", " << list.left_out.hi << "], left out "
        << dropped.lo.to_double();
}

// Scene index to the reference's index of visible elements.
std::vector<std::size_t> visible_of(const Scene& scene) {
    std::vector<std::size_t> visible;
    std::size_t n = 0;
    for (const Element& element : scene.elements) {
        visible.push_back(n);
        n += element.visible;
    }
    return visible;
}

struct Seen {
    int cones = 0, dropped = 0, empty = 0, misses = 0;
};

void check_list(const Scene& scene, const Field& field, const reference::ReferenceField& exact,
                const ElementList& list, const Cone& cone, Random& random, Seen& seen) {
    ++seen.cones;
    seen.dropped += list.elements.size() < field.size();
    const std::vector<std::size_t> visible = visible_of(scene);
    for (int i = 0; i < 3; ++i) {
        const Ray ray = ray_in(cone, random);
        if (list.certainly_empty) {
            ++seen.misses;
            ASSERT_EQ(first_root(exact, ray).outcome, reference::Outcome::miss);
            continue;
        }
        // Near an element, for there it counts.
        const Vec3d to = field.a(random.below(field.size())) - ray.origin;
        const double foot = dot(to, ray.direction) / dot(ray.direction, ray.direction);
        for (const double t : {foot, foot * random.uniform(0.5, 1.5), random.uniform(0, 30)}) {
            if (t < 0) continue;
            ASSERT_NO_FATAL_FAILURE(
                expect_stands_for_all(field, visible, exact.at(ray, Real(t)), list));
        }
    }
    seen.empty += list.certainly_empty;
}

TEST(Support, ListAndRestHoldTheWholeFieldOnTheConesRaysAndEmptyConesHoldMisses) {
    const std::uint64_t first = tools::announced_seed(41);
    Seen seen;
    for (std::uint64_t seed = first; seed < first + 4; ++seed) {
        Scene scene = tools::random_scene({.elements = 40, .scale = 2}, seed);
        for (Element& element : scene.elements) element.width *= 0.5;
        const Field field = compile(scene);
        const reference::ReferenceField exact(scene);
        const ElementList all = all_elements(field);
        Random random(seed);
        for (int i = 0; i < 25; ++i) {
            SCOPED_TRACE("seed " + std::to_string(seed) + ", cone " + std::to_string(i));
            // Nested lists: the parent's cone holds the child's.
            Cone cone = some_cone(field, random);
            ElementList list = all;
            for (int level = 0; level < 3; ++level) {
                list = reaching_elements(field, list, cone);
                ASSERT_NO_FATAL_FAILURE(check_list(scene, field, exact, list, cone, random, seen));
                cone = part_of(cone, random);
            }
        }
    }
    EXPECT_GT(seen.dropped, 0);
    EXPECT_GT(seen.empty, 0);
    EXPECT_LT(seen.empty, seen.cones);
}

TEST(Support, RestOfNestedListsStaysNegligible) {
    const Scene scene =
        tools::random_scene({.elements = 60, .scale = 3}, tools::announced_seed(42));
    const Field field = compile(scene);
    Random random(42);
    for (int i = 0; i < 40; ++i) {
        Cone cone = some_cone(field, random);
        ElementList list = all_elements(field);
        for (int level = 0; level < 4; ++level) {
            const ElementList parent = list;
            list = reaching_elements(field, parent, cone);
            cone = part_of(cone, random);
            EXPECT_LE(width(list.left_out), 0x1p-51 * field.threshold);
            EXPECT_TRUE(is_subset(parent.left_out, list.left_out) || list.certainly_empty);
            EXPECT_TRUE(std::includes(parent.elements.begin(), parent.elements.end(),
                                      list.elements.begin(), list.elements.end()));
        }
    }
}

TEST(Support, AllElementsLeavesNothingOut) {
    const Field field = compile(tools::random_scene({.elements = 12}, 43));
    const ElementList all = all_elements(field);
    ASSERT_EQ(all.elements.size(), field.size());
    for (std::size_t i = 0; i < field.size(); ++i) EXPECT_EQ(all.elements[i], i);
    EXPECT_EQ(all.left_out, Interval<double>(0.0));
    EXPECT_FALSE(all.certainly_empty);
    EXPECT_TRUE(all_elements(compile(Scene{})).certainly_empty);
}

TEST(Support, ConeOfEveryDirectionKeepsEveryElementInReach) {
    Scene scene;
    scene.elements = {{.skeleton = PointSkeleton{{0, 0, -30}}},
                      {.skeleton = PointSkeleton{{0, 0, 30}}},
                      {.skeleton = CircleSkeleton{{0, 40, 0}, {0, 0, 1}, 1}}};
    const Field field = compile(scene);
    const Cone everywhere{{0, 0, 0}, {0, 0, 1}, 2};
    EXPECT_EQ(reaching_elements(field, all_elements(field), everywhere).elements.size(), 3u);
    const Cone forward{{0, 0, 0}, {0, 0, 1}, 0.1};
    const ElementList ahead = reaching_elements(field, all_elements(field), forward);
    ASSERT_EQ(ahead.elements.size(), 1u);
    EXPECT_EQ(field.az[ahead.elements[0]], 30);
}

TEST(Support, NegativeElementThatReachesIsKept) {
    Scene scene;
    scene.elements = {{.skeleton = PointSkeleton{{0, 0, 10}}},
                      {.skeleton = PointSkeleton{{0.5, 0, 10}}, .strength = -0.5},
                      {.skeleton = PointSkeleton{{0, 0, -90}}, .strength = -0.5}};
    const Field field = compile(scene);
    const ElementList list =
        reaching_elements(field, all_elements(field), {{0, 0, 0}, {0, 0, 1}, 0.01});
    EXPECT_EQ(list.elements, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_LE(list.left_out.lo, 0);
    EXPECT_GE(list.left_out.hi, 0);
    EXPECT_FALSE(list.certainly_empty);
}

}  // namespace
}  // namespace ivory
