// Enclosures of f, f' and f'' along rays hold what the reference of 256 bits finds inside of them.
#include "core/field/inclusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/trace/clip.h"
#include "tests/reference/reference.h"
#include "tests/tools/kinds.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using reference::Real;
using reference::RealInterval;
using tools::Random;
using tools::RayKind;

// The reference's values of f and f' at one double t.
struct Exact {
    double f_lo, f_hi, df_lo, df_hi;
};

// In units of 2^exponent, exactly.
Exact exact_at(const reference::ReferenceField& field, const Ray& ray, int exponent, double t) {
    auto germ = field.along(ray, RealInterval(Real(t)));
    const RealInterval unit(Real(std::ldexp(1.0, -exponent)));
    germ = {germ.value * unit, germ.slope * unit};
    return {germ.value.lo.to_double(MPFR_RNDD), germ.value.hi.to_double(MPFR_RNDU),
            germ.slope.lo.to_double(MPFR_RNDD), germ.slope.hi.to_double(MPFR_RNDU)};
}

// The reference has the true value in [lo, hi]; the enclosure has it too if the two meet.
void expect_meets(const Interval<double>& enclosure, double lo, double hi, const char* what,
                  double t) {
    EXPECT_TRUE(enclosure.lo <= hi && lo <= enclosure.hi)
        << what << " at t = " << t << ": exact [" << lo << ", " << hi << "], enclosed in ["
        << enclosure.lo << ", " << enclosure.hi << "]";
}

// The derivatives are of g, from which elements are left out where they are below 2^-50 T / n, s >= cut
// (core/field/inclusion.h): how much of f' may be missing. |F'| = 2 q |k'(s)| |d| / w, and -k' = k where
// a kernel does not end.
Interval<double> slope_of_what_is_left_out(const Field& field, double threshold, double speed) {
    double cut = 0;
    for (std::size_t i = 0; i < field.size(); ++i) {
        const bool ends = with_kernel(field.kernel[i], []<class K>() { return K::ends; });
        if (!ends) cut = std::max(cut, field.cut[i]);
    }
    const double most = threshold * 0x1p-50 * 2 * std::sqrt(cut) * speed / field.least_width;
    return {-most, most};
}

// Of a ray's windows: how many there were, and of how many the enclosures are about as narrow as
// what they enclose. All that is asked of `entire()` is to hold the field.
struct Seen {
    int rays = 0, skipped = 0, windows = 0, short_windows = 0;
    int narrow_at = 0, narrow_value = 0, narrow_slope = 0, bounded_curvature = 0;
};

// At most so many times the spread that was seen, beside rounding.
constexpr double wider = 4;

