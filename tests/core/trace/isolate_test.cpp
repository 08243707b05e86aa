// Root isolation: closed forms, starts inside, tangents, budgets, and one answer from any list.
#include "core/trace/isolate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "core/field/surface.h"
#include "core/render/camera.h"
#include "core/render/framing.h"
#include "core/scene/scene_json.h"
#include "core/trace/clip.h"
#include "core/trace/trace.h"
#include "tests/reference/level.h"
#include "tests/reference/multiprecision.h"
#include "tests/tools/kinds.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/on_skeleton.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using reference::Real;
using reference::RealInterval;
using tools::Random;
using tools::RayKind;

constexpr double tolerance = 1e-9;

Isolation isolate(const Field& field, const ElementList& list, const Ray& ray) {
    Counts counts;
    return find_method("proved")->isolate(field, list, ray, {.tolerance = tolerance}, counts);
}

Isolation isolate(const Scene& scene, const Ray& ray) {
    const Field field = compile(scene);
    return isolate(field, all_elements(field), ray);
}

Scene one(const Element& element, double threshold) {
    Scene scene;
    scene.threshold = threshold;
    scene.elements = {element};
    return scene;
}

// The q at which one element of strength 1 is at T: exact to 256 bits.
RealInterval level(KernelKind kernel, double threshold) {
    const RealInterval t(threshold);
    if (kernel == KernelKind::nishimura) {
        const RealInterval two_thirds = RealInterval(2) / RealInterval(3);
        return threshold > 2.0 / 3 ? sqrt((RealInterval(1) - t) / RealInterval(3))
                                   : RealInterval(1) - sqrt(two_thirds * t);
    }
    return sqrt(-RealInterval(rounded(mpfr_log, MPFR_RNDD, Real(threshold)),
                              rounded(mpfr_log, MPFR_RNDU, Real(threshold))));
}

void expect_hit(const Isolation& answer, const RealInterval& root, double width_allowed) {
    ASSERT_EQ(answer.status, Status::hit);
    EXPECT_TRUE(Real(answer.t.lo) <= root.hi && root.lo <= Real(answer.t.hi))
        << to_string(root.lo) << " is not in [" << answer.t.lo << ", " << answer.t.hi << ']';
    EXPECT_LE(answer.t.hi - answer.t.lo, width_allowed);
}

TEST(Isolate, SphereOfOnePointHasItsClosedForm) {
    for (const KernelKind kernel : {KernelKind::blinn, KernelKind::nishimura}) {
        for (const double threshold : {0.05, 0.3, 0.55, 0.9, 0.999}) {
            for (const double w : {1.0, 1e-3, 250.0}) {
                SCOPED_TRACE(std::string(kernel_word(kernel)) + ' ' + std::to_string(threshold));
                const Scene scene =
                    one({.skeleton = PointSkeleton{{0, 0, 0}}, .kernel = kernel, .width = w},
                        threshold);
                const RealInterval r = RealInterval(w) * level(kernel, threshold);
                // From outside, from the centre, and with a direction that is not a unit.
                expect_hit(isolate(scene, {{0, 0, -4 * w}, {0, 0, 1}}), RealInterval(4 * w) - r,
                           tolerance * w);
                expect_hit(isolate(scene, {{0, 0, 0}, {0, 0, 1}}), r, tolerance * w);
                expect_hit(isolate(scene, {{0, 0, 0}, {0, -8, 0}}), r / RealInterval(8),
                           tolerance * w / 8);
                EXPECT_EQ(isolate(scene, {{0, 0, -4 * w}, {0, 0, -1}}).status, Status::miss);
            }
        }
    }
}

class IsolateOf : public testing::TestWithParam<tools::ElementKind> {};
INSTANTIATE_TEST_SUITE_P(Each, IsolateOf, testing::ValuesIn(tools::every_kind),
                         tools::name_of_kind);

