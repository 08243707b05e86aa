// Packets against single rays and against the reference of 256 bits.
#include "core/trace/packet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/direction.h"
#include "core/math/instruction_sets.h"
#include "core/trace/methods/proved.h"
#include "core/trace/packet_steps.h"
#include "tests/core/trace/bundle_windows.h"
#include "tests/reference/verdict.h"
#include "tests/tools/instruction_sets.h"
#include "tests/tools/kinds.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using tools::Random;
using tools::RayKind;

// `count` rays around one, at most about `spread` away from it, from origins about `radius` around its own.
std::unique_ptr<RayBundle> bundle_around(const Ray& ray, double spread, std::size_t count,
                                         Random& random, double radius = 0) {
    auto rays = std::make_unique<RayBundle>();
    rays->has_origins = radius > 0;
    const Vec3d axis = unit(unit(ray.direction));
    double farthest = 0, farthest_origin = 0, farthest_along = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const Vec3d d = unit(unit(axis + spread * random.in_cube(0.5)));
        Vec3d origin = ray.origin;
        if (radius > 0) {
            origin = origin + random.uniform(0, radius) * unit(cross(axis, random.in_cube(1)));
        }
        rays->add({origin, d});
        const Vec3d aside = origin - ray.origin;
        farthest_origin = std::max(farthest_origin, std::sqrt(dot(aside, aside)));
        farthest_along = std::max(farthest_along, std::abs(dot(aside, axis)));
        const Vec3d off = d - axis;
        farthest = std::max(farthest, std::sqrt(dot(off, off)));
    }
    rays->bundle = {ray.origin, axis, farthest * 1.001 + 1e-15, farthest_origin * 1.001};
    if (farthest_origin > 0) {
        rays->bundle.spread += (farthest_along + 1e-15) / farthest_origin * 1.01;
    }
    return rays;
}

bool usable(const Ray& ray) {
    const double length = std::hypot(ray.direction.x, ray.direction.y, ray.direction.z);
    return length > 1e-100 && length < 1e100;
}

struct Case {
    std::string name;
    tools::SceneRecipe recipe;
    double tolerance;
    double least_decided;  // share of the rays
    bool hits = true;      // whether packets can prove any: not with cells below 8 ulp of t
};

class PacketOfRays : public testing::TestWithParam<Case> {};

