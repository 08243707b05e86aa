// The methods to compare: what each calls a theorem is one, and what it claims is near to the proved
// answer wherever the ray crosses the surface.
#include "core/trace/methods/method.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>

#include "core/field/surface.h"
#include "core/interval/quick.h"
#include "core/render/camera.h"
#include "core/render/framing.h"
#include "core/scene/scene_json.h"
#include "core/trace/methods/affine_form.h"
#include "core/trace/methods/lipschitz.h"
#include "core/trace/methods/natural_numbers.h"
#include "core/trace/trace.h"
#include "tests/reference/verdict.h"
#include "tests/tools/kinds.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using reference::Fault;
using tools::RayKind;

Answer answer(const Method& method, const Field& field, const Ray& ray, double tolerance) {
    Counts counts;
    return trace(field, all_elements(field), ray, method, {.tolerance = tolerance}, counts);
}

std::vector<Scene> asset_scenes() {
    std::vector<std::string> paths;
    const std::filesystem::path folder = std::string(IVORY_SOURCE_DIR) + "/assets/scenes";
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        paths.push_back(entry.path().string());
    }
    std::sort(paths.begin(), paths.end());
    std::vector<Scene> scenes;
    // Many parts and tapers take these methods too long.
    constexpr std::ptrdiff_t most_parts = 20;
    for (const std::string& path : paths) {
        Scene scene = read_scene(path);
        const Field field = compile(scene);
        const auto parts = std::count_if(field.shape.begin(), field.shape.end(), [](Shape shape) {
            return is_joined(shape) || is_taper(shape);
        });
        if (parts <= most_parts) scenes.push_back(std::move(scene));
    }
    return scenes;
}

class Methods : public testing::TestWithParam<const char*> {
  protected:
    const Method& method() const { return *find_method(GetParam()); }
};

// Ordinary and nasty rays, every shape, kernel and sign of strength, from inside and outside.
TEST_P(Methods, NoTheoremIsWrongAndFewClaimsAre) {
    const std::uint64_t first = tools::announced_seed(4);
    int rays = 0, resolved = 0, decided = 0, false_claims = 0;
    for (std::uint64_t seed = first; seed < first + 3; ++seed) {
        const Scene scene = tools::random_scene({.elements = 4}, seed);
        const Field field = compile(scene);
        const reference::ReferenceField exact(scene);
        for (std::size_t kind = 0; kind < tools::ray_kind_words.size(); ++kind) {
            SCOPED_TRACE("seed " + std::to_string(seed) + ", " +
                         std::string(tools::ray_kind_words[kind]));
            for (const Ray& ray : nasty_rays(scene, static_cast<RayKind>(kind), 8, seed + kind)) {
                constexpr double tolerance = 1e-4;
                const Answer given = answer(method(), field, ray, tolerance);
                const reference::Verdict verdict = check(exact, ray, tolerance, given);
                ++rays;
                resolved += given.isolation.status != Status::unresolved;
                // Tangents and starts on the surface are beyond claims.
                const bool ordinary = kind == std::size_t(RayKind::random) ||
                                      kind == std::size_t(RayKind::inside) ||
                                      kind == std::size_t(RayKind::parallel);
                decided += ordinary;
                if (verdict.fault == Fault::false_claim) {
                    false_claims += ordinary;
                } else {
                    EXPECT_EQ(verdict.fault, Fault::none) << word(verdict.fault);
                }
            }
        }
    }
    EXPECT_GT(resolved, 0.8 * rays);
    // Lines say little of what has no formula (tapers, polygons, curves).
    const bool of_lines = std::string_view(GetParam()) == "affine";
    EXPECT_LE(false_claims, (of_lines ? 0.2 : 0.06) * decided);
    std::printf("%d rays, %d resolved; %d of %d claims of ordinary rays false\n", rays, resolved,
                false_claims, decided);
}