// Straight towards the nearest place of any skeleton the distance falls as t grows. Of tapers along
// their axis: beyond their broad end, where their width is that end's.
TEST_P(IsolateOf, SurfaceOfOneElementIsWhereItsKernelIsAtTheThreshold) {
    const std::uint64_t first = tools::announced_seed(75);
    for (const double threshold : {0.05, 0.3, 0.6, 0.9, 0.999}) {
        const double q = reference::level(GetParam().kernel, threshold).lo.to_double();
        for (std::uint64_t seed = first; seed < first + 10; ++seed) {
            SCOPED_TRACE(std::to_string(threshold) + ", seed " + std::to_string(seed));
            Scene scene = tools::random_scene({.elements = 1, .only = GetParam()}, seed);
            scene.threshold = threshold;
            Element& element = scene.elements[0];
            element.strength = 1;
            Random random(seed);
            Vec3d origin = random.in_cube(6), to;
            double width = element.width;                       // at the nearest place
            if (GetParam().shape == Shape::tapered_polyline) {  // of one width after all
                element.widths.assign(element.widths.size(), width);
            }
            if (GetParam().shape == Shape::taper) {
                const auto& [a, b] = std::get<SegmentSkeleton>(element.skeleton);
                const bool narrows = element.widths[0] > element.widths[1];
                width = std::max(element.widths[0], element.widths[1]);
                const Vec3d broad = narrows ? a : b;
                origin = broad + random.uniform(2, 20) * width * unit(broad - (narrows ? b : a));
                to = broad - origin;
            } else {
                to = tools::nearest_place(element.skeleton, origin) - origin;
            }
            const double distance = std::sqrt(dot(to, to));
            if (distance < 1.1 * q * width) continue;
            const Isolation answer = isolate(scene, {origin, (1 / distance) * to});
            ASSERT_EQ(answer.status, Status::hit);
            EXPECT_LE(answer.t.hi - answer.t.lo, tolerance * element.width);
            EXPECT_NEAR(midpoint(answer.t), distance - q * width,
                        tolerance * element.width + 1e-12 * width);
            EXPECT_EQ(isolate(scene, {origin, (-1 / distance) * to}).status, Status::miss);
        }
    }
}

TEST(Isolate, WyvillsSphereHasItsClosedForm) {
    const Scene scene = one(  // k(1/4) = 1/2
        {.skeleton = PointSkeleton{{0, 0, 0}}, .kernel = KernelKind::wyvill}, 0.5);
    expect_hit(isolate(scene, {{0, 0, -4}, {0, 0, 1}}), RealInterval(3.5), tolerance);
}

TEST(Isolate, CapsuleAndTorusHaveTheirClosedForms) {
    const RealInterval r = level(KernelKind::blinn, 0.55);
    const Scene capsule = one({.skeleton = SegmentSkeleton{{-1, 0, 0}, {1, 0, 0}}}, 0.55);
    expect_hit(isolate(capsule, {{-6, 0, 0}, {1, 0, 0}}), RealInterval(5) - r, tolerance);
    expect_hit(isolate(capsule, {{0.5, 0, 6}, {0, 0, -1}}), RealInterval(6) - r, tolerance);
    expect_hit(isolate(capsule, {{0.5, 0, 0}, {1, 0, 0}}), RealInterval(0.5) + r, tolerance);

    const Scene torus = one({.skeleton = CircleSkeleton{{0, 0, 0}, {0, 0, 3}, 2}}, 0.55);
    expect_hit(isolate(torus, {{-6, 0, 0}, {1, 0, 0}}), RealInterval(4) - r, tolerance);
    expect_hit(isolate(torus, {{0, 0, 0}, {0, 1, 0}}), RealInterval(2) - r, tolerance);
    expect_hit(isolate(torus, {{2, 0, 9}, {0, 0, -1}}), RealInterval(9) - r, tolerance);
    expect_hit(isolate(torus, {{0, -2, 0}, {0, 1, 0}}), r, tolerance);
    EXPECT_EQ(isolate(torus, {{0, 0, 9}, {0, 0, -1}}).status, Status::miss);
}

// The ray passes the centre at distance h; it meets the sphere exactly where h <= r.
TEST(Isolate, RaysThatNearlyTouchASphereAreNeverCalledWrong) {
    int misses = 0, hits = 0, unresolved = 0;
    for (const double threshold : {0.1, 0.55, 0.9}) {
        const Scene scene = one({.skeleton = PointSkeleton{{0, 0, 0}}}, threshold);
        const Real r = level(KernelKind::blinn, threshold).lo;
        const double near = r.to_double();
        for (int i = -60; i <= 60; ++i) {
            const double off = i == 0 ? 0 : std::copysign(std::exp2(-std::abs(i)), i);
            for (const double h : {near * (1 + off), near + i * 0x1p-53}) {
                const Isolation answer = isolate(scene, {{h, 0, -4}, {0, 0, 1}});
                misses += answer.status == Status::miss;
                hits += answer.status == Status::hit;
                unresolved += answer.status == Status::unresolved;
                EXPECT_TRUE(answer.status != Status::hit || Real(h) <= r) << off;
                EXPECT_TRUE(answer.status != Status::miss || Real(h) > r) << off;
                EXPECT_TRUE(answer.status != Status::unresolved || std::abs(h - near) < 1e-10);
                // The first root, if there is one, lies in the bracket.
                if (answer.status == Status::unresolved && Real(h) <= r) {
                    const RealInterval half = sqrt(sqr(RealInterval(r)) - sqr(RealInterval(h)));
                    const RealInterval root = RealInterval(4) - half;
                    EXPECT_TRUE(Real(answer.t.lo) <= root.hi && root.lo <= Real(answer.t.hi));
                }
            }
        }
    }
    EXPECT_GT(misses, 100);
    EXPECT_GT(hits, 100);
    EXPECT_GT(unresolved, 0);  // the very touch is beyond any rounding
}

