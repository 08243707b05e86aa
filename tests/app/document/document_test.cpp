#include "app/document/document.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/scene/scene_json.h"
#include "tests/error_line.h"
#include "tests/temporary_folder.h"

namespace ivory {
namespace {

Scene scene_of(int points) {
    Scene scene;
    for (int i = 0; i < points; ++i) {
        Element element;
        element.skeleton = PointSkeleton{{0.1 * i, 0, 0}};
        scene.elements.push_back(element);
    }
    return scene;
}

Scene with_threshold(Scene scene, double threshold) {
    scene.threshold = threshold;
    return scene;
}

Document document_of(int points) {
    Document document;
    document.edit("Open", scene_of(points));
    return document;
}

TEST(Document, BeginsEmptyCleanAndWithoutAHistory) {
    Document document;
    EXPECT_TRUE(document.scene().elements.empty());
    EXPECT_FALSE(document.dirty());
    EXPECT_FALSE(document.path());
    EXPECT_EQ(document.undo_name(), "");
    EXPECT_EQ(document.redo_name(), "");
    EXPECT_FALSE(document.undo());
    EXPECT_FALSE(document.redo());
}

TEST(Document, UndoBringsBackTheVerySameValue) {
    Document document = document_of(3);
    const auto before = document.scene_value();
    document.edit("Change threshold", with_threshold(document.scene(), 0.7));
    const auto after = document.scene_value();
    EXPECT_EQ(document.undo_name(), "Change threshold");
    ASSERT_TRUE(document.undo());
    EXPECT_EQ(document.scene_value(), before);  // the pointer, hence every bit
    EXPECT_EQ(document.redo_name(), "Change threshold");
    ASSERT_TRUE(document.redo());
    EXPECT_EQ(document.scene_value(), after);
}

TEST(Document, AnEditThatChangesNothingIsNoEntry) {
    Document document = document_of(2);
    const auto before = document.scene_value();
    document.edit("Nothing", document.scene());
    EXPECT_EQ(document.undo_name(), "Open");
    EXPECT_EQ(document.scene_value(), before);
}

TEST(Document, AnEditForgetsWhatWasUndone) {
    Document document = document_of(1);
    document.edit("A", with_threshold(document.scene(), 0.6));
    document.undo();
    document.edit("B", with_threshold(document.scene(), 0.7));
    EXPECT_FALSE(document.redo());
    EXPECT_EQ(document.undo_name(), "B");
}

TEST(Document, ADragIsOneEntry) {
    Document document = document_of(1);
    const auto before = document.scene_value();
    document.begin_drag("Drag");
    for (int i = 1; i <= 60; ++i) {
        document.drag_to(with_threshold(document.scene(), 0.5 + 0.001 * i));
        EXPECT_TRUE(document.dragging());
    }
    document.end_drag();
    EXPECT_FALSE(document.dragging());
    EXPECT_EQ(document.scene().threshold, 0.5 + 0.001 * 60);
    EXPECT_EQ(document.undo_name(), "Drag");
    document.undo();
    EXPECT_EQ(document.scene_value(), before);
    EXPECT_EQ(document.undo_name(), "Open");
}

TEST(Document, ACancelledDragLeavesNoTrace) {
    Document document = document_of(1);
    const auto before = document.scene_value();
    document.begin_drag("Drag");
    document.drag_to(with_threshold(document.scene(), 0.9));
    EXPECT_NE(document.scene_value(), before);
    document.cancel_drag();
    EXPECT_EQ(document.scene_value(), before);
    EXPECT_EQ(document.undo_name(), "Open");
    EXPECT_EQ(document.redo_name(), "");
}

TEST(Document, ADragThatEndsWhereItBeganIsNoEntry) {
    Document document = document_of(1);
    const auto before = document.scene_value();
    document.begin_drag("Drag");
    document.drag_to(with_threshold(document.scene(), 0.9));
    document.drag_to(*before);
    document.end_drag();
    EXPECT_EQ(document.scene_value(), before);
    EXPECT_EQ(document.undo_name(), "Open");
}

TEST(Document, AnEditOrUndoCommitsARunningDrag) {
    Document document = document_of(1);
    document.begin_drag("Drag");
    document.drag_to(with_threshold(document.scene(), 0.9));
    document.edit("Edit", with_threshold(document.scene(), 0.1));
    EXPECT_FALSE(document.dragging());
    document.undo();
    EXPECT_EQ(document.scene().threshold, 0.9);
    EXPECT_EQ(document.undo_name(), "Drag");

    document.begin_drag("Second");
    document.drag_to(with_threshold(document.scene(), 0.8));
    document.undo();
    EXPECT_EQ(document.scene().threshold, 0.9);
    EXPECT_EQ(document.redo_name(), "Second");
}

TEST(Document, TheSelectionComesBackWithTheScene) {
    Document document = document_of(3);
    document.select(2);
    Scene shorter = document.scene();
    shorter.elements.pop_back();
    document.edit("Delete", shorter, std::nullopt);
    EXPECT_EQ(document.selected(), std::nullopt);
    document.select(0);
    document.undo();
    EXPECT_EQ(document.selected(), 2u);
    document.redo();
    EXPECT_EQ(document.selected(), 0u);
}

TEST(Document, ASelectionIsAlwaysAnElementThatIsThere) {
    Document document = document_of(2);
    document.select(7);
    EXPECT_EQ(document.selected(), std::nullopt);
    document.select(1);
    document.edit("Shorter", scene_of(1));
    EXPECT_EQ(document.selected(), std::nullopt);
}

TEST(Document, IsDirtyWhereTheSceneDiffersFromTheFile) {
    tests::TemporaryFolder folder;
    const auto path = folder / "scene.ivory.json";
    save_scene(scene_of(2), path);
    Document document = Document::open(path);
    EXPECT_EQ(document.path(), path);
    EXPECT_FALSE(document.dirty());
    EXPECT_EQ(document.undo_name(), "");

    document.edit("Change", with_threshold(document.scene(), 0.7));
    EXPECT_TRUE(document.dirty());
    document.undo();
    EXPECT_FALSE(document.dirty());
    document.redo();
    document.mark_saved(folder / "other.ivory.json", "");
    EXPECT_FALSE(document.dirty());
    EXPECT_EQ(document.path(), folder / "other.ivory.json");
    document.undo();
    EXPECT_TRUE(document.dirty());
    // typed back by hand: equal, though another value
    document.edit("Change", with_threshold(document.scene(), 0.7));
    EXPECT_FALSE(document.dirty());
}

TEST(Document, ABrokenFileIsOneLine) {
    tests::TemporaryFolder folder;
    const auto path = folder / "broken.ivory.json";
    std::ofstream(path) << "{\"ivory\": 1,";
    const std::string line = tests::error_line([&] { (void)Document::open(path); });
    EXPECT_NE(line.find("broken.ivory.json"), std::string::npos) << line;
}

TEST(Document, AVeryLongHistoryForgetsItsBeginningButKeepsTheLastSteps) {
    Document document;
    const Scene large = scene_of(50'000);
    for (int i = 1; i <= 100; ++i) document.edit("Step", with_threshold(large, 0.001 * i));
    int undone = 0;
    while (document.undo()) ++undone;
    EXPECT_GE(undone, 30);
    EXPECT_LT(undone, 100);
    for (int i = 0; i < undone; ++i) EXPECT_TRUE(document.redo());
    EXPECT_EQ(document.scene().threshold, 0.001 * 100);
}

}  // namespace
}  // namespace ivory