// What packets decide by themselves is what one ray alone is answered: the same grid lines, or
// where rounding hides a sign from the single ray, some between its own. Of some the reference says
// the same. And what is decided of a ray does not depend on the others.
TEST_P(PacketOfRays, AnswersAsSingleRaysDo) {
    const Case& c = GetParam();
    const Proved proved;
    PacketTracer packets;
    int bundles = 0, unusable = 0, again_hits = 0;
    int rays_traced = 0, decided = 0, hits = 0, judged = 0, wider = 0;
    for (std::uint64_t seed = 7100; seed < 7106; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Scene scene = random_scene(c.recipe, seed);
        const Field field = compile(scene);
        const ElementList list = all_elements(field);
        const reference::ReferenceField exact(scene);
        const PacketTracer::Settings settings{
            c.tolerance, 0.5 * std::min(c.tolerance, 0x1p-20) * field.least_width};
        Random random(seed);
        for (std::size_t kind = 0; kind < tools::ray_kind_words.size(); ++kind) {
            for (const Ray& ray : nasty_rays(scene, static_cast<RayKind>(kind), 4, seed + kind)) {
                if (!usable(ray)) {
                    ++unusable;
                    continue;
                }
                ++bundles;
                const double spread = std::pow(10.0, random.uniform(-5, -0.7));
                // Every third one from origins side by side.
                const double radius =
                    bundles % 3 == 0 ? field.least_width * std::pow(10.0, random.uniform(-4, -1))
                                     : 0;
                const auto rays = bundle_around(ray, spread, 5 + random.below(40), random, radius);
                BundleIsolations found;
                Counts counts;
                packets.isolate(field, list, *rays, settings, found, nullptr, counts);
                // Every third of them without the others.
                const auto some = std::make_unique<RayBundle>();
                some->bundle = rays->bundle;
                some->has_origins = rays->has_origins;
                for (std::size_t k = 0; k < rays->size(); k += 3) {
                    some->add(rays->ray(k));
                }
                BundleIsolations again;
                packets.isolate(field, list, *some, settings, again, nullptr, counts);
                for (std::size_t k = 0; k < some->size(); ++k) {
                    ASSERT_EQ(again[k].status, found[3 * k].status);
                    if (again[k].status != Status::hit) continue;
                    ++again_hits;
                    ASSERT_EQ(again[k].t.lo, found[3 * k].t.lo);
                    ASSERT_EQ(again[k].t.hi, found[3 * k].t.hi);
                }
                for (std::size_t k = 0; k < rays->size(); ++k) {
                    ++rays_traced;
                    if (found[k].status == Status::unresolved) continue;
                    ++decided;
                    hits += found[k].status == Status::hit;
                    const Isolation alone = proved.isolate(field, list, rays->ray(k),
                                                           {.tolerance = c.tolerance}, counts);
                    ASSERT_TRUE(found[k].status == alone.status ||
                                alone.status == Status::unresolved);
                    bool differs = false;
                    if (possibly_hit(alone.status)) {
                        ASSERT_GE(found[k].t.lo, alone.t.lo);
                        ASSERT_LE(found[k].t.hi, alone.t.hi);
                        differs = found[k].t.lo != alone.t.lo || found[k].t.hi != alone.t.hi;
                        wider += differs;
                    }
                    if (random.below(100) != 0 && !differs) continue;
                    Answer answer{found[k], {}};
                    if (found[k].status == Status::hit) {
                        answer.surface =
                            proved.surface(field, list, rays->ray(k), midpoint(found[k].t), {});
                    }
                    const reference::Verdict verdict =
                        check(exact, rays->ray(k), c.tolerance, answer);
                    EXPECT_EQ(verdict.fault, reference::Fault::none) << word(verdict.fault);
                    ++judged;
                }
            }
        }
    }
    // Of rays without a direction or with one that is hardly a number there are no bundles.
    EXPECT_GT(bundles, 10 * unusable);
    EXPECT_GT(rays_traced, 2000);
    if (c.hits) {
        EXPECT_GT(hits, c.least_decided / 5 * rays_traced);
        EXPECT_GT(again_hits, hits / 4);
    } else {
        EXPECT_EQ(hits, 0);
    }
    EXPECT_GE(judged, decided / 200);
    // Packets see a far ray relative to its window: near the end of double, and where the field
    // hardly rises through T, they tell more signs; where it hides one, they compensate their sums.
    EXPECT_LE(wider, c.tolerance < 1e-11 || c.recipe.critical ? hits / 3 : hits / 500);
    EXPECT_GE(decided, c.least_decided * rays_traced);
    std::printf(
        "%d bundles, %d unusable, %d rays, %d decided by packets, %d hits, %d of them twice, "
        "%d judged by the reference, %d differ; %s\n",
        bundles, unusable, rays_traced, decided, hits, again_hits, judged, wider,
        std::string(instruction_set()).c_str());
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, PacketOfRays,
    testing::Values(Case{"few", {.elements = 4}, 1e-6, 0.5},
                    Case{"some", {.elements = 12}, 1e-9, 0.5},
                    Case{"many", {.elements = 60}, 1e-6, 0.5},
                    Case{"coarse", {.elements = 8}, 0.1, 0.5},
                    Case{"fine", {.elements = 8}, 1e-12, 0.2},
                    Case{"finest", {.elements = 4}, 1e-15, 0.1, false},
                    Case{"shifted", {.elements = 8, .shift = 1e6}, 1e-6, 0.2},
                    Case{"small", {.elements = 8, .scale = 1e-6}, 1e-9, 0.4},
                    Case{"large", {.elements = 8, .scale = 1e6}, 1e-9, 0.5},
                    Case{"critical", {.elements = 8, .critical = true}, 1e-9, 0.2}),
    [](const auto& test_case) { return test_case.param.name; });