void check_ray(const Scene& scene, const Ray& original, std::uint64_t seed, Seen& seen) {
    const Field field = compile(scene);
    const ScaledRay ray = scaled(original);
    const Interval<double> span = clip(ray, field.box);
    ++seen.rays;
    if (is_empty(span) || !(span.hi < 1e100)) {
        ++seen.skipped;
        return;
    }
    FieldAlongRay along;
    along.build(field, all_elements(field), ray.origin, ray.direction, span);
    const reference::ReferenceField exact(scene);
    const Ray same{ray.origin, ray.direction};
    const double size = along.threshold() + along.magnitude();
    const double speed = std::hypot(ray.direction.x, ray.direction.y, ray.direction.z);
    const Interval<double> slope_left_out =
        slope_of_what_is_left_out(field, along.threshold(), speed);
    Random random(seed);
    for (int window = 0; window < 6; ++window) {
        const double length = (span.hi - span.lo) * std::exp2(-random.uniform(0, 30));
        const double t0 = random.uniform(span.lo, span.hi - length);
        const double t1 = std::min(t0 + length, span.hi);
        if (!(t0 < t1)) continue;
        ++seen.windows;
        const Enclosure e = along.over(t0, t1);
        const Exact left = exact_at(exact, same, along.exponent(), t0),
                    right = exact_at(exact, same, along.exponent(), t1);
        expect_meets(e.left, left.f_lo, left.f_hi, "left", t0);
        expect_meets(e.right, right.f_lo, right.f_hi, "right", t1);
        expect_meets(e.left_slope + slope_left_out, left.df_lo, left.df_hi, "left slope", t0);
        expect_meets(along.at(t0), left.f_lo, left.f_hi, "at", t0);
        const bool has_joined = std::any_of(field.shape.begin(), field.shape.end(), is_joined);
        double before = t0;
        Exact at_before = left;
        Interval<double> f = hull(Interval<double>(left.f_lo), Interval<double>(right.f_lo));
        Interval<double> df = hull(Interval<double>(left.df_lo), Interval<double>(right.df_lo));
        for (int i = 0; i < 4; ++i) {
            const double t = random.uniform(before, t1);
            const Exact at = exact_at(exact, same, along.exponent(), t);
            expect_meets(e.value, at.f_lo, at.f_hi, "f", t);
            expect_meets(e.slope + slope_left_out, at.df_lo, at.df_hi, "f'", t);
            f = hull(f, Interval<double>(at.f_lo));
            df = hull(df, Interval<double>(at.df_lo));
            const Interval<double> x = Interval<double>(t) - Interval<double>(t0);
            expect_meets(e.left + e.left_slope * x + Interval<double>(0.5) * e.curvature * sqr(x),
                         at.f_lo, at.f_hi, "f by the left end", t);
            // By the mean value theorem f' gains between inf f'' and sup f'' times the time; an
            // upward jump has to show as +inf, a downward one as -inf, unless it is from one part of
            // an element to another.
            if (t > before && !has_joined) {
                const Interval<double> gain =
                    e.curvature * (Interval<double>(t) - Interval<double>(before));
                const double slack =
                    1e-13 * (std::abs(at.df_lo) + std::abs(at_before.df_lo)) + 1e-13;
                expect_meets(gain + Interval<double>(-slack, slack), at.df_lo - at_before.df_hi,
                             at.df_hi - at_before.df_lo, "f''", t);
            }
            before = t;
            at_before = at;
        }
        // What rounding leaves of f and f', far from the origin 2^-52 of the distance.
        const double rounding = 1e-11 * size, slope_rounding = rounding / field.least_width;
        seen.narrow_at += width(e.left) <= rounding && width(along.at(t1)) <= rounding;
        if (length * speed > 0.05 * field.least_width) continue;
        ++seen.short_windows;
        seen.narrow_value += width(e.value) <= wider * width(f) + rounding;
        seen.narrow_slope += width(e.slope) <= wider * width(df) + slope_rounding;
        seen.bounded_curvature +=
            width(e.curvature) <
            100 * size / (field.least_width * field.least_width) * speed * speed;
    }
}

class Inclusion : public testing::TestWithParam<tools::ElementKind> {};
INSTANTIATE_TEST_SUITE_P(Each, Inclusion, testing::ValuesIn(tools::every_kind),
                         tools::name_of_kind);

TEST_P(Inclusion, EnclosuresHoldTheExactFieldOnNastyRaysAndAreNarrow) {
    const std::uint64_t first = tools::announced_seed(7);
    Seen seen;
    for (std::uint64_t seed = first; seed < first + 3; ++seed) {
        const Scene scene =
            tools::random_scene({.elements = 1 + 2 * (seed % 3), .only = GetParam()}, seed);
        for (std::size_t kind = 0; kind < tools::ray_kind_words.size(); ++kind) {
            SCOPED_TRACE("seed " + std::to_string(seed) + ", " +
                         std::string(tools::ray_kind_words[kind]));
            for (const Ray& ray : nasty_rays(scene, static_cast<RayKind>(kind), 12, seed)) {
                check_ray(scene, ray, seed, seen);
            }
        }
    }
    std::printf("%d rays, %d skipped, %d windows, %d narrow at t; %d short: %d f, %d f', %d f''\n",
                seen.rays, seen.skipped, seen.windows, seen.narrow_at, seen.short_windows,
                seen.narrow_value, seen.narrow_slope, seen.bounded_curvature);
    EXPECT_GT(seen.rays - seen.skipped, seen.rays / 3);
    EXPECT_GT(seen.short_windows, 400);
    EXPECT_GE(seen.narrow_at, 0.99 * seen.windows);
    // What is seen of a short window is less than the whole where f or f' turns in it.
    EXPECT_GE(seen.narrow_value, 0.9 * seen.short_windows);
    // Curves may be bent more than the ray is far from them.
    const bool is_bent = GetParam().shape == Shape::curve;
    EXPECT_GE(seen.narrow_slope, (is_bent ? 0.5 : 0.6) * seen.short_windows);
    // the others hold kinks
    EXPECT_GE(seen.bounded_curvature, (is_bent ? 0.4 : 0.8) * seen.short_windows);
}

}  // namespace
}  // namespace ivory
