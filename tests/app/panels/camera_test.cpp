// The camera's panel, its clipboard and the views that a scene keeps.
#include <gtest/gtest.h>
#include <imgui.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/field/field.h"
#include "core/scene/scene_fault.h"
#include "core/scene/scene_json.h"
#include "core/scene/text.h"
#include "tests/app/panels/viewer_bench.h"
#include "tests/temporary_folder.h"

namespace ivory {
namespace {

using tests::ViewerBench;

Scene figure() {
    Scene scene;
    Element point, segment;
    point.skeleton = PointSkeleton{{0.5, 1.25, -0.5}};
    segment.skeleton = SegmentSkeleton{{-1.5, -0.25, 0.25}, {1, -1, 0}};
    scene.elements = {point, segment};
    scene.camera = Camera{{3, 2, 7}, {0, 0, 0}};
    return scene;
}

// High enough for the whole panel.
class CameraPanel : public testing::Test {
  protected:
    ViewerBench bench{figure(), {1280, 1400}};

    [[nodiscard]] const Camera& camera() const { return bench.state.view.camera; }
    [[nodiscard]] const std::vector<SavedView>& views() const { return bench.scene().views; }
    void click_row(const std::string& name) { bench.click("views.row." + name); }
    void keep(const std::string& name) {
        bench.click("views.add");
        bench.type(name);
        bench.key(Key::enter);
        bench.turns(3);
    }
};

TEST_F(CameraPanel, NumbersAreTakenToTheLastBitAndAreMovesNotEdits) {
    const auto scene = bench.state.document.scene_value();
    bench.enter("camera.position.x", "0.1");
    EXPECT_EQ(camera().position, (Vec3d{0.1, 2, 7}));
    bench.enter("camera.target.y", "-1e-17");
    EXPECT_EQ(camera().target, (Vec3d{0, -1e-17, 0}));
    bench.enter("camera.up.z", "0.30000000000000004");
    EXPECT_EQ(camera().up, (Vec3d{0, 1, 0.30000000000000004}));
    bench.enter("camera.fov", "*=2");
    EXPECT_EQ(camera().fov, 80);
    EXPECT_EQ(bench.state.document.scene_value(), scene);
    bench.key(Key::left, {.alt = true});
    EXPECT_EQ(camera().fov, 40);
    bench.click("camera.undo");
    EXPECT_EQ(camera().up, (Vec3d{0, 1, 0}));
    bench.click("camera.redo");
    EXPECT_EQ(camera().up, (Vec3d{0, 1, 0.30000000000000004}));
}

TEST_F(CameraPanel, WhatNoCameraMayBeIsRefusedWithAMessage) {
    struct Case {
        std::string id, text, says;
    };
    for (const Case& wrong :
         {Case{"camera.fov", "180", "less than 180"}, Case{"camera.up.y", "0", "up"},
          Case{"camera.position.x", "1e999", "not a number"}}) {
        const Camera before = camera();
        bench.enter(wrong.id, wrong.text);
        EXPECT_EQ(camera(), before) << wrong.id;
        EXPECT_TRUE(bench.state.message.error);
        EXPECT_NE(bench.state.message.text.find(wrong.says), std::string::npos)
            << bench.state.message.text;
    }
    bench.enter("camera.fov", "30");
    EXPECT_FALSE(bench.state.message.error);
    EXPECT_FALSE(bench.state.view.gesture());
}

TEST_F(CameraPanel, ADragOfANumberIsOneMoveAndEscapeCancelsIt) {
    const Camera before = camera();
    bench.drag(bench.at("camera.position.z"), 50, 0);
    EXPECT_GT(camera().position.z, before.position.z);
    const Camera dragged = camera();
    bench.key(Key::left, {.alt = true});
    EXPECT_EQ(camera(), before);
    bench.key(Key::right, {.alt = true});
    EXPECT_EQ(camera(), dragged);

    bench.state.document.select(0);
    bench.turns(2);
    const WindowPoint at = bench.at("camera.fov");
    bench.move_to(at);
    bench.press();
    bench.move_to({at.x + 20, at.y});
    bench.move_to({at.x + 40, at.y});
    EXPECT_NE(camera().fov, 40);
    bench.key(Key::escape);
    EXPECT_EQ(camera(), dragged);
    bench.move_to({at.x + 60, at.y});
    bench.release();
    EXPECT_EQ(camera(), dragged);
    EXPECT_EQ(bench.state.document.selected(), 0u);
}

TEST_F(CameraPanel, TheNumberThatAProjectionDoesNotUseIsGreyed) {
    EXPECT_TRUE(bench.state.widgets.find("camera.fov")->enabled);
    EXPECT_FALSE(bench.state.widgets.find("camera.height")->enabled);
    bench.click("camera.projection.orthographic");
    EXPECT_EQ(camera().projection, Camera::Projection::orthographic);
    EXPECT_FALSE(bench.state.widgets.find("camera.fov")->enabled);
    EXPECT_TRUE(bench.state.widgets.find("camera.height")->enabled);
    bench.enter("camera.height", "2.5");
    EXPECT_EQ(camera().height, 2.5);
    bench.enter("camera.height", "-1");
    EXPECT_EQ(camera().height, 2.5);
    EXPECT_NE(bench.state.message.text.find("height"), std::string::npos);
    bench.click("camera.projection.perspective");
    EXPECT_NEAR(seen_height(camera()), 2.5, 1e-12);
    bench.key(Key::digit5);
    EXPECT_EQ(camera().projection, Camera::Projection::orthographic);
}

// A camera that was written down is what it says: a section too, until a hand moves it.
TEST_F(CameraPanel, ATypedPlaneMayCutTheSurface) {
    bench.key(Key::digit3);
    bench.key(Key::digit5);
    bench.enter("camera.position.x", "0.25");
    EXPECT_EQ(camera().position.x, 0.25);
    const Box3 box = compile(bench.scene()).box;
    EXPECT_FALSE(plane_is_before(camera(), box));
    bench.turns(5);
    EXPECT_EQ(camera().position.x, 0.25);
    bench.drag(WindowPoint{bench.state.viewport.x + 20.0, bench.state.viewport.y + 20.0}, 30, 0);
    EXPECT_TRUE(plane_is_before(camera(), box));
    bench.key(Key::left, {.alt = true});
    EXPECT_EQ(camera().position.x, 0.25);
}

TEST_F(CameraPanel, AnOrthographicCameraWithoutAHeightKeepsWhatItSeesWhenItIsMoved) {
    Camera flat = camera();
    flat.projection = Camera::Projection::orthographic;
    bench.state.view = {flat, flat};
    bench.turn();
    const double height = seen_height(flat);
    bench.enter("camera.position.z", "20");
    EXPECT_EQ(camera().height, height);
}

TEST_F(CameraPanel, HomeAndFocusFrameInBothProjections) {
    bench.key(Key::digit5);
    bench.state.document.select(1);
    bench.key(Key::f);
    EXPECT_EQ(camera().projection, Camera::Projection::orthographic);
    EXPECT_EQ(camera().target, (Vec3d{-0.25, -0.625, 0.125}));
    const double focused = seen_height(camera());
    EXPECT_TRUE(plane_is_before(camera(), compile(bench.scene()).box));
    bench.key(Key::home);
    EXPECT_NE(seen_height(camera()), focused);
    EXPECT_TRUE(plane_is_before(camera(), compile(bench.scene()).box));
    EXPECT_FALSE(find_fault(camera()));
}

TEST_F(CameraPanel, TheClipboardBringsTheCameraBackBitForBit) {
    bench.enter("camera.position.x", "0.1");
    bench.key(Key::digit5);
    const Camera copied = camera();
    bench.key(Key::c, {.shift = true, .control = true});
    EXPECT_EQ(parse_camera(ImGui::GetClipboardText(), "it"), copied);
    bench.key(Key::home);
    bench.click("camera.paste");
    EXPECT_EQ(camera(), copied);
    bench.key(Key::left, {.alt = true});
    EXPECT_NE(camera(), copied);
    bench.click("camera.copy");
    EXPECT_EQ(parse_camera(ImGui::GetClipboardText(), "it"), camera());
}

TEST_F(CameraPanel, AClipboardWithoutACameraIsRefused) {
    const Camera before = camera();
    for (const char* text :
         {"", "hello", "[1, 2, 3]", R"({"position": [0, 0, 1]})",
          R"({"position": [0, 0, 1], "target": [0, 0, 1]})",
          R"({"position": [0, 0, 1], "target": [0, 0, 0], "fov": 200})",
          R"({"position": [0, 0, 1], "target": [0, 0, 0], "zoom": 2})",
          R"({"position": [0, 0, 1], "target": [0, 0, 0], "projection": "fisheye"})"}) {
        SCOPED_TRACE(text);
        bench.state.message = {};
        ImGui::SetClipboardText(text);
        bench.key(Key::v, {.shift = true, .control = true});
        EXPECT_EQ(camera(), before);
        EXPECT_TRUE(bench.state.message.error);
        const std::string& said = bench.state.message.text;
        EXPECT_TRUE(said.starts_with("the clipboard holds no camera: ")) << said;
        EXPECT_NE(said.find(R"(a camera is {"position": [0, 0, 8], "target": [0, 0, 0]})"),
                  std::string::npos)
            << said;
        EXPECT_EQ(said.find('\n'), std::string::npos);
    }
    EXPECT_FALSE(bench.state.view.can_undo());
}

TEST_F(CameraPanel, ViewsAreKeptChosenRenamedReplacedAndDeleted) {
    const Camera first = camera();
    keep("Before");
    ASSERT_EQ(views().size(), 1u);
    EXPECT_EQ(views()[0], (SavedView{"Before", first}));
    bench.key(Key::digit3);
    bench.click("views.add");
    bench.key(Key::enter);
    ASSERT_EQ(views().size(), 2u);
    EXPECT_EQ(views()[1].name, "View 2");
    const Camera second = camera();
    EXPECT_NE(first, second);

    click_row("Before");
    EXPECT_EQ(camera(), first);
    EXPECT_FALSE(bench.state.widgets.find("views.replace")->enabled);
    bench.key(Key::digit5);
    EXPECT_TRUE(bench.state.widgets.find("views.replace")->enabled);
    bench.click("views.replace");
    EXPECT_EQ(views()[0].camera, camera());
    EXPECT_EQ(views()[0].camera.projection, Camera::Projection::orthographic);

    bench.click("views.name");
    bench.key(Key::a, {.control = true});
    bench.type("View 2");
    bench.key(Key::enter);
    EXPECT_EQ(views()[0].name, "Before");
    EXPECT_TRUE(bench.state.message.error);
    EXPECT_EQ(bench.state.panels.view, "Before");
    bench.click("views.name");
    bench.key(Key::a, {.control = true});
    bench.type("Flat");
    bench.key(Key::enter);
    EXPECT_EQ(views()[0].name, "Flat");
    EXPECT_EQ(bench.state.panels.view, "Flat");

    click_row("View 2");
    EXPECT_EQ(camera(), second);
    bench.click("views.delete");
    ASSERT_EQ(views().size(), 1u);
    EXPECT_EQ(camera(), second);  // the camera stays

    // each of these is an edit, but an Enter that renamed nothing; none of them moves the camera
    for (const char* undone : {"Delete View 2", "Rename Before", "Replace Before", "Keep View 2",
                               "Rename View 1", "Keep View 1"}) {
        EXPECT_EQ(bench.state.document.undo_name(), undone);
        bench.key(Key::z, {.control = true});
        EXPECT_EQ(camera(), second);
    }
    EXPECT_TRUE(views().empty());
}

TEST_F(CameraPanel, SavingKeepsTheViewAndSaysSo) {
    const tests::TemporaryFolder folder;
    const auto file = folder / "figure.ivory.json";
    save_scene(figure(), file);
    open_scene(bench.state, file);
    bench.turns(3);
    EXPECT_TRUE(bench.state.view.is_saved());
    EXPECT_FALSE(bench.state.view.can_undo());
    keep("Whole");
    bench.key(Key::s, {.control = true});
    bench.key(Key::digit5);
    EXPECT_FALSE(bench.state.document.dirty());  // nobody is asked about it
    EXPECT_FALSE(bench.state.view.is_saved());
    bench.key(Key::s, {.control = true});
    EXPECT_TRUE(bench.state.view.is_saved());
    const Scene saved = read_scene(file);
    EXPECT_EQ(saved.camera, camera());
    ASSERT_EQ(saved.views.size(), 1u);
    EXPECT_EQ(saved.views[0], (SavedView{"Whole", *figure().camera}));

    open_scene(bench.state, file);
    bench.turns(3);
    EXPECT_EQ(bench.scene().views, saved.views);
    EXPECT_EQ(camera(), *saved.camera);
    click_row("Whole");
    EXPECT_EQ(camera(), *figure().camera);
    EXPECT_FALSE(bench.state.view.is_saved());
    // back to what the file has
    bench.key(Key::left, {.alt = true});
    EXPECT_TRUE(bench.state.view.is_saved());
}

}  // namespace
}  // namespace ivory
