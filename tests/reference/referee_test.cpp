// The referee finds single answers that were falsified, and uses as many bits as that takes.
#include "tests/reference/referee.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/reference/from_core.h"
#include "tests/tools/degenerate_scenes.h"
#include "tests/tools/kinds.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/random_scene.h"

namespace ivory::reference {
namespace {

using Status = Claim::Status;

constexpr double tolerance = 1e-9;

double next(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()); }
double before(double x) { return std::nextafter(x, 0.0); }

// What becomes of an answer: "right", "beyond", or its fault.
std::string said(const Referee& referee, const Ray& ray, const Claim& claim) {
    const Decision decision = referee.rule(ray, tolerance, claim);
    if (decision.fault != Fault::none) return word(decision.fault);
    return decision.undecided ? "beyond" : "right";
}

// The doubles next to the root, which is none itself: so the true bracket of one ulp, and false ones.
void falsify(const Referee& referee, const Ray& ray, const ReferenceAnswer& first, int& later) {
    const double lo = first.t.lo.to_double(MPFR_RNDD), hi = first.t.hi.to_double(MPFR_RNDU);
    ASSERT_EQ(hi, next(lo));
    EXPECT_EQ(said(referee, ray, {Status::hit, lo, hi}), "right");
    EXPECT_EQ(said(referee, ray, {Status::hit, hi, next(hi)}), "wrong hit");
    EXPECT_EQ(said(referee, ray, {Status::hit, before(lo), lo}), "wrong hit");
    EXPECT_EQ(said(referee, ray, {Status::unresolved, lo, 2 * hi}), "right");
    EXPECT_EQ(said(referee, ray, {Status::unresolved, hi, 2 * hi}), "wrong bracket");
    EXPECT_EQ(said(referee, ray, {Status::unresolved, 0, lo}), "wrong bracket");
    EXPECT_EQ(said(referee, ray, {Status::miss}), "wrong miss");
    EXPECT_EQ(said(referee, ray, {Status::hit, 0.5 * lo, 0.5 * hi}), "wrong hit");

    // Where it goes on, from a little behind the root.
    const auto beyond = [&](double t, std::size_t k) {
        return std::fma(t, ray.direction[k], ray.origin[k]);
    };
    const double t = hi * (1 + 1e-6);
    const Ray rest{{beyond(t, 0), beyond(t, 1), beyond(t, 2)}, ray.direction};
    const ReferenceAnswer second = first_root(referee.field(), rest);
    if (second.outcome != Outcome::hit) return;
    const double other = t + second.t.lo.to_double();
    EXPECT_EQ(said(referee, ray, {Status::hit, other * (1 - 1e-12), other * (1 + 1e-12)}),
              "wrong hit");
    ++later;
}

void falsify_all(const Referee& referee, const std::vector<Ray>& rays, int& hits, int& misses,
                 int& later) {
    for (const Ray& ray : rays) {
        SCOPED_TRACE(described("ray", ray, {}, {}));
        const ReferenceAnswer first = first_root(referee.field(), ray);
        if (first.outcome == Outcome::miss) {
            ++misses;
            EXPECT_EQ(said(referee, ray, {Status::miss}), "right");
            const double t = 1 / std::hypot(ray.direction.x, ray.direction.y, ray.direction.z);
            EXPECT_EQ(said(referee, ray, {Status::hit, t, next(t)}), "wrong hit");  // a phantom
        } else if (first.outcome == Outcome::hit && first.t.lo > Real(0.0)) {
            const double lo = first.t.lo.to_double(MPFR_RNDD);
            if (next(lo) != first.t.hi.to_double(MPFR_RNDU)) continue;  // a double is the root
            ++hits;
            falsify(referee, ray, first, later);
        }
    }
}

std::vector<Ray> rays_of(const std::vector<ivory::Ray>& rays) { return {rays.begin(), rays.end()}; }

class RefereeOfEach : public testing::TestWithParam<tools::ElementKind> {};
INSTANTIATE_TEST_SUITE_P(Kind, RefereeOfEach, testing::ValuesIn(tools::every_kind),
                         tools::name_of_kind);

TEST_P(RefereeOfEach, FindsFalsifiedAnswers) {
    const Scene scene = tools::random_scene({.elements = 4, .only = GetParam()}, 3);
    const Referee referee(from_core(scene));
    int hits = 0, misses = 0, later = 0;
    for (const auto kind : {tools::RayKind::random, tools::RayKind::tangent}) {
        std::vector<Ray> rays = rays_of(tools::nasty_rays(scene, kind, 12, 4));
        if (kind == tools::RayKind::random) {  // and away from the scene
            for (std::size_t i = 0; i < 6; ++i) {
                const Vec3d& d = rays[i].direction;
                rays.push_back({rays[i].origin, {-d.x, -d.y, -d.z}});
            }
        }
        falsify_all(referee, rays, hits, misses, later);
    }
    EXPECT_GT(hits, 5);
    EXPECT_GT(misses, 4);
    EXPECT_GT(later, 2);
}

ReferenceScene points_of(double threshold, Kernel kernel, const std::vector<double>& strengths) {
    ReferenceScene scene{threshold, {}};
    for (const double strength : strengths) {
        scene.elements.push_back({Point{}, kernel, strength});
    }
    return scene;
}

// From 2^300 away, where 256 bits do not tell the places of a unit from each other.
TEST(Referee, TakesMoreBitsWhereFewDoNotDecide) {
    const ReferenceScene scene = points_of(0.5, Kernel::blinn, {1});
    const Referee referee(scene), coarse(scene, 256);
    const double far = 0x1p300;
    const Ray ray{{-far, 0.5, 0}, {1, 0, 0}}, beside{{-far, 1, 0}, {1, 0, 0}};
    const Claim hit{Status::hit, before(far), next(far)}, early{Status::hit, 1, 2};
    const Decision decision = referee.rule(ray, tolerance, hit);
    EXPECT_EQ(decision.fault, Fault::none);
    EXPECT_FALSE(decision.undecided);
    EXPECT_GT(decision.bits, 256);
    EXPECT_EQ(said(referee, ray, {Status::miss}), "wrong miss");
    EXPECT_EQ(said(referee, ray, early), "wrong hit");
    EXPECT_EQ(said(referee, beside, {Status::miss}), "right");
    EXPECT_EQ(said(referee, beside, hit), "wrong hit");
    EXPECT_EQ(said(coarse, ray, {Status::miss}), "beyond");
}

// What is left of strengths that cancel to their last bits.
TEST(Referee, AddsStrengthsUpExactly) {
    const Referee referee(points_of(0.5, Kernel::blinn, {1e200, 1e-200, -1e200, 1, -1e-200}));
    const Ray ray{{-20, 0, 0}, {1, 0, 0}}, beside{{-20, 1, 0}, {1, 0, 0}};
    const double root = 20 - std::sqrt(std::log(2));
    const Claim hit{Status::hit, root - 1e-12, root + 1e-12};
    EXPECT_EQ(said(referee, ray, hit), "right");
    EXPECT_EQ(said(referee, ray, {Status::miss}), "wrong miss");
    EXPECT_EQ(said(referee, beside, {Status::miss}), "right");
    EXPECT_EQ(said(referee, beside, hit), "wrong hit");
}

// (1 - s)^2 = 9/16 at q = 1/2. At 1/2 a ray touches, which no precision tells; not so a bit beside it.
TEST(Referee, LeavesOpenWhatTouches) {
    const Referee referee(points_of(0.5625, Kernel::murakami, {1}));
    const auto miss = [&](double height) {
        return said(referee, {{-4, height, 0}, {1, 0, 0}}, {Status::miss});
    };
    EXPECT_EQ(miss(0.5), "beyond");
    EXPECT_EQ(miss(next(0.5)), "right");
    EXPECT_EQ(miss(before(0.5)), "wrong miss");
}

// A root at the very beginning counts, and is the first; here it is a double.
TEST(Referee, KnowsARootAtTheOrigin) {
    const Referee referee(points_of(0.5625, Kernel::murakami, {1}));
    for (const double way : {-1.0, 1.0}) {
        const Ray ray{{0.5, 0, 0}, {way, 0, 0}};
        EXPECT_EQ(said(referee, ray, {Status::hit, 0, 0}), "right");
        EXPECT_EQ(said(referee, ray, {Status::miss}), "wrong miss");
        EXPECT_EQ(said(referee, ray, {Status::hit, 1, 1}), "wrong hit");
    }
}

TEST(Referee, MindsTheWidthOfAHit) {
    const Referee referee(points_of(0.5, Kernel::blinn, {1}));
    const double root = 20 - std::sqrt(std::log(2));
    const Ray ray{{-20, 0, 0}, {1, 0, 0}};
    EXPECT_EQ(said(referee, ray, {Status::hit, root - 4e-10, root + 4e-10}), "right");
    EXPECT_EQ(said(referee, ray, {Status::hit, root - 6e-10, root + 6e-10}), "too wide");
    EXPECT_EQ(said(referee, ray, {Status::hit, root + 1e-12, root - 1e-12}), "malformed");
}

}  // namespace
}  // namespace ivory::reference
