#include "app/document/surface_bounds.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <random>

#include "core/field/field.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

bool holds(const Box3& outer, const Box3& inner) {
    if (inner.empty()) return true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(outer.lo[axis] <= inner.lo[axis] && inner.hi[axis] <= outer.hi[axis])) return false;
    }
    return true;
}

std::shared_ptr<const Scene> value(Scene scene) {
    return std::make_shared<const Scene>(std::move(scene));
}

TEST(SurfaceBounds, AtFirstAreThoseOfTheCompiledField) {
    SurfaceBounds bounds;
    for (std::uint64_t seed = 1; seed < 6; ++seed) {
        const auto scene = value(tools::random_scene({.elements = 7 * seed}, seed));
        EXPECT_EQ(bounds.quickly_around(scene), nullptr);
        EXPECT_EQ(bounds.around(scene), compile(*scene).box);
        ASSERT_NE(bounds.quickly_around(scene), nullptr);
        EXPECT_EQ(*bounds.quickly_around(scene), compile(*scene).box);
    }
}

// Elements that are moved, made wider, stronger or weaker, hidden or another's: the box holds what
// compile says that the surface reaches, edit after edit.
TEST(SurfaceBounds, HoldTheSurfaceThroughEditsOfAFewElements) {
    const std::uint64_t seed = tools::announced_seed(20261130);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> factor(0.4, 2.5);
    int quick = 0;
    for (std::uint64_t round = 0; round < 20; ++round) {
        SurfaceBounds bounds;
        Scene scene = tools::random_scene({.elements = 1 + 3 * round}, seed + round);
        const Scene others = tools::random_scene({.elements = 1 + 3 * round}, seed + 1000 + round);
        static_cast<void>(bounds.around(value(scene)));
        for (int edit = 0; edit < 20; ++edit) {
            const std::size_t i = random() % scene.elements.size();
            Element& element = scene.elements[i];
            switch (random() % 6) {
                case 0:
                    element.skeleton = PointSkeleton{{factor(random), 9 * factor(random), -1}};
                    element.widths.clear();
                    break;
                case 1:
                    if (element.widths.empty()) element.width *= factor(random);
                    break;
                case 2:
                    element.strength *= factor(random);
                    break;
                case 3:
                    element.visible = !element.visible;
                    break;
                case 4:
                    element = others.elements[i];
                    break;
                default:
                    scene.threshold *= factor(random);
                    break;
            }
            const auto now = value(scene);
            quick += bounds.quickly_around(now) != nullptr;
            EXPECT_TRUE(holds(bounds.around(now), compile(scene).box))
                << "round " << round << ", edit " << edit;
        }
    }
    EXPECT_GT(quick, 200);
}

TEST(SurfaceBounds, OfNothingAreEmpty) {
    SurfaceBounds bounds;
    EXPECT_TRUE(bounds.around(value({})).empty());
    Scene scene;
    scene.elements.push_back({.skeleton = PointSkeleton{{1, 2, 3}}, .visible = false});
    EXPECT_TRUE(bounds.around(value(scene)).empty());
    scene.elements[0].visible = true;
    EXPECT_FALSE(bounds.around(value(scene)).empty());
}

}  // namespace
}  // namespace ivory