// Where the field is known, too: a ray that starts inside reports where it leaves, and one that
// starts between two solids where it enters the next.
TEST(Isolate, StartsInsideReportTheFirstExit) {
    Scene scene = one({.skeleton = PointSkeleton{{0, 0, 0}}}, 0.55);
    scene.elements.push_back({.skeleton = PointSkeleton{{0, 0, 40}}});
    const RealInterval r = level(KernelKind::blinn, 0.55);
    expect_hit(isolate(scene, {{0, 0, 0.25}, {0, 0, 1}}), r - RealInterval(0.25), tolerance);
    expect_hit(isolate(scene, {{0, 0, 0.25}, {0, 0, -1}}), r + RealInterval(0.25), tolerance);
    expect_hit(isolate(scene, {{0, 0, 5}, {0, 0, 1}}), RealInterval(35) - r, tolerance);
}

TEST(Isolate, NoRayTakesMoreThanItsBudget) {
    const std::uint64_t first = tools::announced_seed(71);
    std::uint64_t most = 0;
    int ended = 0;
    for (std::uint64_t seed = first; seed < first + 2; ++seed) {
        const Scene scene = tools::random_scene({.elements = 6, .critical = seed % 2 == 0}, seed);
        const Field field = compile(scene);
        for (std::size_t kind = 0; kind < tools::ray_kind_words.size(); ++kind) {
            for (const Ray& own : nasty_rays(scene, static_cast<RayKind>(kind), 20, seed)) {
                const ScaledRay ray = scaled(own);
                const Interval<double> span = clip(ray, field.box);
                if (is_empty(span)) continue;
                FieldAlongRay along;
                along.build(field, all_elements(field), ray.origin, ray.direction, span);
                const Start start = span.lo > 0 ? Start::outside : Start::unknown;
                const Precision precision{0x1p-32 * field.least_width};
                Isolation full;
                for (const int budget : {4000, 30, 12, 8, 6, 5, 4, 3, 2, 1, 0}) {
                    Counts counts;
                    const Isolation answer =
                        isolate_first_root(along, span, start, precision, budget, counts);
                    EXPECT_LE(counts.evaluations, static_cast<std::uint64_t>(budget) + 4);
                    EXPECT_EQ(counts.element_evaluations, counts.evaluations * along.size());
                    if (budget == 4000) {
                        full = answer;
                        most = std::max(most, counts.evaluations);
                    } else if (answer.status == Status::unresolved) {
                        ++ended;
                        // It gave up, and still holds the root that it did not get to.
                        if (full.status == Status::hit) {
                            EXPECT_LE(answer.t.lo, full.t.hi);
                            EXPECT_GE(answer.t.hi, full.t.lo);
                        }
                    } else if (full.status != Status::unresolved) {
                        EXPECT_EQ(answer.status, full.status);
                    }
                }
            }
        }
    }
    EXPECT_GT(ended, 0);
    EXPECT_LT(most, 4000u);
    std::cout << "most evaluations " << most << '\n';
}

TEST(Isolate, AnswersOnFigureOneAreTheSameFromATilesListAndFromAllElements) {
    const Scene scene =
        read_scene(std::string(IVORY_SOURCE_DIR) + "/assets/scenes/figure-1.ivory.json");
    const Field field = compile(scene);
    const ElementList all = all_elements(field);
    constexpr int width = 160, height = 96, side = 16;
    const View view = make_view(camera_of(scene, field, width, height));
    int hits = 0, empty = 0;
    for (int y = 0; y < height; y += side) {
        for (int x = 0; x < width; x += side) {
            const PixelRect tile{x, y, x + side, y + side};
            const ElementList list =
                reaching_elements(field, all, cone_around(view, width, height, tile));
            empty += list.certainly_empty;
            for (int j = y; j < y + side; j += 2) {
                for (int i = x; i < x + side; i += 2) {
                    const Ray ray = primary_ray(view, width, height, i, j);
                    const Isolation a = isolate(field, all, ray), b = isolate(field, list, ray);
                    ASSERT_EQ(a.status, b.status) << i << ' ' << j;
                    ASSERT_EQ(a.t, b.t) << i << ' ' << j;
                    hits += a.status == Status::hit;
                }
            }
        }
    }
    EXPECT_GT(hits, 100);
    EXPECT_GT(empty, 0);
}

