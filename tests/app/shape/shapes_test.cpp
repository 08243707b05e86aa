// What holds of each shape in the hand, whichever there are.
#include "app/shape/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "app/shape/outlines.h"
#include "core/scene/scene_fault.h"

namespace ivory {
namespace {

HandView from_front() { return {Projection({{0.4, 0.3, 8}, {0, 0, 0}}, {800, 600})}; }

std::vector<Element> one_of_each() {
    std::vector<Element> elements;
    for (std::size_t i = 0; i < shape_count; ++i)
        elements.push_back(new_element(static_cast<Shape>(i), {0.5, -0.25, 0.1}, 0.8, i));
    return elements;
}

TEST(ShapesInHand, WhatIsAddedIsValidAndSeen) {
    for (const Element& element : one_of_each()) {
        SCOPED_TRACE(shape_word(element.skeleton));
        EXPECT_FALSE(find_fault(element));
        EXPECT_FALSE(skeleton_lines(element).lines.empty());
        EXPECT_FALSE(outline_of(from_front().projection, element, 1).empty());
        EXPECT_FALSE(strokes_of(shape_of_skeleton(element.skeleton)).empty());
    }
}

TEST(ShapesInHand, HandlesHaveNamesOfTheirOwn) {
    for (const Element& element : one_of_each()) {
        SCOPED_TRACE(shape_word(element.skeleton));
        const std::vector<Grip> grips = grips_of(from_front(), element);
        std::set<std::string> names;
        for (const Grip& grip : grips) EXPECT_TRUE(names.insert(grip.name).second) << grip.name;
        EXPECT_FALSE(names.empty());
        for (const Grip& grip : grips)
            EXPECT_TRUE(grip.arm.empty() || names.contains(grip.arm)) << grip.name;
    }
}

// Whatever a place or a whole leads, its handle is then seen where the pointer is.
TEST(ShapesInHand, HandlesFollowThePointer) {
    const HandView view = from_front();
    for (const Element& element : one_of_each())
        for (const Grip& grip : grips_of(view, element)) {
            SCOPED_TRACE(std::string(shape_word(element.skeleton)) + ", " + grip.name);
            EXPECT_EQ(moved_by(view, element, grip.name, {}), element);
            const auto moved = moved_by(view, element, grip.name, {30, -20, {}, false});
            ASSERT_TRUE(moved);
            EXPECT_FALSE(find_fault(*moved));
            EXPECT_NE(*moved, element);
            if (grip.kind == GripKind::direction || grip.kind == GripKind::length) continue;
            const auto from = view.projection.project(grip.place);
            for (const Grip& after : grips_of(view, *moved)) {
                if (after.name != grip.name) continue;
                const auto to = view.projection.project(after.place);
                ASSERT_TRUE(from && to);
                EXPECT_NEAR(to->x, from->x + 30, 1e-6);
                EXPECT_NEAR(to->y, from->y - 20, 1e-6);
            }
        }
}

TEST(ShapesInHand, TheCoverHoldsAllWithinItsDistance) {
    for (const Element& element : one_of_each()) {
        SCOPED_TRACE(shape_word(element.skeleton));
        std::vector<Ball> balls;
        cover_element(element, 0.5, balls);
        for (const SkeletonLine& line : skeleton_lines(element).lines)
            for (const Vec3d& place : line)
                for (const Vec3d& by : {Vec3d{}, Vec3d{1, 0, 0}, Vec3d{0, -1, 0}, Vec3d{0, 0, 1}})
                    EXPECT_TRUE(std::any_of(balls.begin(), balls.end(), [&](const Ball& ball) {
                        const Vec3d away = place + 0.5 * element.width * by - ball.center;
                        return std::sqrt(dot(away, away)) <= ball.radius * (1 + 1e-12);
                    }));
    }
}

// Of a circle from all sides, edge on too: each place of its outline is that far from the circle as it
// is seen, and nothing of the tube is seen beyond.
TEST(ShapesInHand, AnOrthographicCameraSeesTubesAsWideAsTheyAre) {
    constexpr double radius = 1.5, distance = 0.4;
    for (const Vec3d normal : {Vec3d{0, 0, 1}, Vec3d{0, 1, 0}, Vec3d{0, 1, 1e-7}, Vec3d{0, 1, 0.03},
                               Vec3d{1, 0.4, 0.5}, Vec3d{-2, 1, 0}}) {
        Element element;
        element.skeleton = CircleSkeleton{{0.3, -0.2, 1}, normal, radius};
        element.width = distance;
        const Projection view(
            {{0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 40, Camera::Projection::orthographic, 6.0},
            {600, 600});
        std::vector<WindowPoint> circle;
        const Ring ring({0.3, -0.2, 1}, normal, radius);
        for (int step = 0; step < 20'000; ++step)
            circle.push_back(view.project(ring.at(step * 3.14159265358979 / 10'000)).value());
        const std::vector<PictureLine> edges = outline_of(view, element, 1);
        ASSERT_FALSE(edges.empty());
        double left = 600, right = 0;
        for (const WindowPoint& at : edges.front()) {
            double nearest = 1e9;
            for (const WindowPoint& on : circle)
                nearest = std::min(nearest, std::hypot(at.x - on.x, at.y - on.y));
            EXPECT_NEAR(nearest, 100 * distance, 0.01);
            left = std::min(left, at.x);
            right = std::max(right, at.x);
        }
        const auto [first, last] = std::minmax_element(
            circle.begin(), circle.end(), [](WindowPoint a, WindowPoint b) { return a.x < b.x; });
        EXPECT_NEAR(left, first->x - 100 * distance, 0.2);
        EXPECT_NEAR(right, last->x + 100 * distance, 0.2);
    }
}

TEST(ShapesInHand, ChangesAreNamedAfterWhatTheyChange) {
    EXPECT_EQ(change_name(GripKind::place, "", "x"), "Move x");
    EXPECT_EQ(change_name(GripKind::place, "end a", "x"), "Move end a of x");
    EXPECT_EQ(change_name(GripKind::whole, "", "x"), "Move x");
    EXPECT_EQ(change_name(GripKind::direction, "normal", "x"), "Tilt x");
    EXPECT_EQ(change_name(GripKind::length, "radius", "x"), "Change radius of x");
}

}  // namespace
}  // namespace ivory
