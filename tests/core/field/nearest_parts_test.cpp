// Of joined elements, which parts and pieces stay on a stretch: none that is the nearest to any point of it
// leaves.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/field/bundle_steps.h"
#include "core/math/direction.h"
#include "core/math/instruction_sets.h"
#include "core/shape/shapes.h"
#include "tests/tools/instruction_sets.h"
#include "tests/tools/kinds.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using tools::Random;

// Of one list after `keep_nearest_parts`: part k is [middle - half, middle + half] of its arc.
struct Kept {
    std::size_t element;
    double middle, half;
};

Vec3d place_on(std::span<const double> numbers, double x) {
    using namespace curve_arc;
    const auto vector = [&](std::size_t k) {
        return Vec3d{numbers[k], numbers[k + 1], numbers[k + 2]};
    };
    return vector(at_k0) + x * (vector(at_k1) + x * (vector(at_k2) + x * vector(at_k3)));
}

// From p to the nearest of some hundred places of a piece, and on by golden sections.
double distance_to_piece(const SkeletonColumns& c, double middle, double half, const Vec3d& p) {
    const auto at = [&](double x) {
        const Vec3d off = (p - c.a) - place_on(c.numbers, x);
        return dot(off, off);
    };
    constexpr int places = 64;
    double best = middle - half, least = infinity<double>;
    for (int k = 0; k <= places; ++k) {
        const double x = middle + half * (2.0 * k / places - 1);
        if (at(x) < least) best = x;
        least = std::min(least, at(x));
    }
    double lo = std::max(best - 2 * half / places, middle - half),
           hi = std::min(best + 2 * half / places, middle + half);
    for (int step = 0; step < 60; ++step) {
        const double a = hi - 0.618 * (hi - lo), b = lo + 0.618 * (hi - lo);
        (at(a) < at(b) ? hi : lo) = at(a) < at(b) ? b : a;
    }
    return std::sqrt(std::min(least, at(0.5 * (lo + hi))));
}

double distance_to(const Field& field, const Kept& part, const Vec3d& p) {
    const SkeletonColumns c = field.columns(part.element);
    if (field.shape[part.element] == Shape::curve)
        return distance_to_piece(c, part.middle, part.half, p);
    return std::sqrt(PolylineSkeleton::nearest(c, p - c.a, 1).s);
}

// The least distance of each element.
std::map<std::uint32_t, double> distances(const Field& field, const std::vector<Kept>& parts,
                                          const Vec3d& p) {
    std::map<std::uint32_t, double> least;
    for (const Kept& part : parts) {
        const auto [at, is_first] = least.try_emplace(field.source[part.element], infinity<double>);
        at->second = std::min(at->second, distance_to(field, part, p));
    }
    return least;
}

struct Counts {
    std::size_t parts = 0, kept = 0, pieces = 0, points = 0;
};

// A scene of curves or polylines near the origin, some of them bent so that many points have two feet.
Scene bent_scene(Shape shape, Random& random) {
    Scene scene;
    for (int n = 0; n < 3; ++n) {
        Element element;
        element.width = random.uniform(0.3, 1);
        if (shape == Shape::curve) {
            std::vector<Vec3d> points;
            const Vec3d from = random.in_cube(0.5);
            const bool is_flat = random.chance(0.3), is_cubic = random.chance(0.7);
            for (int k = 0; k < (is_cubic ? 4 : 3); ++k) {
                points.push_back(from + random.in_cube(1));
                if (is_flat) points.back().z = 0;
            }
            if (random.chance(0.2)) points.back() = points.front();
            element.skeleton = CurveSkeleton(points);
        } else {
            std::vector<Vec3d> points;
            for (int k = 0; k < 8; ++k) points.push_back(random.in_cube(1));
            element.skeleton = PolylineSkeleton(points);
        }
        scene.elements.push_back(element);
    }
    return scene;
}