TEST(Isolate, HitsAreNoWiderThanTheToleranceOrTheLastPlacesAllow) {
    const std::uint64_t first = tools::announced_seed(72);
    int hits = 0;
    for (const double e : {0.1, 1e-3, 1e-9, 1e-15}) {
        const Scene scene = tools::random_scene({.elements = 8}, first);
        const Field field = compile(scene);
        const ElementList all = all_elements(field);
        for (const RayKind kind : {RayKind::random, RayKind::scaled, RayKind::far}) {
            for (const Ray& ray : nasty_rays(scene, kind, 40, first)) {
                Counts counts;
                const Isolation a =
                    find_method("proved")->isolate(field, all, ray, {.tolerance = e}, counts);
                if (a.status != Status::hit) continue;
                ++hits;
                const double m = midpoint(a.t);
                const FieldSample at = sample(field, all, ray.origin, ray.direction, m);
                const double speed = std::hypot(ray.direction.x, ray.direction.y, ray.direction.z);
                const double allowed = e * field.width[at.strongest] / speed * (1 + 1e-14);
                const double ulps = 16 * (next_up(a.t.hi) - a.t.hi);
                EXPECT_LE(a.t.hi - a.t.lo, std::max(allowed, ulps));
            }
        }
    }
    EXPECT_GT(hits, 0);
}

TEST(Precision, CellIsAPowerOfTwoAndNeverFinerThanEightUnitsInTheLastPlace) {
    const Precision precision{0x1p-30};
    EXPECT_EQ(precision.cell_at(0), 0x1p-30);
    EXPECT_EQ(precision.cell_at(1), 0x1p-30);
    Random random(tools::announced_seed(73));
    for (int i = 0; i < 1000; ++i) {
        const double t = std::exp(random.uniform(-100, 100));
        const double cell = precision.cell_at(t);
        int exponent = 0;
        EXPECT_EQ(std::frexp(cell, &exponent), 0.5);
        EXPECT_EQ(cell, std::max(0x1p-30, 8 * (next_up(t) - t)));
    }
}

// Pairs that cancel, as equal as doubles can be or all but: whatever they hide, a ray costs no more
// than a hundred ordinary ones, and where rounding hides the field everywhere far less.
TEST(Isolate, ElementsThatCancelAreSoonSeenToHideTheField) {
    constexpr int pairs = 10;
    for (const double strength : {1e5, 1e10, 1e15, 1e20, 1e100, 1e300}) {
        for (const int kind : {0, 1, 2, 3}) {
            SCOPED_TRACE(std::to_string(strength) + " kind " + std::to_string(kind));
            Scene scene;
            scene.threshold = 1e-6;
            Element element;
            element.skeleton = PointSkeleton{{0, 0, 0}};
            for (int i = 0; i < pairs; ++i) {
                Element minus = element;
                element.strength = strength;
                minus.strength = -strength;
                if (kind == 1) minus.skeleton = PointSkeleton{{0x1p-53, 0, 0}};
                if (kind == 2) minus.width = std::nextafter(1.0, 2.0);
                if (kind == 3) minus.kernel = KernelKind::wyvill;
                scene.elements.push_back(element);
                scene.elements.push_back(minus);
            }
            element.strength = 1;
            scene.elements.push_back(element);
            const Field field = compile(scene);
            std::uint64_t all = 0;
            constexpr int rays = 20;
            for (int k = 0; k < rays; ++k) {
                const Ray ray{{0, 0, 8}, {0.02 * k, 0.013 * k, -1}};
                Counts counts;
                const Isolation answer =
                    find_method("proved")->isolate(field, all_elements(field), ray, {}, counts);
                EXPECT_LE(counts.evaluations, 1510U);
                all += counts.evaluations;
                // Of the exact pairs the last element alone is left: its root is where it was.
                if (kind != 0 || answer.status == Status::miss) continue;
                Scene alone = scene;
                alone.elements = {element};
                const Isolation exact = isolate(alone, ray);
                ASSERT_EQ(exact.status, Status::hit);
                EXPECT_LE(answer.t.lo, exact.t.hi);
                EXPECT_GE(answer.t.hi, exact.t.lo);
            }
            if (strength >= 1e20 && kind < 3) {
                EXPECT_LE(all, rays * 100U);
            }
        }
    }
}

}  // namespace
}  // namespace ivory