std::vector<Case> one_kind_alone() {
    std::vector<Case> cases;
    for (const tools::ElementKind& kind : tools::every_kind) {
        // Of tapers an end ball that nearly holds the other leaves f'' unknown on most rays.
        // Tapers beyond their apex and wild curves are left to single rays.
        const double least_decided = kind.shape == Shape::curve ? 0.2
                                     : is_taper(kind.shape)     ? 0.3
                                                                : 0.5;
        cases.push_back({tools::word_of(kind), {.elements = 6, .only = kind}, 1e-6, least_decided});
    }
    return cases;
}
INSTANTIATE_TEST_SUITE_P(Each, PacketOfRays, testing::ValuesIn(one_kind_alone()),
                         [](const auto& test_case) { return test_case.param.name; });

Element point(const Vec3d& position, double strength, double width) {
    Element element;
    element.skeleton = PointSkeleton{position};
    element.strength = strength;
    element.width = width;
    return element;
}

Isolation alone_in_packet(const Scene& scene, const Ray& ray, double tolerance) {
    const Field field = compile(scene);
    PacketTracer packets;
    const auto rays = std::make_unique<RayBundle>();
    rays->add(ray.direction);
    rays->bundle = {ray.origin, ray.direction, 1e-15};
    BundleIsolations found;
    Counts counts;
    packets.isolate(field, all_elements(field), *rays,
                    {tolerance, 0.5 * std::min(tolerance, 0x1p-20) * field.least_width}, found,
                    nullptr, counts);
    return found[0];
}

// Rays along the axis' direction that pass a wide ring where the field only just exceeds T: what
// the distance from the ring's axis is off by is most of the error there. Every instruction set has
// roots of its own.
TEST(Packet, WideRingsAreNotMissedOnAnyInstructionSet) {
    Random random(tools::announced_seed(73));
    std::set<const PacketSteps*> used;
    for (const std::string_view name : instruction_sets()) {
        SCOPED_TRACE(std::string(name));
        const tools::OnInstructionSet on(name);
        EXPECT_TRUE(used.insert(&packet_steps()).second);
        int hits = 0;
        for (int n = 0; n < 1500; ++n) {
            const double radius = random.uniform(20, 140), off = random.uniform(0.3, 1.5);
            const double angle = random.uniform(0, 6.28);
            Scene scene;
            scene.elements = {
                {.skeleton = CircleSkeleton{{0, 0, 0}, {0, 0, 1}, radius}, .width = 1}};
            const Vec3d origin{(radius - off) * std::cos(angle), (radius - off) * std::sin(angle),
                               30};
            const double distance = std::hypot(origin.x, origin.y) - radius;
            // By more than plain double's error in that.
            const double excess = std::exp(random.uniform(std::log(1e-6), std::log(2e-3)));
            scene.threshold = std::exp(-distance * distance) * (1 - excess);
            const Isolation found = alone_in_packet(scene, {origin, {0, 0, -1}}, 1e-6);
            ASSERT_NE(found.status, Status::miss) << "radius " << radius << ", off " << off
                                                  << ", angle " << angle << ", excess " << excess;
            hits += found.status == Status::hit;
        }
        EXPECT_GT(hits, 500);
    }
}

// A thousand equal elements are one of as many times the strength, exactly, but each addition is
// rounded alike: only sums that carry along what they lose find the same cells.
TEST(Packet, ManyEqualElementsAddUpToOne) {
    constexpr int count = 1024;
    const double tolerance = 1e-13;
    Random random(tools::announced_seed(74));
    int decided = 0;
    for (int n = 0; n < 100; ++n) {
        Scene one;
        one.threshold = random.uniform(0.2, 0.8);
        one.elements = {{.skeleton = PointSkeleton{random.in_cube(0.3)}}};
        Scene many = one;
        many.elements.assign(count, one.elements.front());
        for (Element& element : many.elements) element.strength = 1.0 / count;
        const reference::ReferenceField exact(one);
        const Vec3d origin = 4.0 * unit(random.in_cube(1));
        const Ray ray{origin, unit(random.in_cube(0.3) - origin)};
        const Isolation found = alone_in_packet(many, ray, tolerance);
        if (found.status == Status::unresolved) continue;
        ++decided;
        const SurfacePoint surface =
            Proved().surface(compile(one), all_elements(compile(one)), ray, midpoint(found.t), {});
        const reference::Verdict verdict = check(exact, ray, tolerance, {found, surface});
        EXPECT_EQ(verdict.fault, reference::Fault::none)
            << word(verdict.fault) << ", picture " << n;
    }
    EXPECT_GT(decided, 50);
}