// On every scene of the gallery.
TEST_P(Methods, AgreesWithTheProvedAnswers) {
    constexpr int width = 48, height = 27;
    constexpr double tolerance = 1e-5;
    int pixels = 0, wrong = 0, crossings = 0, far = 0;
    for (const Scene& scene : asset_scenes()) {
        const Field field = compile(scene);
        const View view = make_view(camera_of(scene, field, width, height));
        for (int j = 1; j < height; j += 3) {
            for (int i = 1; i < width; i += 3) {
                const Ray ray = primary_ray(view, width, height, i, j);
                const Answer exact = answer(*find_method("proved"), field, ray, 1e-12);
                const Answer given = answer(method(), field, ray, tolerance);
                const Status status = given.isolation.status;
                if (exact.isolation.status == Status::unresolved) continue;
                const bool is_hit = exact.isolation.status == Status::hit;
                // Theorems agree without exception.
                EXPECT_FALSE(status == Status::miss && is_hit);
                if (status == Status::hit) {
                    ASSERT_TRUE(is_hit);
                    EXPECT_FALSE(is_empty(intersection(given.isolation.t, exact.isolation.t)));
                }
                ++pixels;
                const bool says_hit = status != Status::miss && status != Status::claimed_miss;
                wrong += says_hit != is_hit;
                if (!says_hit || !is_hit) continue;
                // The error of t in units of the tolerance. Where |f'| is small it is greater, and
                // sphere tracing ends where |f| is the tolerance times its Lipschitz constant.
                const FieldSample there = sample(field, all_elements(field), ray.origin,
                                                 ray.direction, midpoint(exact.isolation.t));
                const double slope = std::abs(dot(there.gradient, ray.direction));
                if (slope * field.least_width < 0.2 * field.threshold) continue;
                ++crossings;
                const double steepest =
                    lipschitz_bound(field, all_elements(field), {ray.origin, ray.direction, 0}, 0);
                const double room = std::string(GetParam()) == "sphere" ? 2 * steepest / slope : 50;
                const double off = midpoint(given.isolation.t) - midpoint(exact.isolation.t);
                far += !(std::abs(off) <= room * tolerance * field.least_width);
            }
        }
    }
    EXPECT_GT(crossings, 200);
    EXPECT_LE(wrong, 0.005 * pixels);
    EXPECT_LE(far, 0.01 * crossings);
    std::printf("%d pixels, %d wrong; %d crossings, %d farther off than they should\n", pixels,
                wrong, crossings, far);
}

TEST_P(Methods, EmptyFieldsAndRaysPastTheBoxAreMisses) {
    Scene scene;
    EXPECT_EQ(answer(method(), compile(scene), {{0, 0, 0}, {1, 0, 0}}, 1e-6).isolation.status,
              Status::miss);
    scene.elements = {{.skeleton = PointSkeleton{{0, 0, 0}}}};
    EXPECT_EQ(answer(method(), compile(scene), {{9, 0, 9}, {1, 0, 0}}, 1e-6).isolation.status,
              Status::miss);
}

// From a point's place the ray leaves the ball: the first exit counts.
TEST_P(Methods, ARayFromInsideFindsItsExit) {
    Scene scene;
    scene.elements = {{.skeleton = PointSkeleton{{0, 0, 0}}}};
    const Isolation exit = answer(method(), compile(scene), {{0, 0, 0}, {0, 0, 2}}, 1e-6).isolation;
    ASSERT_TRUE(exit.status == Status::hit || exit.status == Status::claimed_hit);
    EXPECT_NEAR(midpoint(exit.t), 0.5 * std::sqrt(std::log(2.0)), 1e-5);
}

// Where f stays at T within rounding over a long way, nobody can tell; everybody has to end.
TEST_P(Methods, GrazingRaysEnd) {
    Scene scene;
    scene.threshold = 1;
    scene.elements = {
        {.skeleton = SegmentSkeleton{{-1000, 0, 0}, {1000, 0, 0}}, .strength = 0.5},
        {.skeleton = SegmentSkeleton{{-1000, 0, 0}, {1000, 0, 0}}, .strength = 0.5000000000000001}};
    const Isolation end =
        answer(method(), compile(scene), {{-2000, 0, 0}, {1, 0, 0}}, 1e-9).isolation;
    EXPECT_NE(end.status, Status::miss);
}

INSTANTIATE_TEST_SUITE_P(All, Methods,
                         testing::Values("bisection", "affine", "newton", "sphere", "segment",
                                         "march"),
                         [](const auto& name) { return std::string(name.param); });

// A field that reaches T only within 0.02 widths of a segment, in a box that a ball beside it makes
// large: a step of a tenth of a width passes over it.
TEST(Marching, MissesAThinSheetThatTheOthersFind) {
    Scene scene;
    scene.threshold = 0.9999;
    scene.elements = {{.skeleton = SegmentSkeleton{{0, -1, 0}, {0, 1, 0}}},
                      {.skeleton = PointSkeleton{{3, 0, 0}}, .strength = 2}};
    const Field field = compile(scene);
    int missed = 0;
    for (int n = 0; n < 20; ++n) {
        const Ray ray{{0.003, -0.06 * n, 3}, {0, 0.02 * n, -1}};
        for (const char* name : {"proved", "bisection", "affine", "newton", "sphere", "segment"}) {
            const Status status = answer(*find_method(name), field, ray, 1e-6).isolation.status;
            EXPECT_TRUE(status == Status::hit || status == Status::claimed_hit) << name;
        }
        const Status status = answer(*find_method("march"), field, ray, 1e-6).isolation.status;
        EXPECT_NE(status, Status::miss);
        missed += status == Status::claimed_miss;
    }
    EXPECT_GT(missed, 0);
}

