#include "app/document/elements.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "app/shape/shapes.h"
#include "core/scene/scene_fault.h"
#include "tests/error_line.h"

namespace ivory {
namespace {

using Names = std::vector<std::string>;

Element point(double x) {
    Element element;
    element.skeleton = PointSkeleton{{x, 0, 0}};
    return element;
}

Element named(Element element, const std::string& name) {
    element.name = name;
    return element;
}

Element circle() {
    Element element;
    element.skeleton = CircleSkeleton{{0, 0, 0}, {0, 0, 2}, 1.5};
    return element;
}

Scene scene_of(std::vector<Element> elements) {
    Scene scene;
    scene.elements = std::move(elements);
    return scene;
}

TEST(Elements, ANewOneStandsAroundItsPlaceInTidyNumbers) {
    const Element added = new_element(Shape::segment, {0.123456789, -2.00049, 0}, 0.5, 0);
    const auto& segment = std::get<SegmentSkeleton>(added.skeleton);
    EXPECT_EQ(segment.a, (Vec3d{-0.38, -2, 0}));
    EXPECT_EQ(segment.b, (Vec3d{0.62, -2, 0}));
    EXPECT_EQ(added.width, 0.5);
    const Element ring = new_element(Shape::circle, {0, 0, 0}, 1, 1);
    EXPECT_EQ(std::get<CircleSkeleton>(ring.skeleton).radius, 1.5);
    EXPECT_NE(ring.color, added.color);
}

TEST(Elements, DefaultNamesFollowTheOrder) {
    Scene scene = scene_of({point(0), circle(), point(1), point(2)});
    EXPECT_EQ(element_names(scene), (Names{"point 1", "circle 1", "point 2", "point 3"}));
    scene = without_element(scene, 0);
    EXPECT_EQ(element_names(scene), (Names{"circle 1", "point 1", "point 2"}));
    EXPECT_FALSE(scene.elements[1].name);  // still not written
}

TEST(Elements, ADefaultThatIsTakenIsWrittenWithTheNextFreeNumber) {
    const Scene scene = with_element(scene_of({point(0), named(circle(), "point 2")}), point(1));
    EXPECT_EQ(element_names(scene), (Names{"point 1", "point 2", "point 3"}));
    EXPECT_FALSE(find_fault(scene));
}

TEST(Elements, ACopyIsTheSameButForItsName) {
    Scene scene = scene_of({named(point(4), "heart"), point(1)});
    scene.elements[0].strength = -0.25;
    scene = with_copy(scene, 0);
    EXPECT_EQ(element_names(scene), (Names{"heart", "heart 2", "point 3"}));
    EXPECT_EQ(scene.elements[1].skeleton, scene.elements[0].skeleton);
    EXPECT_EQ(scene.elements[1].strength, -0.25);
    scene = with_copy(scene, 1);
    EXPECT_EQ(element_names(scene), (Names{"heart", "heart 2", "heart 3", "point 4"}));
    scene = with_copy(scene, 3);
    EXPECT_EQ(element_names(scene), (Names{"heart", "heart 2", "heart 3", "point 4", "point 5"}));
}

TEST(Elements, MovingKeepsTheOrderOfTheOthers) {
    const Scene scene = scene_of(
        {named(point(0), "a"), named(point(1), "b"), named(point(2), "c"), named(point(3), "d")});
    EXPECT_EQ(element_names(with_element_moved(scene, 0, 2)), (Names{"b", "c", "a", "d"}));
    EXPECT_EQ(element_names(with_element_moved(scene, 3, 0)), (Names{"d", "a", "b", "c"}));
    EXPECT_EQ(element_names(with_element_moved(scene, 1, 1)), (Names{"a", "b", "c", "d"}));
}

TEST(Elements, ANameIsUniqueDefaultsIncluded) {
    const Scene scene = scene_of({point(0), point(1)});
    const std::string line = tests::error_line([&] { (void)with_name(scene, 0, "point 2"); });
    EXPECT_NE(line.find("\"point 2\""), std::string::npos) << line;
    EXPECT_EQ(element_names(with_name(scene, 0, "core")), (Names{"core", "point 2"}));
}

TEST(Elements, NoNameAndTheDefaultNameAreTheDefault) {
    const Scene scene = scene_of({named(point(0), "core"), point(1)});
    EXPECT_FALSE(with_name(scene, 0, "").elements[0].name);
    EXPECT_FALSE(with_name(scene, 0, "point 1").elements[0].name);
}

TEST(Elements, AnyRowOfEditsLeavesAValidScene) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        std::mt19937 random(seed);
        const auto below = [&](std::size_t n) { return random() % n; };
        Scene scene;
        for (int step = 0; step < 60; ++step) {
            const std::size_t n = scene.elements.size();
            const std::size_t kind = n == 0 ? 0 : below(5);
            if (kind == 0)
                scene =
                    with_element(scene, new_element(static_cast<Shape>(below(3)), {0, 0, 0}, 1, n));
            if (kind == 1) scene = without_element(scene, below(n));
            if (kind == 2) scene = with_copy(scene, below(n));
            if (kind == 3) scene = with_element_moved(scene, below(n), below(n));
            if (kind == 4) {
                const Names names{"point 3", "segment 2", "circle 1", "heart", "heart 2", ""};
                try {
                    scene = with_name(scene, below(n), names[below(names.size())]);
                } catch (const Error&) {  // taken
                }
            }
            const auto fault = find_fault(scene);
            ASSERT_FALSE(fault) << "seed " << seed << ", step " << step << ": " << fault->message;
        }
    }
}

TEST(Elements, TheBoxHoldsTheSkeletonAndOneWidth) {
    Element element = circle();
    element.width = 0.25;
    const Box3 box = box_around(element);
    EXPECT_NEAR(box.hi.x, 1.75, 1e-15);
    EXPECT_NEAR(box.lo.y, -1.75, 1e-15);
    EXPECT_NEAR(box.hi.z, 0.25, 1e-15);
}

}  // namespace
}  // namespace ivory