// The axis passes through a skeleton far away and the surface is tiny around it: the distances at
// the ends of a window add up to its length but for rounding.
TEST(Packet, ATinySurfaceFarAwayOnTheAxisIsNotMissed) {
    Random random(5);
    for (const double distance : {1e5, 1e6, 1e8}) {
        Scene scene;
        scene.threshold = 1 - distance * 1e-17;
        Element segment;
        segment.skeleton = SegmentSkeleton{{0, 0, 0}, {0, 0, 0}};
        scene.elements = {segment, point({30, 30, 30}, 1, 1)};
        int checked = 0, decided = 0;
        for (int n = 0; n < 40; ++n) {
            const Vec3d to = unit(unit(random.in_cube(1)));
            const Ray ray{{-distance * to.x, -distance * to.y, -distance * to.z}, to};
            const Field field = compile(scene);
            Counts counts;
            const Isolation scalar =
                Proved().isolate(field, all_elements(field), ray, {.tolerance = 1e-6}, counts);
            if (scalar.status != Status::hit) continue;
            ++checked;
            const Isolation found = alone_in_packet(scene, ray, 1e-6);
            EXPECT_NE(found.status, Status::miss) << distance << ", ray " << n;
            if (found.status != Status::hit) continue;
            ++decided;
            EXPECT_TRUE(is_subset(found.t, scalar.t)) << distance << ", ray " << n;
        }
        std::printf("%g away: %d checked, %d decided by the packet\n", distance, checked, decided);
        EXPECT_GE(checked, 30);
        // Farther away cells are below 8 units in the last place of t.
        if (distance < 1e7) {
            EXPECT_GE(decided, 30);
        }
    }
}

TEST(Packet, ATallyIsOfTheFirstRaysAlone) {
    const auto answers = std::make_unique<BundleIsolations>();
    Random random(9);
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, std::size_t{77}, std::size_t{256}}) {
        for (const bool all_hit : {true, false}) {
            BundleTally expected;
            for (std::size_t k = 0; k < BundleIsolations::room; ++k) {
                const auto status = static_cast<Status>(all_hit ? 0 : random.below(5));
                const double lo = random.uniform(1, 2), hi = lo + random.uniform(0, 1);
                answers->set(k, {status, {lo, hi}});
                if (k >= count) continue;
                ++expected.rays[static_cast<std::size_t>(status)];
                if (!possibly_hit(status)) continue;
                double& widest =
                    status == Status::unresolved ? expected.widest_unresolved : expected.widest;
                widest = std::max(widest, hi - lo);
            }
            const BundleTally tally = tally_of(*answers, count);
            EXPECT_EQ(tally.rays, expected.rays);
            EXPECT_EQ(tally.widest, expected.widest);
            EXPECT_EQ(tally.widest_unresolved, expected.widest_unresolved);
        }
    }
}

