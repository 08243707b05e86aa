#include "app/viewer/handles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "app/document/elements.h"
#include "core/field/field.h"
#include "tests/app/each_projection.h"
#include "tests/app/panels/viewer_bench.h"

namespace ivory {
namespace {

using tests::ViewerBench;

// A point, a segment and a tilted circle, seen from somewhere.
Scene figure() {
    Scene scene;
    Element point, segment, circle;
    point.skeleton = PointSkeleton{{0.5, 1.25, -0.5}};
    segment.skeleton = SegmentSkeleton{{-1.5, -0.25, 0.25}, {1, -1, 0}};
    circle.skeleton = CircleSkeleton{{0, 0.25, 0}, {0.5, 0.5, 1}, 1.25};
    segment.width = circle.width = 0.5;
    scene.elements = {point, segment, circle};
    scene.camera = Camera{{3, 2, 7}, {0, 0, 0}};
    return scene;
}

class InEachProjection : public tests::InEachProjection {
  protected:
    static Scene figure() {
        Scene scene = ivory::figure();
        scene.camera = in_projection(*scene.camera, GetParam());
        return scene;
    }
};
INSTANTIATE_TEST_SUITE_P(, InEachProjection, InEachProjection::all(), InEachProjection::name);

// What a drag moves: element, handle, and its number beyond that one of the picture.
struct Grabbed {
    std::size_t element;
    std::string handle;
};
const std::vector<Grabbed> all_handles = {{0, "position"}, {1, "a"},      {1, "b"},
                                          {1, "middle"},   {2, "center"}, {2, "normal"},
                                          {2, "radius"}};
const std::vector<Grabbed> free_handles = {{0, "position"}, {1, "a"},      {1, "b"},
                                           {1, "middle"},   {2, "center"}, {2, "normal"}};

TEST(Handles, EveryDegreeOfFreedomHasOne) {
    ViewerBench bench(figure());
    std::vector<std::vector<std::string>> names(3);
    for (std::size_t i = 0; i < 3; ++i)
        for (const Handle& handle : handles_of(bench.state, i)) names[i].push_back(handle.name);
    EXPECT_EQ(names[0], (std::vector<std::string>{"position"}));
    EXPECT_EQ(names[1], (std::vector<std::string>{"a", "b", "middle"}));
    EXPECT_EQ(names[2], (std::vector<std::string>{"center", "normal", "radius"}));
}

TEST_P(InEachProjection, ADragMovesWhatIsSeenByExactlySoManyPixels) {
    for (const Grabbed& grabbed : free_handles) {
        SCOPED_TRACE(grabbed.handle);
        ViewerBench bench(figure());
        bench.state.document.select(grabbed.element);
        bench.turn();
        const Handle before = bench.handle(grabbed.handle);
        bench.drag(before.at, 37, -21);
        const Handle after = bench.handle(grabbed.handle);
        EXPECT_NEAR(after.seen.x - before.seen.x, 37, 1e-7);
        EXPECT_NEAR(after.seen.y - before.seen.y, -21, 1e-7);
        // in the plane parallel to the screen
        EXPECT_NEAR(dot(after.place - before.place, bench.state.projection().back()), 0, 1e-12);
    }
}

TEST(Handles, ItIsTheOneThatIsGrabbedThatMoves) {
    ViewerBench bench(figure());
    const Scene before = bench.scene();
    bench.state.document.select(1);
    bench.turn();
    bench.drag(bench.handle("b").at, 30, 10);
    EXPECT_EQ(bench.element(0), before.elements[0]);
    EXPECT_EQ(bench.element(2), before.elements[2]);
    const auto& segment = std::get<SegmentSkeleton>(bench.element(1).skeleton);
    EXPECT_EQ(segment.a, std::get<SegmentSkeleton>(before.elements[1].skeleton).a);

    bench.drag(bench.handle("middle").at, -12, 50);
    const auto& moved = std::get<SegmentSkeleton>(bench.element(1).skeleton);
    const Vec3d length = segment.b - segment.a, after = moved.b - moved.a;
    EXPECT_NEAR(after.x, length.x, 1e-14);
    EXPECT_NEAR(after.y, length.y, 1e-14);
    EXPECT_NEAR(after.z, length.z, 1e-14);
}

TEST_P(InEachProjection, TheRadiusFollowsThePointerAndEndsAtZero) {
    ViewerBench bench(figure());
    bench.state.document.select(2);
    bench.turn();
    const Handle before = bench.handle("radius"), center = bench.handle("center");
    const double dx = before.seen.x - center.seen.x, dy = before.seen.y - center.seen.y;
    bench.drag(before.at, 0.2 * dx, 0.2 * dy);
    const Handle after = bench.handle("radius");
    EXPECT_NEAR(after.seen.x, before.seen.x + 0.2 * dx, 1e-7);
    EXPECT_NEAR(after.seen.y, before.seen.y + 0.2 * dy, 1e-7);
    const auto radius = [&] { return std::get<CircleSkeleton>(bench.element(2).skeleton).radius; };
    EXPECT_GT(radius(), 1.25);
    bench.drag(after.at, -1.5 * dx, -1.5 * dy);
    EXPECT_EQ(radius(), 0);
}

TEST_P(InEachProjection, ALockedAxisMovesThatCoordinateAlone) {
    const Key keys[3] = {Key::x, Key::y, Key::z};
    for (const Grabbed& grabbed : free_handles) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            SCOPED_TRACE(grabbed.handle + " along " + "xyz"[axis]);
            ViewerBench bench(figure());
            bench.state.document.select(grabbed.element);
            bench.turn();
            const Handle before = bench.handle(grabbed.handle);
            const Element was = bench.element(grabbed.element);
            bench.move_to(before.at);
            bench.press();
            bench.move_to({before.at.x + 5, before.at.y + 3});
            bench.hold(keys[axis]);
            EXPECT_EQ(bench.mouse.locked_axis(), static_cast<int>(axis));
            bench.move_to({before.at.x + 40, before.at.y + 25});
            bench.let(keys[axis]);
            bench.release();

            // every number of the skeleton is as it was, to the bit, but for that coordinate
            const auto numbers = [](const Element& element) -> std::vector<Vec3d> {
                if (const auto* point = std::get_if<PointSkeleton>(&element.skeleton))
                    return {point->position};
                if (const auto* segment = std::get_if<SegmentSkeleton>(&element.skeleton))
                    return {segment->a, segment->b};
                const auto& circle = std::get<CircleSkeleton>(element.skeleton);
                return {circle.center, circle.normal, {circle.radius, 0, 0}};
            };
            const auto old = numbers(was), now = numbers(bench.element(grabbed.element));
            EXPECT_NE(old, now);
            for (std::size_t i = 0; i < old.size(); ++i)
                for (std::size_t k = 0; k < 3; ++k) {
                    if (k != axis) {
                        EXPECT_EQ(now[i][k], old[i][k]);
                    }
                }
        }
    }
}