// Of the stretch [-half, half] about the place `middle` away on the axis, in float and in double.
void expect_nearest_kept(const Field& field, const Vec3d& origin, const Vec3d& axis, double middle,
                         double half, double radius, double spread, Random& random,
                         Counts& counts) {
    ActiveElements all;
    std::vector<std::uint32_t> elements(field.size());
    std::vector<Kept> whole;
    for (std::size_t i = 0; i < field.size(); ++i) {
        elements[i] = static_cast<std::uint32_t>(i);
        whole.push_back({i, 0, 1});
    }
    all.take(field.first, elements);
    const Stretch on{origin, axis, spread, radius, middle - half, middle + half};
    const double unit = field.unit;
    const LocalStretch near_on{axis,         {},          spread,       radius / unit,
                               -half / unit, half / unit, middle / unit};
    const BundleSteps& steps = bundle_steps();
    ActiveElements active;
    steps.bound(field, on, field.scale, -1, all,
                active);  // but for parts that are farther all over
    LocalElements near;
    near.make_room(active.size());
    steps.enter_local(field, on, middle, active, near);
    std::array<std::vector<Kept>, 2> kept;
    BothFeet<float> feet_in_float;
    BothFeet<double> feet;
    for (int again = 0; again < 3; ++again) {  // pieces of pieces
        steps.keep_nearest_parts_local(near, near_on, feet_in_float);
        steps.keep_nearest_parts(field, on, field.scale, active, feet);
    }
    for (std::size_t k = 0; k < near.size(); ++k) {
        kept[0].push_back(
            {static_cast<std::size_t>(near.element[k]), double{near.mx[k]}, double{near.my[k]}});
    }
    for (std::size_t k = 0; k < active.size(); ++k) {
        kept[1].push_back({static_cast<std::size_t>(active.element[k]), active.piece_middle[k],
                           active.piece_half[k]});
    }
    counts.parts += 2 * field.size();
    for (const std::vector<Kept>& list : kept) {
        counts.kept += list.size();
        for (const Kept& part : list) counts.pieces += part.half < 1;
    }
    for (int n = 0; n < 40; ++n) {
        const Vec3d side = ivory::unit(cross(axis, random.in_cube(1)));
        const double share = random.chance(0.5) ? 1 : random.uniform(0, 1);
        const double t = random.chance(0.3) ? middle + half * random.sign()
                                            : middle + random.uniform(-half, half);
        const Vec3d p = origin + t * axis + 0.999999 * share * (radius + t * spread) * side;
        ++counts.points;
        const std::map<std::uint32_t, double> truth = distances(field, whole, p);
        for (const std::vector<Kept>& list : kept) {
            std::map<std::uint32_t, double> found = distances(field, list, p);
            for (const auto& [source, least] : truth) {
                ASSERT_TRUE(found.contains(source));
                ASSERT_LE(found[source], least * (1 + 1e-7) + 1e-7);
            }
        }
    }
}

class NearestPartsOf : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Each, NearestPartsOf, testing::Values(Shape::curve, Shape::polyline),
                         [](const auto& shape) { return tools::word_of(shape.param); });

TEST_P(NearestPartsOf, StayOnEveryInstructionSet) {
    const std::uint64_t seed = tools::announced_seed(171);
    for (const std::string_view name : instruction_sets()) {
        SCOPED_TRACE(std::string(name));
        const tools::OnInstructionSet on(name);
        Random random(seed);
        Counts counts;
        for (int trial = 0; trial < 250; ++trial) {
            SCOPED_TRACE("trial " + std::to_string(trial));
            const Field field = compile(bent_scene(GetParam(), random));
            const Vec3d target = random.in_cube(1.5),
                        origin = target + 4.0 * unit(random.in_cube(1));
            const Vec3d axis = unit(target - origin);
            const double half = std::pow(10.0, random.uniform(-3, -0.3));
            const double radius = random.chance(0.3) ? 0 : half * random.uniform(0, 2);
            const double spread = random.chance(0.5) ? 0 : half * random.uniform(0, 0.3);
            expect_nearest_kept(field, origin, axis,
                                std::sqrt(dot(target - origin, target - origin)), half, radius,
                                spread, random, counts);
            if (HasFatalFailure()) return;
        }
        std::printf("%.*s: %zu points, %zu parts, %zu kept, %zu pieces\n",
                    static_cast<int>(name.size()), name.data(), counts.points, counts.parts,
                    counts.kept, counts.pieces);
        // It is worth the while: most parts leave.
        EXPECT_LT(2 * counts.kept, counts.parts);
        if (GetParam() == Shape::curve) {
            EXPECT_GT(12 * counts.pieces, counts.kept);
        }
    }
}

}  // namespace
}  // namespace ivory
