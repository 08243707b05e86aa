#include "tests/reference/reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tests/reference/outward_double.h"
#include "tests/reference/verdict.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/random_scene.h"

namespace ivory::reference {
namespace {

ivory::Element element(const ivory::Skeleton& skeleton, KernelKind kernel = KernelKind::blinn,
                       double strength = 1, double width = 1) {
    ivory::Element result;
    result.skeleton = skeleton;
    result.kernel = kernel;
    result.strength = strength;
    result.width = width;
    return result;
}

Scene scene_of(double threshold, std::vector<ivory::Element> elements) {
    Scene scene;
    scene.threshold = threshold;
    scene.elements = std::move(elements);
    return scene;
}

const PointSkeleton origin_point{{0, 0, 0}};
const SegmentSkeleton bar{{-1, 0, 0}, {1, 0, 0}};
const CircleSkeleton ring{{0, 0, 0}, {0, 0, 3}, 2};

// The root is within 1e-40 of the given number (itself computed in 256 bits).
void expect_root(const ReferenceAnswer& answer, const RealInterval& expected) {
    ASSERT_EQ(answer.outcome, Outcome::hit);
    const RealInterval off = answer.t - expected;
    EXPECT_LE(off.lo, Real(0.0)) << to_string(answer.t.lo);
    EXPECT_GE(off.hi, Real(0.0)) << to_string(answer.t.hi);
    EXPECT_LT(off.width(), Real(1e-40)) << to_string(off.width());
}

// sqrt(-ln T)
RealInterval blinn_radius(double threshold) {
    const Real t(threshold);
    return sqrt(-RealInterval(rounded(mpfr_log, MPFR_RNDD, t), rounded(mpfr_log, MPFR_RNDU, t)));
}

TEST(Multiprecision, RoundsOutward) {
    const RealInterval third = RealInterval(1) / RealInterval(3);
    EXPECT_LT(third.lo, third.hi);
    const RealInterval one = third * RealInterval(3);
    EXPECT_LE(one.lo, Real(1.0));
    EXPECT_GE(one.hi, Real(1.0));
    EXPECT_LT(one.width(), Real(0x1p-250));
}

TEST(Multiprecision, ProductsOfEverySignEncloseAllProducts) {
    const double ends[] = {-3, -0.5, 0, 0.25, 2};
    for (const double a : ends) {
        for (const double b : ends) {
            for (const double c : ends) {
                for (const double d : ends) {
                    if (a > b || c > d) continue;
                    const RealInterval x{Real(a), Real(b)}, y{Real(c), Real(d)};
                    const RealInterval product = x * y;
                    EXPECT_EQ(product.lo.to_double(), std::min({a * c, a * d, b * c, b * d}));
                    EXPECT_EQ(product.hi.to_double(), std::max({a * c, a * d, b * c, b * d}));
                    const RealInterval square = sqr(x);
                    EXPECT_EQ(square.hi.to_double(), std::max(a * a, b * b));
                    EXPECT_EQ(square.lo.to_double(), a <= 0 && b >= 0 ? 0 : std::min(a * a, b * b));
                }
            }
        }
    }
}

TEST(Multiprecision, DivisionByAnIntervalAroundZeroIsAllNumbers) {
    const RealInterval all = RealInterval(1) / RealInterval(Real(-1.0), Real(1.0));
    EXPECT_TRUE(std::isinf(all.lo.to_double()) && std::isinf(all.hi.to_double()));
}

// Doubles with margins against 256 bits, by every operation.
TEST(OutwardDouble, EnclosesTheExactResult) {
    tools::Random random(11);
    for (int i = 0; i < 20000; ++i) {
        const double a = random.sign() * std::pow(10, random.uniform(-160, 160));
        const double b = random.sign() * std::pow(10, random.uniform(-160, 160));
        const double c = random.uniform(-740, 700);
        const auto encloses = [](const OutwardDouble& outer, const RealInterval& inner) {
            return Real(outer.lo) <= inner.lo && inner.hi <= Real(outer.hi);
        };
        const OutwardDouble x(a), y(b);
        const RealInterval u(a), v(b);
        ASSERT_TRUE(encloses(x + y, u + v)) << a << ' ' << b;
        ASSERT_TRUE(encloses(x - y, u - v)) << a << ' ' << b;
        ASSERT_TRUE(encloses(x * y, u * v)) << a << ' ' << b;
        ASSERT_TRUE(encloses(x / y, u / v)) << a << ' ' << b;
        ASSERT_TRUE(encloses(sqr(x), sqr(u))) << a;
        ASSERT_TRUE(encloses(sqrt(OutwardDouble(std::fabs(a))), sqrt(RealInterval(std::fabs(a)))));
        ASSERT_TRUE(encloses(exp(OutwardDouble(c)), exp(RealInterval(c)))) << c;
    }
}

// The kernels as the scene format writes them, at q = i / 64.
TEST(ReferenceKernel, IsTheFormulaOfTheFormat) {
    for (int i = 0; i <= 80; ++i) {
        const RealInterval q = RealInterval(i) / RealInterval(64), s = sqr(q);
        const auto near = [&](Kernel kind, const RealInterval& expected) {
            const RealInterval off = kernel_germ(kind, s).value - expected;
            EXPECT_TRUE(off.lo <= Real(0.0) && off.hi >= Real(0.0)) << i;
            EXPECT_LT(off.width(), Real(0x1p-240)) << i;
        };
        const RealInterval zero(0), one(1), nine(9);
        near(Kernel::blinn, exp(-s));
        near(Kernel::nishimura, 3 * i <= 64 ? one - RealInterval(3) * s
                                : i <= 64   ? RealInterval(1.5) * sqr(one - q)
                                            : zero);
        near(Kernel::wyvill, i <= 64
                                 ? one - RealInterval(4) / nine * s * s * s +
                                       RealInterval(17) / nine * s * s - RealInterval(22) / nine * s
                                 : zero);
        near(Kernel::murakami, i <= 64 ? sqr(one - s) : zero);
        near(Kernel::blobtree,
             i <= 64 ? one - RealInterval(3) * s + RealInterval(3) * s * s - s * s * s : zero);
    }
}

// k' between two points is a difference quotient, and rises.
TEST(ReferenceKernel, HasTheSlopeOfItsFormula) {
    for (const Kernel kind :
         {Kernel::blinn, Kernel::nishimura, Kernel::wyvill, Kernel::murakami, Kernel::blobtree}) {
        for (int i = 0; i <= 140; ++i) {
            const RealInterval s = RealInterval(i) / RealInterval(128);
            const RealInterval next = s + RealInterval(0x1p-40);
            const Germ<RealInterval> here = kernel_germ(kind, s), there = kernel_germ(kind, next);
            const RealInterval quotient = (there.value - here.value) / RealInterval(0x1p-40);
            const Germ<RealInterval> all = kernel_germ(kind, from_to(s, next));
            EXPECT_TRUE(all.slope.lo <= quotient.hi && quotient.lo <= all.slope.hi) << i;
            EXPECT_TRUE(all.value.lo <= there.value.lo && here.value.hi <= all.value.hi) << i;
            EXPECT_TRUE(here.slope.lo <= quotient.hi && quotient.lo <= there.slope.hi) << i;
            EXPECT_LT(all.slope.width(), Real(i == 0 || i == 128 ? 3 : 1e-9)) << i;
        }
    }
}

TEST(FirstRoot, OfABlinnPointIsASphere) {
    for (const double threshold : {0.9, 0.55, 0.1, 1e-9}) {
        const ReferenceField field(scene_of(threshold, {element(origin_point)}));
        const RealInterval radius = blinn_radius(threshold);
        expect_root(first_root(field, {{-20, 0, 0}, {1, 0, 0}}), RealInterval(20) - radius);
        expect_root(first_root(field, {{-20, 0, 0}, {4, 0, 0}}),
                    (RealInterval(20) - radius) / RealInterval(4));
        expect_root(first_root(field, {{0, 0, 0}, {0, -1, 0}}), radius);  // from inside
        EXPECT_EQ(first_root(field, {{-20, 0, 0}, {-1, 0, 0}}).outcome, Outcome::miss);
        EXPECT_EQ(first_root(field, {{-20, 5, 0}, {1, 0, 0}}).outcome, Outcome::miss);
    }
}

TEST(FirstRoot, DoesNotMindTheLengthOfTheDirection) {
    const ReferenceField field(scene_of(0.5, {element(origin_point)}));
    for (const double length : {1e-300, 1e-150, 1e-6, 1e6, 1e150, 1e300}) {
        const RealInterval t = (RealInterval(20) - blinn_radius(0.5)) / RealInterval(length);
        const ReferenceAnswer answer = first_root(field, {{0, 0, -20}, {0, 0, length}});
        ASSERT_EQ(answer.outcome, Outcome::hit) << length;
        const RealInterval ratio = answer.t / t;
        EXPECT_TRUE(ratio.lo <= Real(1.0) && ratio.hi >= Real(1.0)) << length;
        EXPECT_LT(ratio.width(), Real(1e-40)) << length;
    }
}

// F = 1 - 3 q^2 = T for q <= 1/3; 3/2 (1 - q)^2 = T beyond.
TEST(FirstRoot, OfANishimuraPointIsASphere) {
    for (const double threshold : {0.8, 0.25}) {
        const ReferenceField field(
            scene_of(threshold, {element(origin_point, KernelKind::nishimura, 1, 2)}));
        const RealInterval t(threshold), one(1);
        const RealInterval q = threshold > 2.0 / 3 ? sqrt((one - t) / RealInterval(3))
                                                   : one - sqrt(t / RealInterval(1.5));
        expect_root(first_root(field, {{0, -7, 0}, {0, 1, 0}}),
                    RealInterval(7) - RealInterval(2) * q);
    }
}

// F(1/2) = 1/2: the wyvill kernel is made so.
TEST(FirstRoot, OfAWyvillPointAtHalfIsAtHalfTheWidth) {
    const ReferenceField field(scene_of(0.5, {element(origin_point, KernelKind::wyvill, 1, 3)}));
    expect_root(first_root(field, {{0, 0.25, -10}, {0, 0, 1}}),
                RealInterval(10) - sqrt(RealInterval(1.5 * 1.5 - 0.25 * 0.25)));
}

TEST(FirstRoot, OfASegmentIsACapsule) {
    const ReferenceField field(scene_of(0.5, {element(bar)}));
    const RealInterval radius = blinn_radius(0.5);
    expect_root(first_root(field, {{0.3, 0, -9}, {0, 0, 1}}), RealInterval(9) - radius);
    expect_root(first_root(field, {{-9, 0, 0}, {1, 0, 0}}), RealInterval(8) - radius);  // along it
    expect_root(first_root(field, {{1.25, 0, -9}, {0, 0, 1}}),
                RealInterval(9) - sqrt(sqr(radius) - RealInterval(0.0625)));
    expect_root(first_root(field, {{1, 0, -9}, {0, 0, 1}}), RealInterval(9) - radius);  // at an end
    EXPECT_EQ(first_root(field, {{-9, 1, 0}, {1, 0, 0}}).outcome, Outcome::miss);
}

TEST(FirstRoot, OfASegmentOfNoLengthIsThatOfThePoint) {
    const ReferenceField field(scene_of(0.5, {element(SegmentSkeleton{{1, 2, 3}, {1, 2, 3}})}));
    expect_root(first_root(field, {{1, 2, -9}, {0, 0, 1}}), RealInterval(12) - blinn_radius(0.5));
}

TEST(FirstRoot, OfACircleIsATorus) {
    const ReferenceField field(scene_of(0.5, {element(ring)}));
    const RealInterval tube = blinn_radius(0.5);
    expect_root(first_root(field, {{9, 0, 0}, {-1, 0, 0}}), RealInterval(7) - tube);
    expect_root(first_root(field, {{0, 2, 9}, {0, 0, -1}}), RealInterval(9) - tube);
    expect_root(first_root(field, {{0, 0, 0}, {0, 1, 0}}), RealInterval(2) - tube);  // centre, kink
    // Along the axis, through the hole.
    EXPECT_EQ(first_root(field, {{0, 0, 9}, {0, 0, -1}}).outcome, Outcome::miss);
    // Along the axis where the tube closes the hole: z^2 + r^2 = tube^2.
    const ReferenceField closed(
        scene_of(0.5, {element(CircleSkeleton{{0, 0, 0}, {0, 0, 3}, 0.5})}));
    expect_root(first_root(closed, {{0, 0, 9}, {0, 0, -1}}),
                RealInterval(9) - sqrt(sqr(tube) - RealInterval(0.25)));
}

TEST(FirstRoot, CountsARootAtTheOrigin) {
    // q = 1/4: F = 1 - 3/16 = 13/16, exactly in binary.
    const ReferenceField field(
        scene_of(0.8125, {element(origin_point, KernelKind::nishimura, 1, 4)}));
    const ReferenceAnswer answer = first_root(field, {{1, 0, 0}, {1, 0, 0}});
    ASSERT_EQ(answer.outcome, Outcome::hit);
    EXPECT_TRUE(answer.t.hi.is_zero());
}

TEST(FirstRoot, TellsATangentOffByOneUnitInTheLastPlace) {
    // The line at height h over a nishimura point of width 4: max f = 1 - 3 h^2 / 16 - T.
    const double height = 1, threshold = 0.8125;
    const Ray ray{{-9, height, 0}, {1, 0, 0}};
    const std::vector<ivory::Element> point{element(origin_point, KernelKind::nishimura, 1, 4)};
    const ReferenceField below(scene_of(std::nextafter(threshold, 0), point));
    const ReferenceField above(scene_of(std::nextafter(threshold, 1), point));
    EXPECT_EQ(first_root(below, ray).outcome, Outcome::hit);
    EXPECT_EQ(first_root(above, ray).outcome, Outcome::miss);
    EXPECT_NE(first_root(ReferenceField(scene_of(threshold, point)), ray).outcome, Outcome::miss);
}

TEST(FirstRoot, LeavesOutInvisibleElements) {
    ivory::Element hidden = element(origin_point);
    hidden.visible = false;
    const ReferenceField field(scene_of(0.5, {hidden}));
    EXPECT_EQ(first_root(field, {{-9, 0, 0}, {1, 0, 0}}).outcome, Outcome::miss);
}

// Brute force: signs of f at many points of the ray, in 256 bits.
TEST(FirstRoot, AgreesWithSampling) {
    int hits = 0, misses = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        tools::SceneRecipe recipe;
        recipe.elements = 5;
        recipe.scale = seed % 4 == 1 ? 1e-6 : 1;
        recipe.shift = seed % 4 == 2 ? 1e6 : 0;
        recipe.critical = seed % 4 == 3;
        const Scene scene = tools::random_scene(recipe, seed);
        const ReferenceField field(scene);
        for (const ivory::Ray& ray : tools::nasty_rays(scene, tools::RayKind::random, 5, seed)) {
            const ReferenceAnswer answer = first_root(field, ray);
            ASSERT_NE(answer.outcome, Outcome::unknown) << "seed " << seed;
            answer.outcome == Outcome::hit ? ++hits : ++misses;
            const bool starts_inside =
                certainly_positive(field.along(ray, RealInterval(0.0)).value);
            const double length = std::hypot(ray.direction.x, ray.direction.y, ray.direction.z);
            const double end = answer.outcome == Outcome::hit ? answer.t.lo.to_double()
                                                              : 60 * recipe.scale / length;
            for (int i = 0; i < 40; ++i) {  // before the root no sign changes
                const RealInterval f = field.along(ray, RealInterval(end * i / 40)).value;
                EXPECT_TRUE(starts_inside ? certainly_positive(f) : certainly_negative(f))
                    << "seed " << seed << " at " << end * i / 40;
            }
            if (answer.outcome != Outcome::hit) continue;
            // At the root, f encloses 0 tightly; at once beyond, it has the other sign.
            const Germ<RealInterval> f = field.along(ray, answer.t);
            EXPECT_TRUE(f.value.lo <= Real(0.0) && f.value.hi >= Real(0.0));
            EXPECT_LT(f.value.width(), Real(1e-30));
            EXPECT_EQ(certainly_negative(f.slope), starts_inside) << "seed " << seed;
        }
    }
    EXPECT_GT(hits, 10);
    EXPECT_GT(misses, 10);
}

// The search leaves out elements that add next to nothing; the field with all of them agrees.
TEST(FirstRoot, IsARootOfTheWholeFieldOfManyElements) {
    tools::SceneRecipe recipe;
    recipe.elements = 200;
    const Scene scene = tools::random_scene(recipe, 5);
    const ReferenceField field(scene);
    int hits = 0;
    for (const ivory::Ray& ray : tools::nasty_rays(scene, tools::RayKind::random, 16, 5)) {
        const ReferenceAnswer answer = first_root(field, ray);
        if (answer.outcome != Outcome::hit) continue;
        ++hits;
        const Germ<RealInterval> f = field.along(ray, answer.t);
        EXPECT_TRUE(f.value.lo <= Real(1e-50) && f.value.hi >= Real(-1e-50));
        EXPECT_LT(f.value.width(), Real(1e-30));
    }
    EXPECT_GT(hits, 3);
}

// Along the ray and in space are two ways to the same field.
TEST(ReferenceField, AlongTheRayAndInSpaceAgree) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        tools::SceneRecipe recipe;
        recipe.elements = 6;
        const Scene scene = tools::random_scene(recipe, seed);
        const ReferenceField field(scene);
        for (const ivory::Ray& ray : tools::nasty_rays(scene, tools::RayKind::random, 20, seed)) {
            const Real t(3.0 / std::hypot(ray.direction.x, ray.direction.y, ray.direction.z));
            const PointValue point = field.at(ray, t);
            const Germ<RealInterval> germ = field.along(ray, RealInterval(t));
            const RealInterval off = point.f - germ.value;
            EXPECT_TRUE(off.lo <= Real(0.0) && off.hi >= Real(0.0) && off.width() < Real(1e-35));
            const RealInterval slope =
                inner(point.gradient, triple<RealInterval>(ray.direction)) - germ.slope;
            EXPECT_TRUE(slope.lo <= Real(0.0) && slope.hi >= Real(0.0) &&
                        slope.width() < Real(1e-35));
        }
    }
}

