// How soon work ends that is to end: in evaluations, whatever they take.
#include "core/math/cancellation.h"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/math/direction.h"
#include "core/math/instruction_sets.h"
#include "core/trace/trace.h"
#include "tests/tools/instruction_sets.h"
#include "tests/tools/random_scene.h"

namespace ivory {
namespace {

constexpr std::size_t many = 20'000;

// As many points at nearly one place, with T half of their sum: no list is shorter for any ray, and
// all rays of the tests meet the surface.
Scene crowd() {
    Scene scene;
    scene.threshold = 0.5 * many;
    for (std::size_t i = 0; i < many; ++i) {
        Element element;
        element.skeleton = PointSkeleton{{static_cast<double>(i) * 1e-15, 0, 0}};
        scene.elements.push_back(element);
    }
    return scene;
}

const Ray through_the_crowd{{0, 0, 8}, {0.001, 0.002, -1}};

TEST(Cancellation, IsSeenAfterSoManyEvaluations) {
    std::atomic<bool> flag{false};
    Cancellation stop(flag);
    EXPECT_FALSE(stop.after(Cancellation::often));
    flag = true;
    EXPECT_FALSE(stop.after(Cancellation::often - 1));
    EXPECT_FALSE(stop.requested());
    EXPECT_TRUE(stop.after(1));
    EXPECT_TRUE(stop.after(0));
    EXPECT_TRUE(stop.requested());
    EXPECT_FALSE(Cancellation().after(10 * Cancellation::often));
}

TEST(Cancellation, EndsOneRayOfEachMethod) {
    const Field field = compile(crowd());
    const std::atomic<bool> flag{true};
    for (const Method* method : methods()) {
        SCOPED_TRACE(method->name());
        Counts counts;
        counts.stop = Cancellation(flag);
        std::size_t rays = 0;
        while (!counts.stop.requested() && ++rays < 10'000) {
            const Answer answer =
                trace(field, all_elements(field), through_the_crowd, *method, {}, counts);
            EXPECT_NE(answer.isolation.status, Status::miss);
        }
        EXPECT_TRUE(counts.stop.requested());
        // A few more of each element, for what a method finishes.
        EXPECT_LE(counts.element_evaluations, Cancellation::often + 100 * many);
    }
}

// What is seen while a tile is traced says nothing that is not so.
TEST(Cancellation, EndsBundlesOfEachMethodOnEachInstructionSet) {
    const Scene scene = crowd();
    const Field field = compile(scene);
    const std::atomic<bool> flag{true};
    auto rays = std::make_unique<RayBundle>();
    const Vec3d axis = unit(through_the_crowd.direction);
    for (int k = 0; k < 256; ++k) {
        rays->add(unit(axis + Vec3d{1e-3 * (k % 16), 1e-3 * (k / 16), 0}));
    }
    rays->bundle = {through_the_crowd.origin, axis, 0.05};
    for (const std::string_view set : instruction_sets()) {
        const tools::OnInstructionSet on(set);
        for (const Method* method : methods()) {
            SCOPED_TRACE(std::string(set) + " " + std::string(method->name()));
            Counts counts;
            counts.stop = Cancellation(flag);
            auto isolations = std::make_unique<BundleIsolations>();
            auto surfaces = std::make_unique<BundleSurfaces>();
            method->trace_bundle(field, all_elements(field), *rays, {}, *isolations, surfaces.get(),
                                 counts);
            EXPECT_TRUE(counts.stop.requested());
            EXPECT_LE(counts.element_evaluations, Cancellation::often + 100 * many);
            EXPECT_EQ(isolations->status[255], Status::unresolved);
            EXPECT_EQ(isolations->t_lo[255], 0);
            EXPECT_EQ(isolations->t_hi[255], std::numeric_limits<double>::infinity());
        }
    }
}

}  // namespace
}  // namespace ivory
