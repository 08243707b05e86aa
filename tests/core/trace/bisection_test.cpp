// The baseline: its misses hold, its hits are claims, near to the proved ones where the ray crosses
// the surface and not to be trusted where it passes by.
#include "core/trace/methods/bisection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/field/surface.h"
#include "core/render/camera.h"
#include "core/render/framing.h"
#include "core/scene/scene_json.h"
#include "core/trace/trace.h"
#include "tests/reference/reference.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using tools::RayKind;

const Method& bisection() { return *find_method("bisection"); }
const Method& proved() { return *find_method("proved"); }

Answer answer(const Method& method, const Field& field, const Ray& ray, double tolerance) {
    Counts counts;
    return trace(field, all_elements(field), ray, method, {.tolerance = tolerance}, counts);
}

double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

// The rays of every eighth pixel of figure 1.
std::vector<Ray> rays_of_figure_1(const Scene& scene, const Field& field) {
    constexpr int width = 160, height = 96;
    const View view = make_view(camera_of(scene, field, width, height));
    std::vector<Ray> rays;
    for (int j = 4; j < height; j += 8) {
        for (int i = 4; i < width; i += 8) rays.push_back(primary_ray(view, width, height, i, j));
    }
    return rays;
}

Scene figure_1() {
    return read_scene(std::string(IVORY_SOURCE_DIR) + "/assets/scenes/figure-1.ivory.json");
}

TEST(Bisection, AgreesWithTheProvedHitWhereTheRayCrossesTheSurface) {
    constexpr double tolerance = 1e-6;
    const Scene scene = figure_1();
    const Field field = compile(scene);
    int crossings = 0;
    for (const Ray& ray : rays_of_figure_1(scene, field)) {
        const Answer exact = answer(proved(), field, ray, tolerance);
        if (exact.isolation.status != Status::hit) continue;
        const Vec3d& n = exact.surface.normal;
        if (-dot(n, ray.direction) < 0.2 * length(ray.direction)) continue;
        ++crossings;
        const Answer claim = answer(bisection(), field, ray, tolerance);
        ASSERT_EQ(claim.isolation.status, Status::claimed_hit);
        const Interval<double>& t = claim.isolation.t;
        EXPECT_LE(t.hi - t.lo, tolerance * field.least_width / length(ray.direction));
        // What came before is proved to hold no root; the claim itself may stand a little before.
        EXPECT_LE(t.lo, exact.isolation.t.hi);
        EXPECT_NEAR(midpoint(t), midpoint(exact.isolation.t), 100 * tolerance * field.least_width);
        EXPECT_LT(length(claim.surface.normal - n), 1e-3);
        EXPECT_LT(length(claim.surface.color - exact.surface.color), 1e-3);
    }
    EXPECT_GT(crossings, 20);
}

TEST(Bisection, SaysOnlyClaimedHitMissOrUnresolvedAndItsMissesHold) {
    const std::uint64_t first = tools::announced_seed(81);
    int misses = 0, claims = 0;
    for (std::uint64_t seed = first; seed < first + 3; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Scene scene = tools::random_scene({.elements = 3}, seed);
        const Field field = compile(scene);
        const reference::ReferenceField exact(scene);
        for (const RayKind kind : {RayKind::random, RayKind::parallel, RayKind::scaled,
                                   RayKind::inside, RayKind::surface}) {
            for (const Ray& ray : nasty_rays(scene, kind, 12, seed)) {
                const Isolation claim = answer(bisection(), field, ray, 1e-3).isolation;
                ASSERT_TRUE(claim.status == Status::claimed_hit || claim.status == Status::miss ||
                            claim.status == Status::unresolved);
                claims += claim.status == Status::claimed_hit;
                const reference::ReferenceAnswer truth = first_root(exact, ray);
                if (claim.status == Status::miss) {
                    ++misses;
                    EXPECT_TRUE(is_empty(claim.t));
                    EXPECT_NE(truth.outcome, reference::Outcome::hit);
                } else if (truth.outcome == reference::Outcome::hit) {
                    // Everything before the claim was searched, with proof.
                    EXPECT_TRUE(reference::Real(claim.t.lo) <= truth.t.hi) << claim.t.lo;
                }
            }
        }
    }
    EXPECT_GT(misses, 0);
    EXPECT_GT(claims, 0);
}

// Its weakness: x^2 + y^2 of intervals that know nothing of each other is too wide by their width,
// so that next to a silhouette it cannot tell a near miss from a touch, and claims a hit.
TEST(Bisection, ClaimsAHitNextToASilhouetteWhereTheProvedMethodProvesAMiss) {
    Scene scene;
    scene.threshold = 0.5;
    scene.elements = {{.skeleton = PointSkeleton{{0, 0, 0}}}};
    const Field field = compile(scene);
    const auto beside = [](double off) {  // passes the centre at the radius times 1 + off
        const double x = std::sqrt(0.5 * std::log(2.0)) * (1 + off);
        return Ray{{x - 4, -x - 4, 0}, {1, 1, 0}};
    };
    const auto status = [&](const Method& method, double off, double tolerance) {
        return answer(method, field, beside(off), tolerance).isolation.status;
    };
    for (const double off : {1e-6, 1e-10}) {
        EXPECT_EQ(first_root(reference::ReferenceField(scene), beside(off)).outcome,
                  reference::Outcome::miss);
    }
    EXPECT_EQ(status(proved(), 1e-6, 1e-4), Status::miss);
    EXPECT_EQ(status(bisection(), 1e-6, 1e-4), Status::claimed_hit);
    // A finer tolerance tells this ray, and fails on the next one.
    EXPECT_EQ(status(bisection(), 1e-6, 1e-8), Status::miss);
    EXPECT_EQ(status(proved(), 1e-10, 1e-8), Status::miss);
    EXPECT_EQ(status(bisection(), 1e-10, 1e-8), Status::claimed_hit);
}

TEST(Bisection, IsFoundByNameAndProvesNoHit) {
    EXPECT_EQ(bisection().name(), "bisection");
    EXPECT_NE(bisection().proves().find("a hit is claimed"), std::string_view::npos);
    EXPECT_EQ(methods().front(), &proved());
    EXPECT_EQ(find_method("no such method"), nullptr);
}

}  // namespace
}  // namespace ivory