// A slope whose square is beyond float makes the step infinite: that is no proof of anything.
TEST(Packet, AStepThatOverflowsDecidesNothing) {
    const auto lanes = std::make_unique<Lanes>();
    const Vec3d axis{1, 0, 0};
    const auto rays = std::make_unique<RayBundle>();
    rays->add(axis);
    BundleIsolations found;
    lanes->count = 1;
    lanes->rays = rays->columns();
    lanes->t_lo = found.t_lo.data();
    lanes->t_hi = found.t_hi.data();
    packet_steps().prepare(*lanes);

    Window window;
    window.begin = 0;
    window.middle = 0.5;
    window.end = 1;
    window.axis = axis;
    window.tau_begin = -0.5f;
    window.tau_end = 0.5f;
    window.rise = window.fall = 1;
    // f falls from the window's begin on, towards a point of negative strength at its end.
    window.strong.entry.push_back({.cx = 0.5f,
                                   .cy = 0,
                                   .cz = 0,
                                   .inverse_square = 1,
                                   .strength = -1e12f,
                                   .slope = 1e20f,
                                   .taper_rate = 0,
                                   .joins = 0,
                                   .mx = 0,
                                   .my = 0,
                                   .mz = 0,
                                   .parameter = 0});
    window.strong.end_group(0, 1);
    window.strong.size = 1;
    window.coarse_usable = true;
    Cancellation stop;
    packet_steps().walk(window, 1, 1, 1e-6, 0, 1, *lanes, stop);
    EXPECT_EQ(lanes->state[0], Lanes::doubtful);
}

// What the walk hands on is so close to its root that one step of the enclosure, in double, does
// for nearly all, on coarse cells and on fine ones.
TEST(Packet, GuessesAreAsCloseAsTheCellsAsk) {
    for (const double cell : {0x1p-21, 0x1p-31}) {
        std::uint64_t candidates = 0, steps = 0;
        for (std::uint64_t seed = 90; seed < 110; ++seed) {
            Random random(seed);
            const Field field = compile(tools::mixed_scene(60, seed));
            const auto rays = bundle_around(
                {{0, 0, 3.9}, unit(0.3 * random.in_cube(1) - Vec3d{0, 0, 3.9})}, 0.02, 256, random);
            BundleWindows along;
            ASSERT_TRUE(along.build(field, all_elements(field), rays->bundle, 1e-9));
            BundleIsolations found;
            const auto lanes = std::make_unique<Lanes>();
            lanes->count = rays->count;
            lanes->rays = rays->columns();
            lanes->t_lo = found.t_lo.data();
            lanes->t_hi = found.t_hi.data();
            packet_steps().prepare(*lanes);
            std::array parts{whole_of(rays->bundle)};
            parts[0].end = static_cast<std::uint32_t>(rays->count);
            const auto every = [](const BundlePart&, double, double) { return true; };
            const double T = along.threshold(), unit = along.unit();
            along.for_windows(parts, {}, every, 1000, [&](Window& window, const BundlePart& all) {
                if (!window.coarse_usable) return false;
                const double length = cell * field.least_width;
                Cancellation stop;
                packet_steps().walk(window, T, unit, length, 0, all.end, *lanes, stop);
                candidates += static_cast<std::uint64_t>(
                    std::count(lanes->state.begin(), lanes->state.begin() + all.end,
                               std::int32_t{Lanes::candidate}));
                along.complete(window);
                steps += packet_steps().enclose(window, T, unit, length, 0, 0, all.end,
                                                Lanes::undecided, Lanes::undecided, *lanes, stop);
                return true;
            });
        }
        EXPECT_GT(candidates, 500u);
        EXPECT_LT(static_cast<double>(steps), 1.15 * static_cast<double>(candidates));
        std::printf("%llu candidates, %llu steps\n", static_cast<unsigned long long>(candidates),
                    static_cast<unsigned long long>(steps));
    }
}

// Large strengths that cancel, beside an element so thin that windows may become very short: the
// rays are left to other means after a bounded number of windows, and none is called a miss.
TEST(Packet, WorkIsBounded) {
    Scene scene;
    scene.threshold = 1;
    scene.elements = {point({0, 0, 0}, 1e8, 1), point({0, 0, 0}, -2e8, 1),
                      point({0, 0, 2}, 3, 1e-4), point({0, 0, -30}, 3, 1)};
    const Field field = compile(scene);
    PacketTracer packets;
    Random random(6);
    const auto rays = bundle_around({{0.1, 0.2, 20}, {0, 0, -1}}, 1e-3, 256, random);
    BundleIsolations found;
    Counts counts;
    packets.isolate(field, all_elements(field), *rays, {1e-6, 0.5 * 0x1p-20 * field.least_width},
                    found, nullptr, counts);
    EXPECT_LT(counts.evaluations, 256u * 2 * 1024);
    for (std::size_t k = 0; k < rays->size(); ++k) EXPECT_NE(found.status[k], Status::miss);
}