// An enclosure over an interval holds the values and slopes at points of it; difference quotients
// lie in the slope.
TEST(ReferenceField, IntervalsEncloseTheirPoints) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        tools::SceneRecipe recipe;
        recipe.elements = 4;
        const Scene scene = tools::random_scene(recipe, seed);
        const ReferenceField field(scene);
        for (const tools::RayKind kind : {tools::RayKind::random, tools::RayKind::axis}) {
            for (const ivory::Ray& ray : tools::nasty_rays(scene, kind, 12, seed)) {
                const double unit =
                    1 / std::hypot(ray.direction.x, ray.direction.y, ray.direction.z);
                tools::Random random(seed);
                const double lo = random.uniform(0, 12) * unit;
                const double hi = lo + random.uniform(0, 2) * unit;
                const Germ<RealInterval> all = field.along(ray, {Real(lo), Real(hi)});
                Germ<RealInterval> last;
                for (int i = 0; i <= 16; ++i) {
                    const double t = lo + (hi - lo) * i / 16;
                    const Germ<RealInterval> one = field.along(ray, RealInterval(t));
                    EXPECT_LE(all.value.lo, one.value.hi);
                    EXPECT_GE(all.value.hi, one.value.lo);
                    if (i > 0 && hi > lo) {
                        const RealInterval quotient =
                            (one.value - last.value) /
                            (RealInterval(t) - RealInterval(lo + (hi - lo) * (i - 1) / 16));
                        EXPECT_LE(all.slope.lo, quotient.hi) << "seed " << seed;
                        EXPECT_GE(all.slope.hi, quotient.lo) << "seed " << seed;
                    }
                    last = one;
                }
            }
        }
    }
}