TEST_P(InEachProjection, AlongAnAxisThePointerOnItsLineIsMetExactly) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.turn();
    const Handle before = bench.handle("position");
    const Projection view = bench.state.projection();
    const auto goal = view.project(before.place + Vec3d{1, 0, 0});
    ASSERT_TRUE(goal);
    bench.move_to(before.at);
    bench.press();
    bench.key(Key::x);
    bench.move_to({goal->x + bench.state.viewport.x, goal->y + bench.state.viewport.y});
    bench.release();
    const Vec3d position = std::get<PointSkeleton>(bench.element(0).skeleton).position;
    EXPECT_NEAR(position.x, before.place.x + 1, 1e-6);
}

TEST(Handles, TheSameKeyAgainUnlocks) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.turn();
    const Handle before = bench.handle("position");
    bench.move_to(before.at);
    bench.press();
    bench.key(Key::y);
    EXPECT_EQ(bench.mouse.locked_axis(), 1);
    bench.key(Key::z);
    EXPECT_EQ(bench.mouse.locked_axis(), 2);
    bench.key(Key::z);
    EXPECT_EQ(bench.mouse.locked_axis(), std::nullopt);
    bench.move_to({before.at.x + 20, before.at.y});
    bench.release();
    EXPECT_NEAR(bench.handle("position").seen.x, before.seen.x + 20, 1e-7);
}

