#include "app/document/document_view.h"

#include <gtest/gtest.h>

namespace ivory {
namespace {

Camera at(double x) { return {{x, 0, 8}, {0, 0, 0}}; }

TEST(DocumentView, AGestureIsOneMoveHoweverManyStepsItHas) {
    DocumentView view(at(0), at(0));
    for (int step = 1; step <= 100; ++step) view.move_on(at(step));
    EXPECT_TRUE(view.can_undo());
    view.end_move();
    view.move_to(at(200));
    EXPECT_TRUE(view.undo());
    EXPECT_EQ(view.camera, at(100));
    EXPECT_TRUE(view.undo());
    EXPECT_EQ(view.camera, at(0));
    EXPECT_FALSE(view.undo());
    EXPECT_TRUE(view.redo());
    EXPECT_TRUE(view.redo());
    EXPECT_EQ(view.camera, at(200));
    EXPECT_FALSE(view.redo());
}

TEST(DocumentView, AGestureThatEndsWhereItBeganIsNone) {
    DocumentView view(at(0), std::nullopt);
    view.move_to(at(1));
    view.undo();
    view.move_on(at(2));
    view.move_on(at(0));
    view.end_move();
    EXPECT_TRUE(view.automatic);
    EXPECT_FALSE(view.can_undo());
    EXPECT_TRUE(view.can_redo());
}

TEST(DocumentView, CancelledItHasNotHappened) {
    DocumentView view(at(0), std::nullopt);
    view.move_to(at(1));
    view.undo();
    view.move_on(at(2));
    EXPECT_FALSE(view.automatic);
    view.cancel_move();
    EXPECT_EQ(view.camera, at(0));
    EXPECT_TRUE(view.automatic);
    EXPECT_TRUE(view.redo());
    EXPECT_EQ(view.camera, at(1));
}

TEST(DocumentView, AnUndoEndsTheGestureThatRuns) {
    DocumentView view(at(0), at(0));
    view.move_on(at(1));
    EXPECT_NE(view.gesture(), 0u);
    EXPECT_TRUE(view.undo());
    EXPECT_EQ(view.gesture(), 0u);
    EXPECT_EQ(view.camera, at(0));
    view.move_on(at(5));  // the same hand goes on
    view.end_move();
    EXPECT_FALSE(view.can_redo());
    view.undo();
    EXPECT_EQ(view.camera, at(0));
}

TEST(DocumentView, WhatNobodyHasChosenIsNotToBeSaved) {
    DocumentView view(at(0), std::nullopt);
    EXPECT_TRUE(view.is_saved());
    view.move_to(at(1));
    EXPECT_FALSE(view.is_saved());
    view.mark_saved();
    EXPECT_TRUE(view.is_saved());
    view.undo();
    EXPECT_TRUE(view.automatic);
    DocumentView of_file(at(0), at(0));
    EXPECT_TRUE(of_file.is_saved());
    of_file.move_to(at(1));
    EXPECT_FALSE(of_file.is_saved());
    of_file.undo();
    EXPECT_TRUE(of_file.is_saved());
}

TEST(DocumentView, RemembersSoManyMovesAndNoMore) {
    DocumentView view(at(0), at(0));
    for (int step = 1; step <= 1500; ++step) view.move_to(at(step));
    int undone = 0;
    while (view.undo()) ++undone;
    EXPECT_EQ(undone, 1000);
    EXPECT_EQ(view.camera, at(500));
}

}  // namespace
}  // namespace ivory