Answer answer_of(Status status, double lo, double hi) {
    Answer answer;
    answer.isolation.status = status;
    answer.isolation.t = Interval<double>{lo, hi};
    answer.surface.normal = {-1, 0, 0};
    answer.surface.color = {0.8, 0.8, 0.8};
    return answer;
}

TEST(Check, FindsEachFault) {
    const ReferenceField field(scene_of(0.5, {element(origin_point)}));
    const Ray ray{{-20, 0, 0}, {1, 0, 0}}, beside{{-20, 3, 0}, {1, 0, 0}};
    const double root = 20 - std::sqrt(std::log(2));
    const auto fault = [&](const Ray& along, Status status, double lo, double hi) {
        return check(field, along, 1e-9, answer_of(status, lo, hi)).fault;
    };
    EXPECT_EQ(fault(ray, Status::hit, root - 1e-12, root + 1e-12), Fault::none);
    EXPECT_EQ(fault(ray, Status::hit, root + 1e-12, root + 1e-10), Fault::wrong_hit);
    EXPECT_EQ(fault(ray, Status::hit, root - 1e-10, root - 1e-12), Fault::wrong_hit);
    EXPECT_EQ(fault(ray, Status::hit, root - 1e-6, root + 1e-6), Fault::too_wide);
    EXPECT_EQ(fault(ray, Status::hit, root + 1e-12, root - 1e-12), Fault::malformed);
    // The second root.
    const double exit = 20 + std::sqrt(std::log(2));
    EXPECT_EQ(fault(ray, Status::hit, exit - 1e-12, exit + 1e-12), Fault::wrong_hit);
    EXPECT_EQ(fault(ray, Status::miss, 0, 0), Fault::wrong_miss);
    EXPECT_EQ(fault(ray, Status::unresolved, 1, 30), Fault::none);
    EXPECT_EQ(fault(ray, Status::unresolved, 20, 30), Fault::wrong_bracket);
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(fault(ray, Status::unresolved, 1, infinity), Fault::none);
    EXPECT_EQ(fault(ray, Status::unresolved, 20, infinity), Fault::wrong_bracket);
    EXPECT_EQ(fault(ray, Status::unresolved, infinity, infinity), Fault::malformed);
    EXPECT_EQ(fault(ray, Status::hit, 1, infinity), Fault::malformed);
    EXPECT_EQ(fault(ray, Status::claimed_hit, 1, infinity), Fault::malformed);
    EXPECT_EQ(fault(beside, Status::unresolved, 1, infinity), Fault::none);
    EXPECT_EQ(fault(beside, Status::miss, 0, 0), Fault::none);
    EXPECT_EQ(fault(beside, Status::hit, root - 1e-12, root + 1e-12), Fault::wrong_hit);
    EXPECT_EQ(fault(beside, Status::unresolved, 1, 30), Fault::none);
    EXPECT_EQ(fault(beside, Status::claimed_hit, 1, 2), Fault::false_claim);
    EXPECT_EQ(fault(ray, Status::claimed_miss, 0, 0), Fault::false_claim);
}