TEST(Handles, AShortcutWithModifiersIsNoAxis) {
    for (const Key held : {Key::control, Key::alt, Key::super}) {
        for (const Key letter : {Key::x, Key::y, Key::z}) {
            SCOPED_TRACE(static_cast<int>(held) * 1000 + static_cast<int>(letter));
            ViewerBench bench(figure());
            bench.state.document.select(0);
            bench.turn();
            const auto before = bench.state.document.scene_value();
            const Handle handle = bench.handle("position");
            bench.move_to(handle.at);
            bench.press();
            bench.move_to({handle.at.x + 53, handle.at.y + 7});
            bench.hold(held);
            bench.hold(letter);
            EXPECT_EQ(bench.mouse.locked_axis(), std::nullopt);
            bench.let(letter);
            bench.let(held);
            bench.move_to({handle.at.x + 54, handle.at.y + 7});
            bench.release();
            bench.turns(2);
            if (held == Key::control && letter == Key::z) {
                EXPECT_EQ(bench.state.document.scene_value(), before);  // the drag is cancelled
                EXPECT_EQ(bench.state.document.undo_name(), "Open");
                EXPECT_EQ(bench.state.document.redo_name(), "");
            } else {
                EXPECT_NEAR(bench.handle("position").seen.x, handle.seen.x + 54, 1e-7);
                EXPECT_NEAR(bench.handle("position").seen.y, handle.seen.y + 7, 1e-7);
            }
        }
    }
}

TEST(Handles, AFieldShowsTheSceneOfTheLabelInTheSameFrame) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.turn();
    const Handle handle = bench.handle("position");
    bench.move_to(handle.at);
    bench.press();
    for (int step = 1; step <= 5; ++step) {
        bench.move_to({handle.at.x + 10 * step, handle.at.y});
        if (step > 1) {
            EXPECT_EQ(bench.scene_of_panels, bench.state.document.scene_value());
        }
    }
    bench.release();
}

TEST(Handles, ATiltedNormalsTipStaysWhereItIsLetGo) {
    for (const double away : {-60.0, 45.0, 120.0}) {
        ViewerBench bench(figure());
        bench.state.document.select(2);
        bench.turn();
        for (int again = 0; again < 2; ++again) {
            const Handle before = bench.handle("normal");
            bench.move_to(before.at);
            bench.press();
            bench.move_to({before.at.x + away, before.at.y + 20});
            bench.turn();
            const Handle held = *bench.mouse.grabbed();
            bench.release();
            bench.turns(2);
            const Handle after = bench.handle("normal");
            EXPECT_NEAR(after.at.x, held.at.x, 1e-6);
            EXPECT_NEAR(after.at.y, held.at.y, 1e-6);
        }
    }
}

TEST(Handles, ShiftIsTenTimesFiner) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.turn();
    const Handle before = bench.handle("position");
    bench.move_to(before.at);
    bench.press();
    bench.hold(Key::shift);
    bench.move_to({before.at.x + 50, before.at.y});
    bench.let(Key::shift);
    bench.move_to({before.at.x + 60, before.at.y});
    bench.release();
    EXPECT_NEAR(bench.handle("position").seen.x, before.seen.x + 5 + 10, 1e-7);
}

TEST(Handles, ControlLeadsToRoundNumbers) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.turn();
    const Handle before = bench.handle("position");
    bench.move_to(before.at);
    bench.press();
    bench.key(Key::x);
    bench.hold(Key::control);
    bench.move_to({before.at.x + 61, before.at.y + 7});
    bench.let(Key::control);
    bench.move_to({before.at.x + 61, before.at.y + 7});
    bench.hold(Key::control);
    bench.release();
    bench.let(Key::control);
    const Vec3d position = std::get<PointSkeleton>(bench.element(0).skeleton).position;
    EXPECT_EQ(position.x, std::round(position.x * 10) / 10);
    EXPECT_NE(position.x, 0.5);
    EXPECT_EQ(position.y, 1.25);
}

TEST(Handles, EscapeRestoresTheSceneBitForBit) {
    for (const Grabbed& grabbed : all_handles) {
        SCOPED_TRACE(grabbed.handle);
        ViewerBench bench(figure());
        bench.state.document.select(grabbed.element);
        bench.turn();
        const auto before = bench.state.document.scene_value();
        const Camera camera = bench.state.view.camera;
        const std::string history = bench.state.document.undo_name();
        const Handle handle = bench.handle(grabbed.handle);
        bench.move_to(handle.at);
        bench.press();
        bench.move_to({handle.at.x + 25, handle.at.y + 31});
        EXPECT_NE(bench.state.document.scene_value(), before);
        bench.key(Key::escape);
        EXPECT_EQ(bench.state.document.scene_value(), before);
        EXPECT_FALSE(bench.mouse.dragging_handle());
        // still pressed: nothing more happens until it is let go
        bench.move_to({handle.at.x + 80, handle.at.y + 31});
        bench.release();
        EXPECT_EQ(bench.state.document.scene_value(), before);
        EXPECT_EQ(bench.state.view.camera, camera);
        EXPECT_EQ(bench.state.document.undo_name(), history);
        EXPECT_EQ(bench.state.document.selected(), grabbed.element);
    }
}

