// The tracer against the reference of 256 bits, on ordinary and on nasty rays and scenes.
#include "core/trace/trace.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>
#include <string>

#include "core/scene/scene_json.h"
#include "tests/reference/verdict.h"
#include "tests/tools/degenerate_scenes.h"
#include "tests/tools/kinds.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/random_scene.h"

namespace ivory {
namespace {

using reference::Fault;
using tools::RayKind;

// What became of many rays.
struct Tally {
    int rays = 0, hits = 0, misses = 0, unresolved = 0;
    int decidable = 0, unresolved_decidable = 0, wide_brackets = 0;
    double worst_normal = 0, worst_color = 0;
    std::string left_open;  // rays and scenes of those
};

std::string text(const Ray& ray) {
    char line[256];
    std::snprintf(line, sizeof line, "%a %a %a %a %a %a", ray.origin.x, ray.origin.y, ray.origin.z,
                  ray.direction.x, ray.direction.y, ray.direction.z);
    return line;
}

void judge(const Scene& scene, const std::vector<Ray>& rays, double tolerance, Tally& tally) {
    const Field field = compile(scene);
    const ElementList list = all_elements(field);
    const reference::ReferenceField exact(scene);
    const Method& proved = *find_method("proved");
    Counts counts;
    for (const Ray& ray : rays) {
        const Answer answer = trace(field, list, ray, proved, {.tolerance = tolerance}, counts);
        const reference::Verdict verdict = check(exact, ray, tolerance, answer);
        ++tally.rays;
        tally.hits += answer.isolation.status == Status::hit;
        tally.misses += answer.isolation.status == Status::miss;
        EXPECT_EQ(verdict.fault, Fault::none) << word(verdict.fault) << ", ray " << text(ray);
        if (verdict.normal_error > tally.worst_normal) tally.worst_normal = verdict.normal_error;
        if (verdict.color_error > tally.worst_color) tally.worst_color = verdict.color_error;
        const bool can_be_decided = decidable(exact, ray, tolerance, verdict.reference);
        tally.decidable += can_be_decided;
        if (answer.isolation.status != Status::unresolved) continue;
        ++tally.unresolved;
        tally.unresolved_decidable += can_be_decided;
        if (can_be_decided) {
            std::ostringstream told;
            told << "unresolved though decidable: ray " << text(ray) << " in ["
                 << answer.isolation.t.lo << ", " << answer.isolation.t.hi << "]\n"
                 << write_scene(scene);
            tally.left_open += told.str();
        }
    }
}

// Another seed for a longer campaign: IVORY_TEST_SEED; more scenes: IVORY_TEST_SCENES.
std::uint64_t first_seed() {
    const char* seed = std::getenv("IVORY_TEST_SEED");
    return seed ? std::strtoull(seed, nullptr, 10) : 20261122;
}

int scene_count(int by_default) {
    const char* scenes = std::getenv("IVORY_TEST_SCENES");
    return scenes ? std::atoi(scenes) : by_default;
}

struct Case {
    std::string name;
    tools::SceneRecipe recipe;
    double tolerance;
    // Of rays that begin on the surface: where rounding hides the sign of f at t = 0 there may be no
    // telling whether the root is the first of all or of those to come.
    int left_open = 0;
};

class TraceAgainstReference : public testing::TestWithParam<Case> {};

TEST_P(TraceAgainstReference, HitAndMissHoldAndDecidableRaysAreResolved) {
    const Case& c = GetParam();
    Tally tally;
    for (int n = 0; n < scene_count(2); ++n) {
        const std::uint64_t seed = first_seed() + static_cast<std::uint64_t>(n);
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Scene scene = random_scene(c.recipe, seed);
        for (std::size_t kind = 0; kind < tools::ray_kind_words.size(); ++kind) {
            SCOPED_TRACE(std::string(tools::ray_kind_words[kind]));
            judge(scene, nasty_rays(scene, static_cast<RayKind>(kind), 24, seed + kind),
                  c.tolerance, tally);
        }
    }
    EXPECT_GT(tally.hits, 0);
    EXPECT_GT(tally.misses, 0);
    EXPECT_LE(tally.unresolved_decidable, c.left_open) << tally.left_open;
    EXPECT_LT(tally.worst_normal, 1e-9);
    EXPECT_LT(tally.worst_color, 1e-9);
    std::printf(
        "%d rays: %d hit, %d miss, %d unresolved (%d of %d decidable); normal %.1e, colour %.1e\n",
        tally.rays, tally.hits, tally.misses, tally.unresolved, tally.unresolved_decidable,
        tally.decidable, tally.worst_normal, tally.worst_color);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, TraceAgainstReference,
    testing::Values(Case{"few", {.elements = 4}, 1e-9}, Case{"some", {.elements = 12}, 1e-9},
                    Case{"many", {.elements = 60}, 1e-6}, Case{"coarse", {.elements = 8}, 0.1, 1},
                    Case{"fine", {.elements = 8}, 1e-12}, Case{"finest", {.elements = 4}, 1e-15},
                    Case{"shifted", {.elements = 8, .shift = 1e6}, 1e-9},
                    Case{"small", {.elements = 8, .scale = 1e-6}, 1e-9},
                    Case{"large", {.elements = 8, .scale = 1e6}, 1e-9},
                    Case{"critical", {.elements = 8, .critical = true}, 1e-9}),
    [](const auto& test_case) { return test_case.param.name; });

std::vector<Case> one_kind_alone() {
    std::vector<Case> cases;
    for (const tools::ElementKind& kind : tools::every_kind) {
        cases.push_back({tools::word_of(kind), {.elements = 4, .only = kind}, 1e-9});
    }
    return cases;
}
INSTANTIATE_TEST_SUITE_P(Each, TraceAgainstReference, testing::ValuesIn(one_kind_alone()),
                         [](const auto& test_case) { return test_case.param.name; });

// Positions that formulas get wrong, of the shapes that are built. (Along the generating line of a
// cone f hardly changes, and some of the rays that run 1e-9 off it are still left unresolved.)
class TraceDegenerate : public testing::TestWithParam<tools::Family> {};
INSTANTIATE_TEST_SUITE_P(Each, TraceDegenerate,
                         testing::Values(tools::Family::disc_edge_on, tools::Family::disc_axis,
                                         tools::Family::disc_rim, tools::Family::disc_plane,
                                         tools::Family::taper_axis, tools::Family::taper_apex,
                                         tools::Family::taper_swallow),
                         [](const auto& family) {
                             const auto n = static_cast<std::size_t>(family.param);
                             return std::string(tools::family_words[n]);
                         });

TEST_P(TraceDegenerate, HitAndMissHoldAndDecidableRaysAreResolved) {
    Tally tally;
    for (int n = 0; n < scene_count(2) * 10; ++n) {  // every kernel, both signs
        const std::uint64_t seed = first_seed() + static_cast<std::uint64_t>(n);
        SCOPED_TRACE("seed " + std::to_string(seed));
        const tools::DegenerateCase made = degenerate_case(GetParam(), seed);
        judge(parse_scene(tools::scene_text(made.scene), "scene"), made.rays, 1e-9, tally);
    }
    EXPECT_EQ(tally.unresolved_decidable, 0) << tally.left_open;
    EXPECT_GT(tally.hits, 0);
    EXPECT_GT(tally.misses, 0);
}

}  // namespace
}  // namespace ivory