// What a picture shows is what answers tell, but for float: normals within 2^-10 and colours within
// 2^-14, of all kinds of elements and of those that cancel each other.
TEST(Packet, WhatIsSeenIsTheSurfaceOfTheAnswer) {
    const Proved proved;
    int seen = 0;
    double worst_normal = 0, worst_color = 0;
    for (std::uint64_t seed = 300; seed < 360; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Scene scene =
            tools::random_scene({.elements = 6 + 3 * (seed % 10), .critical = seed % 4 == 0}, seed);
        const Field field = compile(scene);
        const ElementList all = all_elements(field);
        Random random(seed);
        for (const Ray& toward : nasty_rays(scene, RayKind::random, 4, seed)) {
            const auto rays = bundle_around(toward, 0.05, 100, random);
            BundleIsolations found;
            const auto surfaces = std::make_unique<BundleSurfaces>();
            surfaces->exact = true;
            Counts counts;
            proved.trace_bundle(field, all, *rays, {.tolerance = 1e-6}, found, surfaces.get(),
                                counts);
            for (std::size_t k = 0; k < 100; ++k) {
                ASSERT_EQ(surfaces->seen(k), possibly_hit(found[k].status));
                if (!surfaces->seen(k)) continue;
                ++seen;
                const SurfacePoint& point = surfaces->points[k];
                const Vec3d normal{surfaces->nx[k], surfaces->ny[k], surfaces->nz[k]};
                const Vec3d color{surfaces->r[k], surfaces->g[k], surfaces->b[k]};
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    worst_normal =
                        std::max(worst_normal, std::abs(normal[axis] - point.normal[axis]));
                    worst_color = std::max(worst_color, std::abs(color[axis] - point.color[axis]));
                }
            }
        }
    }
    EXPECT_GT(seen, 1000);
    EXPECT_LT(worst_normal, 0x1p-10);
    EXPECT_LT(worst_color, 0x1p-14);
    std::printf("%d seen, off by %.2g in normals, %.2g in colours\n", seen, worst_normal,
                worst_color);
}

// A ray alone among many elements looks at those near it, and is answered as by all of them.
TEST(Packet, ARayAloneAmongManyIsAnsweredAsByAll) {
    const Proved proved;
    int hits = 0, misses = 0;
    Counts counts;
    for (std::uint64_t seed = 50; seed < 52; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Scene scene = tools::random_scene({.elements = 300}, seed);
        const Field field = compile(scene);
        const ElementList list = all_elements(field);
        for (std::size_t kind = 0; kind < tools::ray_kind_words.size(); ++kind) {
            for (const Ray& ray : nasty_rays(scene, static_cast<RayKind>(kind), 4, seed + kind)) {
                MethodOptions options;
                options.tolerance = 1e-6;
                const Isolation near = proved.isolate(field, list, ray, options, counts);
                Counts of_all;
                options.skipping.lists = false;
                const Isolation all = proved.isolate(field, list, ray, options, of_all);
                EXPECT_EQ(of_all.skipping.list_left_out, 0u);
                ASSERT_EQ(near.status, all.status);
                hits += near.status == Status::hit;
                misses += near.status == Status::miss;
                if (near.status != Status::hit) continue;
                ASSERT_EQ(near.t.lo, all.t.lo);
                ASSERT_EQ(near.t.hi, all.t.hi);
            }
        }
    }
    EXPECT_GT(hits, 10);
    EXPECT_GT(misses, 0);
    EXPECT_GT(counts.skipping.list_left_out, counts.skipping.list_elements / 20);
    std::printf("%d hits, %d misses, %llu of %llu left out\n", hits, misses,
                static_cast<unsigned long long>(counts.skipping.list_left_out),
                static_cast<unsigned long long>(counts.skipping.list_elements));
}