TEST(Handles, ADragIsOneEntryOfTheHistory) {
    for (const Grabbed& grabbed : all_handles) {
        SCOPED_TRACE(grabbed.handle);
        ViewerBench bench(figure());
        bench.state.document.select(grabbed.element);
        bench.turn();
        const auto before = bench.state.document.scene_value();
        bench.drag(bench.handle(grabbed.handle).at, 33, 12, 60);
        EXPECT_NE(bench.state.document.scene_value(), before);
        EXPECT_NE(bench.state.document.undo_name(), "Open");
        bench.key(Key::z, {.control = true});
        EXPECT_EQ(bench.state.document.scene_value(), before);
        EXPECT_EQ(bench.state.document.undo_name(), "Open");
    }
}

TEST(Handles, AClickOnOneWithoutAMoveChangesNothing) {
    ViewerBench bench(figure());
    bench.state.document.select(2);
    bench.turn();
    const auto before = bench.state.document.scene_value();
    bench.click(bench.handle("normal").at);
    EXPECT_EQ(bench.state.document.scene_value(), before);
    EXPECT_EQ(bench.state.document.undo_name(), "Open");
    EXPECT_EQ(bench.state.document.selected(), 2u);
}

TEST(Handles, NoTwoOfOneElementHideOneAnother) {
    const std::vector<Skeleton> skeletons = {
        SegmentSkeleton{{0.25, 0.5, 0}, {0.25, 0.5, 0}},            // both ends at one place
        SegmentSkeleton{{0, 0, 0}, {0.02, 0, 0}},                   // far too short
        SegmentSkeleton{{-1, -1, 1}, {1.7, 0.8, 4.2}},              // towards the camera
        CircleSkeleton{{0, 0, 0}, {3, 2, 7}, 1},                    // seen along its normal
        CircleSkeleton{{0, 0, 0}, {0, 1, 0}, 0},                    // no radius
        CircleSkeleton{{1, 0, 0}, {1e-200, 2e-200, 1e-200}, 1e-9},  // hardly anything
        CircleSkeleton{{1, 0, 0}, {1e200, -1e200, 1e190}, 1.5},     // a very long normal
    };
    for (const double scale : {1.0, 2.0}) {
        for (const Skeleton& skeleton : skeletons) {
            Scene scene = figure();
            scene.elements[1].skeleton = skeleton;
            ViewerBench bench(scene, {1280, 720}, scale);
            const std::vector<Handle> handles = handles_of(bench.state, 1);
            ASSERT_EQ(handles.size(), 3u);
            for (std::size_t i = 0; i < handles.size(); ++i) {
                EXPECT_TRUE(bench.state.viewport.contains(handles[i].at));
                for (std::size_t k = 0; k < i; ++k)
                    EXPECT_GE(std::hypot(handles[i].at.x - handles[k].at.x,
                                         handles[i].at.y - handles[k].at.y),
                              2 * grab_radius * scale);
            }
            // and each of them can be grabbed where it stands
            bench.state.document.select(1);
            for (const Handle& handle : handles) {
                bench.move_to(handle.at);
                ASSERT_TRUE(bench.mouse.hovered());
                EXPECT_EQ(bench.mouse.hovered()->name, handle.name);
            }
        }
    }
}

TEST(Handles, WhatWasMovedAsideFollowsThePointerToo) {
    Scene scene = figure();
    scene.elements[1].skeleton = SegmentSkeleton{{0.25, 0.5, 0}, {0.25, 0.5, 0}};
    ViewerBench bench(scene);
    bench.state.document.select(1);
    bench.turn();
    const Handle before = bench.handle("b");
    bench.drag(before.at, 60, 0);
    const Handle after = bench.handle("b");
    EXPECT_NEAR(after.seen.x - before.seen.x, 60, 1e-7);
    EXPECT_EQ(std::get<SegmentSkeleton>(bench.element(1).skeleton).a, (Vec3d{0.25, 0.5, 0}));
}

