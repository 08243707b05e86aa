// Scaling changes no ray, and clipping leaves out only what is outside of the box.
#include "core/trace/clip.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/reference/multiprecision.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using reference::Real;
using reference::rounded;
using tools::Random;

// o + t d lies in the box, decided exactly: t d and the differences lo - o, hi - o fit 256 bits.
bool inside(const ScaledRay& ray, double t, const Box3& box) {
    for (std::size_t k = 0; k < 3; ++k) {
        const Real o(ray.origin[k]);
        const Real way = rounded(mpfr_mul, MPFR_RNDN, Real(t), Real(ray.direction[k]));
        if (way < rounded(mpfr_sub, MPFR_RNDN, Real(box.lo[k]), o)) return false;
        if (way > rounded(mpfr_sub, MPFR_RNDN, Real(box.hi[k]), o)) return false;
    }
    return true;
}

Ray some_ray(Random& random) {
    Ray ray{random.in_cube(random.chance(0.2) ? 1e8 : 6), random.in_cube(1)};
    if (random.chance(0.5)) ray.direction = -0.3 * ray.origin + 0.2 * random.in_cube(1);
    if (random.chance(0.2)) ray.direction[random.below(3)] = 0;
    if (random.chance(0.1)) ray.direction[random.below(3)] = 1e-260;
    if (random.chance(0.2)) ray.direction = std::pow(10, random.uniform(-150, 150)) * ray.direction;
    return ray;
}

Box3 some_box(Random& random) {
    const Vec3d a = random.in_cube(3), b = random.in_cube(3);
    Box3 box{a, a};
    box.include({b, b});
    if (random.chance(0.1)) box.hi.x = box.lo.x;
    return box;
}

TEST(Clip, RayIsOutsideOfTheBoxBeyondTheSpanAndAtItsUpperEnd) {
    Random random(tools::announced_seed(61));
    int hits = 0;
    for (int i = 0; i < 20'000; ++i) {
        const Box3 box = some_box(random);
        Ray own = some_ray(random);
        if (random.chance(0.2)) own.origin[random.below(3)] = box.hi.y;
        if (own.direction == Vec3d{}) continue;
        const ScaledRay ray = scaled(own);
        const Interval<double> span = clip(ray, box);
        SCOPED_TRACE(i);
        if (is_empty(span)) {
            for (int k = 0; k < 4; ++k) {
                ASSERT_FALSE(inside(ray, std::exp(random.uniform(-10, 20)), box));
            }
            ASSERT_FALSE(inside(ray, 0, box));
            continue;
        }
        ++hits;
        ASSERT_GE(span.lo, 0);
        ASSERT_LT(span.hi, infinity<double>);
        ASSERT_FALSE(inside(ray, span.hi, box));
        ASSERT_FALSE(inside(ray, span.hi * random.uniform(1, 3), box));
        if (span.lo > 0) {
            ASSERT_FALSE(inside(ray, next_down(span.lo), box));
            ASSERT_FALSE(inside(ray, span.lo * random.uniform(0, 1), box));
        }
    }
    EXPECT_GT(hits, 2000);
}

TEST(Clip, RaysAimedAtAPointOfTheBoxKeepIt) {
    Random random(tools::announced_seed(62));
    for (int i = 0; i < 20'000; ++i) {
        const Box3 box = some_box(random);
        const ScaledRay ray = scaled(some_ray(random));
        const double t = std::exp(random.uniform(-5, 5));
        if (!inside(ray, t, box)) continue;
        ASSERT_TRUE(contains(clip(ray, box), t)) << i << ' ' << t;
    }
}

TEST(Clip, SpansOfPlainRaysAreTheSlabs) {
    const Box3 box{{-1, -1, -1}, {1, 1, 1}};
    const auto near = [](const Interval<double>& span, double lo, double hi) {
        EXPECT_NEAR(span.lo, lo, 1e-15 * std::abs(hi));
        EXPECT_NEAR(span.hi, hi, 1e-15 * std::abs(hi));
    };
    near(clip(scaled({{0, 0, -3}, {0, 0, 1}}), box), 2, 4);
    near(clip(scaled({{0, 0, 3}, {0, 0, -1}}), box), 2, 4);
    near(clip(scaled({{0, 0, 0}, {0, 0, 1}}), box), 0, 1);
    near(clip(scaled({{1, 1, -3}, {0, 0, 1}}), box), 2, 4);  // along an edge
    EXPECT_TRUE(is_empty(clip(scaled({{0, 0, 3}, {0, 0, 1}}), box)));
    EXPECT_TRUE(is_empty(clip(scaled({{0, next_up(1.0), -3}, {0, 0, 1}}), box)));
    EXPECT_TRUE(is_empty(clip(scaled({{0, 0, -3}, {0, 0, 1}}), Box3{})));
}

TEST(ScaledRay, LargestComponentIsInOneToTwoAndTheRayIsTheSame) {
    Random random(tools::announced_seed(63));
    for (int i = 0; i < 2000; ++i) {
        Ray own = some_ray(random);
        if (i % 10 == 0) own.direction = {5e-324, 0, 1e-323};
        if (i % 10 == 1) own.direction = {1.7e308, -1e300, 3};
        if (own.direction == Vec3d{}) continue;
        const ScaledRay ray = scaled(own);
        const Vec3d& d = ray.direction;
        const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
        EXPECT_GE(largest, 1);
        EXPECT_LT(largest, 2);
        EXPECT_EQ(ray.origin, own.origin);
        for (std::size_t k = 0; k < 3; ++k) {
            const Real off = rounded(mpfr_sub, MPFR_RNDN, Real(d[k]),
                                     reference::scaled(Real(own.direction[k]), ray.shift));
            EXPECT_LE(std::abs(off.to_double()), std::abs(d[k]) < 1e-300 ? 5e-324 : 0);
        }
    }
}

TEST(ScaledRay, UnscalingHoldsTheIntervalAndRoundsOutwardOnlyWhereItMust) {
    Random random(tools::announced_seed(64));
    for (int i = 0; i < 5000; ++i) {
        ScaledRay ray;
        ray.shift = static_cast<int>(random.below(2100)) - 1050;
        const double lo = std::exp(random.uniform(-60, 60));
        const Interval<double> t{random.chance(0.1) ? 0 : lo, lo * (1 + random.uniform(0, 1))};
        const Interval<double> own = ray.unscaled(t);
        const Real exact_lo = reference::scaled(Real(t.lo), ray.shift);
        const Real exact_hi = reference::scaled(Real(t.hi), ray.shift);
        ASSERT_GE(own.lo, 0);
        ASSERT_TRUE(Real(own.lo) <= exact_lo && exact_hi <= Real(own.hi)) << ray.shift;
        ASSERT_TRUE(Real(next_up(next_up(own.lo))) >= exact_lo ||
                    own.lo >= next_down(largest<double>));
        ASSERT_TRUE(Real(next_down(next_down(own.hi))) <= exact_hi);
        if (std::abs(ray.shift) < 900) {
            ASSERT_TRUE(Real(own.lo) == exact_lo && Real(own.hi) == exact_hi) << ray.shift;
        }
    }
    EXPECT_TRUE(is_empty(ScaledRay{}.unscaled(Interval<double>::empty_set())));
}

}  // namespace
}  // namespace ivory