TEST(Check, JudgesNormalAndColor) {
    const ReferenceField field(scene_of(0.5, {element(origin_point)}));
    const Ray ray{{-20, 0, 0}, {1, 0, 0}};
    const double root = 20 - std::sqrt(std::log(2));
    Answer answer = answer_of(Status::hit, root - 1e-12, root + 1e-12);
    const Verdict right = check(field, ray, 1e-9, answer);
    EXPECT_LT(right.normal_error, 1e-15);
    EXPECT_LT(right.color_error, 1e-15);
    EXPECT_LT(right.root_error, 1e-13);
    answer.surface.normal.y = 1e-6;
    answer.surface.color.z += 1e-5;
    const Verdict off = check(field, ray, 1e-9, answer);
    EXPECT_NEAR(off.normal_error, 1e-6, 1e-9);
    EXPECT_NEAR(off.color_error, 1e-5, 1e-9);
}

TEST(Check, KnowsWhichRaysAreDecidable) {
    const ReferenceField field(scene_of(0.5, {element(origin_point)}));
    const auto is_decidable = [&](double height) {
        const Ray ray{{-4, height, 0}, {1, 0, 0}};
        return decidable(field, ray, 1e-9, first_root(field, ray));
    };
    const double radius = std::sqrt(std::log(2));
    EXPECT_TRUE(is_decidable(0.1));
    EXPECT_TRUE(is_decidable(radius * (1 + 1e-6)));
    EXPECT_FALSE(is_decidable(radius * (1 + 1e-12)));
    EXPECT_FALSE(is_decidable(radius * (1 - 1e-12)));
}