TEST(Handles, WithTheViewScaledTheyAreAsLargeToTheHand) {
    ViewerBench bench(figure(), {2560, 1440}, 2);
    bench.state.document.select(0);
    bench.turn();
    const Handle handle = bench.handle("position");
    bench.move_to({handle.at.x + 2 * grab_radius - 1, handle.at.y});
    EXPECT_TRUE(bench.mouse.hovered());
    bench.drag(handle.at, 74, -42);
    EXPECT_NEAR(bench.handle("position").seen.x, handle.seen.x + 74, 1e-7);
}

TEST_P(InEachProjection, AClickSelectsWhatContributesMost) {
    ViewerBench bench(figure());
    const Projection view = bench.state.projection();
    const auto window = [&](Vec3d place) {
        const WindowPoint seen = view.project(place).value();
        return WindowPoint{seen.x + bench.state.viewport.x, seen.y + bench.state.viewport.y};
    };
    bench.click(window({0.5, 1.35, -0.5}));
    EXPECT_EQ(bench.state.document.selected(), 0u);
    bench.click(window({1.1, -1.1, 0}));
    EXPECT_EQ(bench.state.document.selected(), 1u);
    // beside everything
    bench.click(WindowPoint{bench.state.viewport.x + 5.0, bench.state.viewport.y + 5.0});
    EXPECT_EQ(bench.state.document.selected(), std::nullopt);
}

TEST_P(InEachProjection, AClickBesideTheSurfaceSelectsASkeletonThere) {
    Scene scene = figure();
    scene.threshold = 1e6;  // no surface at all
    ViewerBench bench(scene);
    const Projection view = bench.state.projection();
    const WindowPoint seen = view.project({-0.25, -0.625, 0.125}).value();
    bench.click(
        WindowPoint{seen.x + bench.state.viewport.x + 3, seen.y + bench.state.viewport.y - 3});
    EXPECT_EQ(bench.state.document.selected(), 1u);
}

TEST_P(InEachProjection, TheMouseOrbitsPansAndZooms) {
    ViewerBench bench(figure());
    const Camera before = bench.state.view.camera;
    const auto scene = bench.state.document.scene_value();
    const WindowPoint empty{bench.state.viewport.x + 20.0, bench.state.viewport.y + 20.0};

    bench.drag(empty, 60, 25);
    EXPECT_EQ(bench.state.view.camera.target, before.target);
    EXPECT_NE(bench.state.view.camera.position, before.position);

    const Camera orbited_camera = bench.state.view.camera;
    bench.hold(Key::shift);
    bench.drag(empty, 40, 10);
    bench.let(Key::shift);
    EXPECT_NE(bench.state.view.camera.target, orbited_camera.target);
    const Projection panned_view(orbited_camera, bench.state.viewport.size());
    const Vec3d moved = panned_view.moved(orbited_camera.target, -40, -10);
    EXPECT_NEAR(bench.state.view.camera.target.x, moved.x, 1e-9);

    const Camera shifted = bench.state.view.camera;
    bench.move_to({empty.x + 300, empty.y + 200});
    bench.turn(WheelTurned{0, 1});
    EXPECT_NEAR(seen_height(bench.state.view.camera), 0.88 * seen_height(shifted), 1e-12);
    EXPECT_EQ(bench.state.document.scene_value(), scene);  // the view is not the document
    EXPECT_FALSE(bench.state.view.automatic);
}

TEST_P(InEachProjection, ADoubleClickSetsTheOrbitsCentreOnTheSurface) {
    ViewerBench bench(figure());
    const Projection view = bench.state.projection();
    const WindowPoint seen = view.project({0.5, 1.25, -0.5}).value();
    const WindowPoint at{std::floor(seen.x) + bench.state.viewport.x,
                         std::floor(seen.y) + bench.state.viewport.y};
    bench.move_to(at);
    for (int i = 0; i < 2; ++i) {
        bench.press();
        bench.release();
    }
    // what was under the pointer is in the middle now
    const Vec3d target = bench.state.view.camera.target;
    const WindowPoint was = view.project(target).value();
    EXPECT_NEAR(was.x, std::floor(seen.x) + 0.5, 1e-6);
    EXPECT_NEAR(was.y, std::floor(seen.y) + 0.5, 1e-6);
    EXPECT_NE(target, (Vec3d{0, 0, 0}));
    EXPECT_EQ(bench.state.document.selected(), 0u);  // by its first click
}