// On fine grids packets often know the root but not on which side of a line it is. What is found
// then is judged by the reference, and far fewer stay open than have a line so near.
// Where hundreds of elements overlap, windows are walked through as polynomials: the same answers, on every
// instruction set, and the reference says so.
TEST(Packet, CrowdsAreAnsweredAsSingleRaysAre) {
    const std::uint64_t seed = tools::announced_seed(76);
    for (const std::string_view name : instruction_sets()) {
        SCOPED_TRACE(std::string(name));
        const tools::OnInstructionSet on(name);
        Random random(seed);
        const Proved proved;
        PacketTracer packets;
        int condensed = 0, rays_traced = 0, open = 0, hits = 0, misses = 0, judged = 0;
        for (int trial = 0; trial < 6; ++trial) {
            Scene scene;
            const std::size_t count = trial % 2 == 0 ? 400 : 900;
            const double width = trial < 3 ? 0.3 : 0.15;
            for (std::size_t k = 0; k < count; ++k) {
                Vec3d place;
                do place = random.in_cube(1);
                while (dot(place, place) > 1);
                scene.elements.push_back({.skeleton = PointSkeleton{place},
                                          .strength = random.chance(0.2) ? -1.0 : 1.0,
                                          .width = width * random.uniform(0.9, 1.1)});
            }
            // About half of what it is inside.
            scene.threshold = 0.6 * static_cast<double>(count) * std::pow(width, 3) * 1.33 *
                              random.uniform(0.4, 0.7);
            const Field field = compile(scene);
            const ElementList list = all_elements(field);
            const reference::ReferenceField exact(scene);
            const double tolerance = 1e-6;
            const PacketTracer::Settings settings{tolerance, 0.5 * tolerance * field.least_width};
            for (int bundle = 0; bundle < 12; ++bundle) {
                const Vec3d aim = 0.8 * random.in_cube(1);
                const Vec3d from = 4.0 * unit(random.in_cube(1));
                const double spread = std::pow(10.0, random.uniform(-3.5, -1.7));
                const auto rays = bundle_around({from, aim - from}, spread, 64, random);
                BundleIsolations found;
                Counts counts;
                packets.isolate(field, list, *rays, settings, found, nullptr, counts);
                Descent descent;
                if (descent.build(field, list, rays->bundle, tolerance)) {
                    const BundlePart whole = [&] {
                        BundlePart part = whole_of(rays->bundle);
                        part.end = 64;
                        return part;
                    }();
                    descent.begin({&whole, 1}, rays->columns(), 1000, true);
                    const auto all = [](const BundlePart&, double, double) { return true; };
                    while (const Window* const window = descent.next(all)) {
                        condensed += window->condensed != nullptr;
                    }
                }
                for (std::size_t k = 0; k < rays->size(); ++k) {
                    ++rays_traced;
                    open += found[k].status == Status::unresolved;
                    if (found[k].status == Status::unresolved || k % 4 != 0) continue;
                    const Isolation alone =
                        proved.isolate(field, list, rays->ray(k), {.tolerance = tolerance}, counts);
                    ASSERT_EQ(found[k].status, alone.status);
                    (found[k].status == Status::hit ? hits : misses) += 1;
                    if (found[k].status == Status::hit) {
                        ASSERT_GE(found[k].t.lo, alone.t.lo);
                        ASSERT_LE(found[k].t.hi, alone.t.hi);
                    }
                    if (k != 0) continue;
                    Answer answer{found[k], {}};
                    if (found[k].status == Status::hit) {
                        answer.surface =
                            proved.surface(field, list, rays->ray(k), midpoint(found[k].t), {});
                    }
                    const reference::Verdict verdict =
                        check(exact, rays->ray(k), tolerance, answer);
                    EXPECT_EQ(verdict.fault, reference::Fault::none) << word(verdict.fault);
                    ++judged;
                }
            }
        }
        std::printf(
            "%d windows condensed, %d rays, %d open, %d hits and %d misses compared, %d judged; "
            "%s\n",
            condensed, rays_traced, open, hits, misses, judged, std::string(name).c_str());
        EXPECT_GT(condensed, 200);
        EXPECT_GT(hits, 200);
        EXPECT_GT(misses, 50);
        EXPECT_GT(judged, 50);
        EXPECT_LE(open, rays_traced / 50);
    }
}