TEST(IntervalNewton, ProvesWhatCrossesTheSurface) {
    const Scene scene =
        read_scene(std::string(IVORY_SOURCE_DIR) + "/assets/scenes/figure-2.ivory.json");
    const Field field = compile(scene);
    const View view = make_view(camera_of(scene, field, 64, 36));
    int proved = 0, claimed = 0;
    for (int j = 0; j < 36; ++j) {
        for (int i = 0; i < 64; ++i) {
            const Ray ray = primary_ray(view, 64, 36, i, j);
            const Status status = answer(*find_method("newton"), field, ray, 1e-9).isolation.status;
            proved += status == Status::hit;
            claimed += status == Status::claimed_hit;
        }
    }
    EXPECT_GT(proved, 300);
    EXPECT_LE(claimed, 3);
}

// The inclusion functions that the theorems rest on, at random places of random intervals.
TEST(NaturalExtensions, EncloseTheFieldAndItsSlope) {
    const std::uint64_t first = tools::announced_seed(17);
    int tight = 0, samples = 0;
    for (std::uint64_t seed = first; seed < first + 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Scene scene = tools::random_scene({.elements = 5}, seed);
        const Field field = compile(scene);
        const ElementList list = all_elements(field);
        tools::Random random(seed);
        for (const Ray& ray : nasty_rays(scene, RayKind::random, 20, seed)) {
            const ScaledRay scaled_ray = scaled(ray);
            const Interval<double> span = clip(scaled_ray, field.reach_box);
            if (is_empty(span)) continue;
            natural::RayField along;
            along.build(field, list, ray, scaled_ray);
            const double steepest = lipschitz_bound(field, list, scaled_ray, 0);
            for (int n = 0; n < 20; ++n) {
                const double size = std::pow(10.0, random.uniform(-9, 0)) * (span.hi - span.lo);
                const double lo = random.uniform(span.lo, span.hi - size);
                const Interval<double> t{lo, lo + size};
                const Interval<double> range = natural::extension(along, natural::Range{t}).x;
                const natural::Dual dual = natural::extension(along, natural::Dual{t, 1.0});
                const natural::Affine affine = natural::extension(along, natural::affine_over(t));
                const Interval<double> affine_range = natural::range(affine);
                tight += width(affine_range) <= width(range);
                ++samples;
                for (int k = 0; k < 5; ++k) {
                    const double x = random.uniform(t.lo, t.hi);
                    const FieldSample f =
                        sample(field, list, scaled_ray.origin, scaled_ray.direction, x);
                    const double slope = dot(f.gradient, scaled_ray.direction);
                    const double room = 1e-12 * (1 + std::abs(f.value));
                    const double slope_room = 1e-11 * (1 + steepest);
                    EXPECT_TRUE(range.lo <= f.value + room && f.value - room <= range.hi);
                    EXPECT_TRUE(dual.x.lo <= f.value + room && f.value - room <= dual.x.hi);
                    EXPECT_TRUE(dual.slope.lo <= slope + slope_room &&
                                slope - slope_room <= dual.slope.hi);
                    EXPECT_TRUE(affine_range.lo <= f.value + room &&
                                f.value - room <= affine_range.hi);
                    // Not only the range: the lines of the affine form at this place.
                    const natural::Affine place = natural::affine_over(t);
                    const double e = (x - place.mid) / place.lin;
                    EXPECT_LE(std::abs(f.value - (affine.mid + affine.lin * e)),
                              affine.err + room + 1e-6 * std::abs(affine.lin));
                    EXPECT_LE(std::abs(slope), steepest + slope_room);
                    EXPECT_NEAR(natural::extension(along, natural::Plain{x}).x, f.value,
                                1e3 * room);
                }
            }
        }
    }
    // Of tapers, polygons and curves, which have no formula, a line seldom says more than the range.
    EXPECT_GT(tight, samples / 3);
}

TEST(Lipschitz, SteepestSlopesOfTheKernels) {
    for (const KernelKind kind : tools::every_kernel) {
        SCOPED_TRACE(tools::word_of(kind));
        double beyond = 0;
        for (int n = 4000; n >= 0; --n) {
            const double q = n * 1e-3;
            const double slope = -2 * q * midpoint(kernel_slope_at(kind, q * q));
            beyond = std::max(beyond, slope);
            EXPECT_GE(steepest_beyond(kind, q), beyond * (1 - 1e-12));
            EXPECT_LE(steepest_beyond(kind, q), beyond * 1.01 + 1e-2);
        }
    }
}

}  // namespace
}  // namespace ivory