// One entry for each gesture, apart from edits.
TEST(Viewport, AMoveOfTheCameraIsUndoneApartFromEdits) {
    ViewerBench bench(figure());
    std::vector<Camera> cameras{bench.state.view.camera};
    const auto note = [&] { cameras.push_back(bench.state.view.camera); };
    const WindowPoint empty{bench.state.viewport.x + 20.0, bench.state.viewport.y + 20.0};
    bench.drag(empty, 60, 25);
    note();
    bench.hold(Key::shift);
    bench.drag(empty, 40, 10);
    bench.let(Key::shift);
    note();
    for (int step = 0; step < 3; ++step) bench.turn(WheelTurned{0, 1});
    bench.turns(60);  // the hand rests
    note();
    bench.turn(WheelTurned{0, -1});
    note();
    bench.key(Key::digit5);
    note();
    bench.key(Key::digit3);
    note();
    bench.state.document.select(0);
    bench.turn();
    bench.drag(bench.handle("position").at, 12, 9);
    const Scene edited = bench.scene();

    const Modifiers alt{.alt = true};
    for (std::size_t i = cameras.size(); i-- > 1;) {
        EXPECT_EQ(bench.state.view.camera, cameras[i]) << i;
        bench.key(Key::left, alt);
    }
    EXPECT_EQ(bench.state.view.camera, cameras[0]);
    EXPECT_FALSE(bench.state.view.can_undo());
    EXPECT_EQ(bench.scene(), edited);
    for (const Camera& camera : cameras) {
        EXPECT_EQ(bench.state.view.camera, camera);
        bench.key(Key::right, alt);
    }
    bench.key(Key::z, {.control = true});
    EXPECT_NE(bench.scene(), edited);
    EXPECT_EQ(bench.state.view.camera, cameras.back());

    // another move ends what was undone
    bench.key(Key::left, alt);
    EXPECT_TRUE(bench.state.view.can_redo());
    bench.drag(empty, -30, 5);
    EXPECT_FALSE(bench.state.view.can_redo());
}

// The plane of an orthographic camera is moved back when a hand brings the surface to it; what is seen
// stays.
TEST(Viewport, AnOrthographicCamerasPlaneStaysBeforeTheSurface) {
    ViewerBench bench(figure());
    bench.key(Key::digit5);
    bench.state.document.select(0);
    bench.turn();
    const Camera before = bench.state.view.camera;
    const Vec3d back = bench.state.projection().back();
    const auto depth_of = [&](const Camera& camera) {
        return dot(camera.position - camera.target, back);
    };
    Scene scene = bench.scene();
    scene.elements[0].skeleton = PointSkeleton{(depth_of(before) + 3) * back};
    bench.state.document.edit("Move", scene);
    bench.turn();
    const Camera after = bench.state.view.camera;
    EXPECT_GT(depth_of(after), depth_of(before) + 4);
    EXPECT_EQ(after.target, before.target);
    EXPECT_EQ(after.height, before.height);
    EXPECT_TRUE(plane_is_before(after, compile(scene).box));
    const Projection seen_before(before, bench.state.viewport.size());
    for (const Vec3d place : {Vec3d{1, 2, 3}, Vec3d{-1, 0.5, 0}}) {
        EXPECT_NEAR(bench.state.projection().project(place)->x, seen_before.project(place)->x,
                    1e-9);
        EXPECT_NEAR(bench.state.projection().project(place)->y, seen_before.project(place)->y,
                    1e-9);
    }
    // nothing that could be undone: the next is the switch to orthographic
    bench.key(Key::left, {.alt = true});
    EXPECT_EQ(bench.state.view.camera, *figure().camera);
    // and back again it is before the surface as it is now
    bench.key(Key::right, {.alt = true});
    EXPECT_TRUE(plane_is_before(bench.state.view.camera, compile(scene).box));
}

TEST(Viewport, PanelsKeepTheirClicksAndWheel) {
    ViewerBench bench(figure());
    const Camera before = bench.state.view.camera;
    bench.move_to({60, 400});
    bench.turn(WheelTurned{0, 3});
    bench.drag({60, 500}, 300, 20);
    EXPECT_EQ(bench.state.view.camera, before);
}

TEST(Viewport, OpeningAnotherSceneEndsADrag) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.turn();
    const Handle handle = bench.handle("position");
    bench.move_to(handle.at);
    bench.press();
    bench.move_to({handle.at.x + 9, handle.at.y});
    bench.state.document = Document();
    bench.move_to({handle.at.x + 30, handle.at.y});
    EXPECT_FALSE(bench.mouse.dragging_handle());
    bench.release();
    EXPECT_TRUE(bench.scene().elements.empty());
}

}  // namespace
}  // namespace ivory