TEST(Packet, RootsBesideGridLinesAreSettled) {
    const Proved proved;
    int judged = 0, unresolved = 0;
    std::uint64_t alone = 0;
    for (std::uint64_t seed = 900; seed < 912; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Scene scene = tools::random_scene({.elements = 10}, seed);
        const Field field = compile(scene);
        const ElementList all = all_elements(field);
        const reference::ReferenceField exact(scene);
        Random random(seed);
        const double tolerance = seed % 2 == 0 ? 1e-12 : 1e-11;
        const auto rays =
            bundle_around(nasty_rays(scene, RayKind::random, 1, seed).front(), 0.1, 200, random);
        BundleIsolations found;
        Counts counts;
        proved.trace_bundle(field, all, *rays, {.tolerance = tolerance}, found, nullptr, counts);
        alone += counts.skipping.rays_alone;
        for (std::size_t k = 0; k < rays->size(); ++k) {
            unresolved += found.status[k] == Status::unresolved;
            if (found.status[k] != Status::hit || random.below(4) != 0) continue;
            const Answer answer{found[k],
                                proved.surface(field, all, rays->ray(k), midpoint(found[k].t), {})};
            const reference::Verdict verdict = check(exact, rays->ray(k), tolerance, answer);
            EXPECT_EQ(verdict.fault, reference::Fault::none) << word(verdict.fault);
            ++judged;
        }
    }
    EXPECT_GT(judged, 50);
    EXPECT_GT(alone, 50u);
    EXPECT_LT(static_cast<std::uint64_t>(unresolved), alone / 10);
    std::printf("%d judged, %llu alone, %d unresolved\n", judged,
                static_cast<unsigned long long>(alone), unresolved);
}

// What the contract lets differ between instruction sets, on all that this machine has: a hit is
// never a miss, and enclosures overlap.
TEST(Packet, InstructionSetsAgree) {
    constexpr std::size_t count = 200;
    const std::vector<std::string_view> targets = instruction_sets();
    int rays_traced = 0, hits = 0, both = 0;
    std::vector<int> decided(targets.size());
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Scene scene = tools::random_scene({.elements = 12}, seed);
        const Field field = compile(scene);
        const auto toward = nasty_rays(scene, RayKind::random, 1, seed).front();
        Random random(seed);
        const auto rays = bundle_around(toward, 0.3, count, random);
        std::vector<BundleIsolations> found(targets.size());
        for (std::size_t n = 0; n < targets.size(); ++n) {
            const tools::OnInstructionSet on(targets[n]);
            PacketTracer packets;
            Counts counts;
            packets.isolate(field, all_elements(field), *rays,
                            {1e-6, 0.5 * 0x1p-20 * field.least_width}, found[n], nullptr, counts);
        }
        for (std::size_t k = 0; k < count; ++k) {
            const Isolation first = found.front()[k];
            ++rays_traced;
            hits += first.status == Status::hit;
            for (std::size_t n = 0; n < targets.size(); ++n) {
                const BundleIsolations& other = found[n];
                const Status a = first.status, b = other[k].status;
                decided[n] += b != Status::unresolved;
                EXPECT_FALSE(a == Status::hit && b == Status::miss) << k;
                EXPECT_FALSE(a == Status::miss && b == Status::hit) << k;
                if (a != Status::hit || b != Status::hit) continue;
                ++both;
                EXPECT_LE(first.t.lo, other[k].t.hi);
                EXPECT_LE(other[k].t.lo, first.t.hi);
            }
        }
    }
    EXPECT_GT(hits, 100);
    // None knows much less than another.
    EXPECT_GE(both, 0.95 * hits * static_cast<double>(targets.size()));
    EXPECT_GT(decided.front(), rays_traced / 12);
    for (const int of_one : decided) EXPECT_GE(of_one, 0.9 * decided.front());
    std::printf("%zu instruction sets, %d rays, %d hits, %d on both\n", targets.size(), rays_traced,
                hits, both);
}

}  // namespace
}  // namespace ivory