// Whatever a scene's scale: no ray that a file of rays may not hold.
TEST(NastyRays, AreRaysAtExtremeScales) {
    for (const double scale : {1e-150, 1e-90, 1e90, 1e150}) {
        tools::SceneRecipe recipe;
        recipe.scale = scale;
        const Scene scene = tools::random_scene(recipe, 5);
        std::size_t count = 0;
        for (std::size_t kind = 0; kind < tools::ray_kind_words.size(); ++kind) {
            for (const ivory::Ray& ray :
                 tools::nasty_rays(scene, static_cast<tools::RayKind>(kind), 20, 9)) {
                ++count;
                double sum = 0;
                for (std::size_t k = 0; k < 3; ++k) sum += ray.origin[k] * 0 + ray.direction[k] * 0;
                EXPECT_EQ(sum, 0) << tools::ray_kind_words[kind] << " at " << scale;
                EXPECT_NE(ray.direction, (Vec3d{0, 0, 0}))
                    << tools::ray_kind_words[kind] << " at " << scale;
            }
        }
        EXPECT_GE(count, 60u) << "at " << scale;
    }
}

// Every kind of nasty ray gets an outcome on every kind of scene but the touching ones.
TEST(FirstRoot, IsKnownForNastyRays) {
    int unknown = 0, all = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        tools::SceneRecipe recipe;
        recipe.elements = 6;
        recipe.scale = seed == 4 ? 1e-6 : seed == 5 ? 1e6 : 1;
        recipe.shift = seed == 2 ? 1e6 : 0;
        recipe.critical = seed == 3;
        const Scene scene = tools::random_scene(recipe, seed);
        const ReferenceField field(scene);
        for (std::size_t kind = 0; kind < tools::ray_kind_words.size(); ++kind) {
            for (const ivory::Ray& ray :
                 nasty_rays(scene, static_cast<tools::RayKind>(kind), 24, seed)) {
                ++all;
                unknown += first_root(field, ray).outcome == Outcome::unknown;
            }
        }
    }
    EXPECT_GT(all, 800);
    EXPECT_EQ(unknown, 0);
}

}  // namespace
}  // namespace ivory::reference
