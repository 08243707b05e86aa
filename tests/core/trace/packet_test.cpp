// Packets against single rays and against the reference of 256 bits.
#include "core/trace/packet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "core/trace/methods/proved.h"
#include "tests/reference/verdict.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/random_scene.h"

namespace ivory {
namespace {

using tools::Random;
using tools::RayKind;

Vec3d unit(const Vec3d& v) {
    const double length = std::hypot(v.x, v.y, v.z);
    return {v.x / length, v.y / length, v.z / length};
}

// `count` rays around one, at most about `spread` away from it.
std::unique_ptr<RayBundle> bundle_around(const Ray& ray, double spread, std::size_t count,
                                         Random& random) {
    auto rays = std::make_unique<RayBundle>();
    const Vec3d axis = unit(unit(ray.direction));
    double farthest = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const Vec3d d = unit(unit(axis + spread * random.in_cube(0.5)));
        rays->add(d);
        const Vec3d off = d - axis;
        farthest = std::max(farthest, std::sqrt(dot(off, off)));
    }
    rays->bundle = {ray.origin, axis, farthest * 1.001 + 1e-15};
    return rays;
}

bool usable(const Ray& ray) {
    const double length = std::hypot(ray.direction.x, ray.direction.y, ray.direction.z);
    return length > 1e-100 && length < 1e100;
}

struct Case {
    const char* name;
    tools::SceneRecipe recipe;
    double tolerance;
    double least_decided;  // share of the rays
    bool hits = true;      // whether packets can prove any: not with cells below 8 ulp of t
};

class PacketOfRays : public testing::TestWithParam<Case> {};

// What packets decide by themselves is what one ray alone is answered, to the bit; and of some of
// them the reference says the same.
TEST_P(PacketOfRays, AnswersAsSingleRaysDo) {
    const Case& c = GetParam();
    const Proved proved;
    PacketTracer packets;
    int rays_traced = 0, decided = 0, hits = 0, judged = 0;
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
                if (!usable(ray)) continue;
                const double spread = std::pow(10.0, random.uniform(-5, -0.7));
                const auto rays = bundle_around(ray, spread, 5 + random.below(40), random);
                std::array<Isolation, RayBundle::capacity> found;
                Counts counts;
                packets.isolate(field, list, *rays, settings, {found.data(), rays->size()}, counts);
                for (std::size_t k = 0; k < rays->size(); ++k) {
                    ++rays_traced;
                    if (found[k].status == Status::unresolved) continue;
                    ++decided;
                    hits += found[k].status == Status::hit;
                    const Isolation alone = proved.isolate(field, list, rays->ray(k),
                                                           {.tolerance = c.tolerance}, counts);
                    ASSERT_EQ(found[k].status, alone.status);
                    if (alone.status == Status::hit) {
                        ASSERT_EQ(found[k].t.lo, alone.t.lo);
                        ASSERT_EQ(found[k].t.hi, alone.t.hi);
                    }
                    if (random.below(200) != 0) continue;
                    Answer answer{found[k], {}};
                    if (alone.status == Status::hit) {
                        answer.surface = proved.surface(field, list, rays->ray(k),
                                                        midpoint(alone.t), {});
                    }
                    const reference::Verdict verdict =
                        check(exact, rays->ray(k), c.tolerance, answer);
                    EXPECT_EQ(verdict.fault, reference::Fault::none) << word(verdict.fault);
                    ++judged;
                }
            }
        }
    }
    EXPECT_EQ(hits > 0, c.hits);
    EXPECT_GT(judged, 0);
    EXPECT_GE(decided, c.least_decided * rays_traced);
    std::printf("%d rays, %d decided by packets, %d hits, %d judged by the reference; %s\n",
                rays_traced, decided, hits, judged, std::string(packet_target()).c_str());
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, PacketOfRays,
    testing::Values(Case{"few", {.elements = 4}, 1e-6, 0.5}, Case{"some", {.elements = 12}, 1e-9, 0.5},
                    Case{"many", {.elements = 60}, 1e-6, 0.5},
                    Case{"coarse", {.elements = 8}, 0.1, 0.5},
                    Case{"fine", {.elements = 8}, 1e-12, 0.2},
                    Case{"finest", {.elements = 4}, 1e-15, 0.1, false},
                    Case{"shifted", {.elements = 8, .shift = 1e6}, 1e-6, 0.2},
                    Case{"small", {.elements = 8, .scale = 1e-6}, 1e-9, 0.5},
                    Case{"large", {.elements = 8, .scale = 1e6}, 1e-9, 0.5},
                    Case{"critical", {.elements = 8, .critical = true}, 1e-9, 0.2}),
    [](const auto& test_case) { return std::string(test_case.param.name); });

}  // namespace
}  // namespace ivory
