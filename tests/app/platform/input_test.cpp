// Events become frames so that nothing is lost or overtaken.
#include "app/platform/input.h"

#include <gtest/gtest.h>

namespace ivory {
namespace {

constexpr double a_frame = 1.0 / 60;

EventQueue queue_of(std::initializer_list<Event> events) {
    EventQueue queue({800, 600});
    for (const Event& event : events) queue.push(event);
    return queue;
}

TEST(EventQueue, WithoutEventsAFrameHoldsWhatIsHeld) {
    EventQueue queue = queue_of({MouseMoved{{3, 4}}, MouseButtonChanged{MouseButton::left, true}});
    static_cast<void>(queue.next_frame(a_frame));
    const Input input = queue.next_frame(0.05);
    EXPECT_EQ(input.seconds, 0.05);
    EXPECT_EQ(input.elapsed, 0.05);
    EXPECT_EQ(input.mouse, (WindowPoint{3, 4}));
    EXPECT_TRUE(input.mouse_inside);
    EXPECT_TRUE(input.down(MouseButton::left));
    EXPECT_TRUE(input.pressed.empty());
}

TEST(EventQueue, MovesAndWheelStepsMerge) {
    EventQueue queue =
        queue_of({MouseMoved{{1, 1}}, MouseMoved{{2, 2}}, WheelTurned{0, 1}, WheelTurned{0, 2}});
    const Input input = queue.next_frame(a_frame);
    EXPECT_EQ(input.mouse, (WindowPoint{2, 2}));
    EXPECT_EQ(input.wheel, 3);
    EXPECT_TRUE(queue.empty());
    EXPECT_EQ(queue.next_frame(a_frame).wheel, 0);
}

TEST(EventQueue, PressAndReleaseFallIntoTwoFrames) {
    EventQueue queue = queue_of({MouseButtonChanged{MouseButton::left, true},
                                 MouseButtonChanged{MouseButton::left, false}});
    EXPECT_TRUE(queue.next_frame(a_frame).down(MouseButton::left));
    EXPECT_FALSE(queue.empty());
    EXPECT_FALSE(queue.next_frame(a_frame).down(MouseButton::left));
    EXPECT_TRUE(queue.empty());
}

TEST(EventQueue, AMoveAfterAPressWaits) {
    EventQueue queue = queue_of(
        {MouseMoved{{1, 1}}, MouseButtonChanged{MouseButton::left, true}, MouseMoved{{9, 9}}});
    EXPECT_EQ(queue.next_frame(a_frame).mouse, (WindowPoint{1, 1}));
    EXPECT_EQ(queue.next_frame(a_frame).mouse, (WindowPoint{9, 9}));
}

TEST(EventQueue, AKeyCarriesTheModifiersOfItsMoment) {
    EventQueue queue =
        queue_of({KeyChanged{Key::control, true, false}, KeyChanged{Key::z, true, false},
                  KeyChanged{Key::control, false, false}});
    const Input input = queue.next_frame(a_frame);
    ASSERT_EQ(input.pressed.size(), 2u);
    EXPECT_EQ(input.pressed[1].key, Key::z);
    EXPECT_TRUE(input.pressed[1].modifiers.control);
    const Input later = queue.next_frame(a_frame);
    EXPECT_FALSE(later.modifiers.control);
    EXPECT_TRUE(later.pressed.empty());
}

TEST(EventQueue, TextIsNotTakenBeforeTheKeyThatCameFirst) {
    // ImGui reads text first: Backspace, then "x" in one frame would delete the x
    EventQueue queue = queue_of({KeyChanged{Key::backspace, true, false}, TextTyped{U'x'}});
    EXPECT_TRUE(queue.next_frame(a_frame).text.empty());
    EXPECT_EQ(queue.next_frame(a_frame).text, U"x");
}

TEST(EventQueue, ALettersTextComesWithItsKey) {
    EventQueue queue = queue_of({KeyChanged{Key::a, true, false}, TextTyped{U'a'},
                                 KeyChanged{Key::b, true, false}, TextTyped{U'b'}});
    EXPECT_EQ(queue.next_frame(a_frame).text, U"ab");
    EXPECT_TRUE(queue.empty());
}

TEST(EventQueue, AfterASleepTheClockIsRightAndAnimationsDoNotLeap) {
    EventQueue queue = queue_of({});
    const Input input = queue.next_frame(4);
    EXPECT_EQ(input.elapsed, 4);
    EXPECT_EQ(input.seconds, 0.1);
}

TEST(EventQueue, AQuickShortcutKeepsItsModifierAndIsNotOvertakenByText) {
    EventQueue queue =
        queue_of({KeyChanged{Key::control, true, false}, KeyChanged{Key::a, true, false},
                  KeyChanged{Key::control, false, false}, KeyChanged{Key::a, false, false},
                  TextTyped{U'1'}});
    const Input first = queue.next_frame(a_frame);
    ASSERT_EQ(first.pressed.size(), 2u);
    EXPECT_EQ(first.pressed.back().key, Key::a);
    EXPECT_TRUE(first.modifiers.control);  // as ImGui sees it together with the key
    EXPECT_TRUE(first.key_down[static_cast<std::size_t>(Key::a)]);
    EXPECT_TRUE(first.text.empty());
    const Input second = queue.next_frame(a_frame);
    EXPECT_FALSE(second.modifiers.control);
    EXPECT_EQ(second.text, U"1");
    EXPECT_TRUE(queue.empty());
}

TEST(EventQueue, AModifierAfterAKeyIsNotTakenForItsOwn) {
    EventQueue queue =
        queue_of({KeyChanged{Key::z, true, false}, KeyChanged{Key::control, true, false}});
    EXPECT_FALSE(queue.next_frame(a_frame).modifiers.control);
    EXPECT_TRUE(queue.next_frame(a_frame).modifiers.control);
}

TEST(EventQueue, AShortcutsLetterIsNoText) {
    for (const Key key : {Key::control, Key::super}) {
        EventQueue queue = queue_of({KeyChanged{key, true, false}, TextTyped{U'v'}});
        EXPECT_TRUE(queue.next_frame(a_frame).text.empty());
        EXPECT_TRUE(queue.empty());
    }
    EventQueue queue = queue_of({KeyChanged{Key::control, true, false},
                                 KeyChanged{Key::alt, true, false}, TextTyped{U'@'}});
    EXPECT_EQ(queue.next_frame(a_frame).text, U"@");  // AltGr
}

TEST(EventQueue, WhatTheWindowSystemSaysArrivesOnce) {
    EventQueue queue = queue_of({Resized{{300, 200}}, Rescaled{2}, FilesDropped{{"a", "b"}},
                                 ThemeChanged{Theme::light}, CloseRequested{}});
    const Input input = queue.next_frame(a_frame);
    EXPECT_EQ(input.size, (WindowSize{300, 200}));
    EXPECT_EQ(input.scale, 2);
    EXPECT_EQ(input.dropped, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(input.theme, Theme::light);
    EXPECT_TRUE(input.close_requested);
    const Input later = queue.next_frame(a_frame);
    EXPECT_EQ(later.size, (WindowSize{300, 200}));
    EXPECT_EQ(later.scale, 2);
    EXPECT_TRUE(later.dropped.empty());
    EXPECT_FALSE(later.theme.has_value());
    EXPECT_FALSE(later.close_requested);
}

}  // namespace
}  // namespace ivory
