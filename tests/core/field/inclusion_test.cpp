// Enclosures of f, f' and f'' along rays hold what the reference of 256 bits finds inside of them.
#include "core/field/inclusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "core/trace/clip.h"
#include "tests/reference/reference.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/random_scene.h"

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

void check_ray(const Scene& scene, const Ray& original, std::uint64_t seed) {
    const Field field = compile(scene);
    const ScaledRay ray = scaled(original);
    const Interval<double> span = clip(ray, field.box);
    if (is_empty(span) || !(span.hi < 1e100)) return;
    FieldAlongRay along;
    along.build(field, all_elements(field), ray.origin, ray.direction, span);
    const reference::ReferenceField exact(scene);
    const Ray same{ray.origin, ray.direction};
    Random random(seed);
    for (int window = 0; window < 6; ++window) {
        const double length = (span.hi - span.lo) * std::exp2(-random.uniform(0, 30));
        const double t0 = random.uniform(span.lo, span.hi - length);
        const double t1 = std::min(t0 + length, span.hi);
        if (!(t0 < t1)) continue;
        const Enclosure e = along.over(t0, t1);
        const Exact left = exact_at(exact, same, along.exponent(), t0),
                    right = exact_at(exact, same, along.exponent(), t1);
        expect_meets(e.left, left.f_lo, left.f_hi, "left", t0);
        expect_meets(e.right, right.f_lo, right.f_hi, "right", t1);
        expect_meets(e.left_slope, left.df_lo, left.df_hi, "left slope", t0);
        expect_meets(along.at(t0), left.f_lo, left.f_hi, "at", t0);
        double before = t0;
        Exact at_before = left;
        for (int i = 0; i < 4; ++i) {
            const double t = random.uniform(before, t1);
            const Exact at = exact_at(exact, same, along.exponent(), t);
            expect_meets(e.value, at.f_lo, at.f_hi, "f", t);
            expect_meets(e.slope, at.df_lo, at.df_hi, "f'", t);
            // By the mean value theorem f' gains between inf f'' and sup f'' times the time; an
            // upward jump has to show as +inf, a downward one as -inf.
            if (t > before) {
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
    }
}

TEST(Inclusion, EnclosuresHoldTheExactFieldOnNastyRays) {
    const char* from = std::getenv("IVORY_TEST_SEED");
    const std::uint64_t first = from ? std::strtoull(from, nullptr, 10) : 7;
    for (std::uint64_t seed = first; seed < first + 6; ++seed) {
        tools::SceneRecipe recipe;
        recipe.elements = 1 + seed % 5;
        const Scene scene = random_scene(recipe, seed);
        for (std::size_t kind = 0; kind < tools::ray_kind_words.size(); ++kind) {
            SCOPED_TRACE("seed " + std::to_string(seed) + ", " +
                         std::string(tools::ray_kind_words[kind]));
            for (const Ray& ray : nasty_rays(scene, static_cast<RayKind>(kind), 20, seed)) {
                check_ray(scene, ray, seed);
            }
        }
    }
}

}  // namespace
}  // namespace ivory
