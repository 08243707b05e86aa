#include "app/platform/input.h"

#include <algorithm>
#include <bitset>

namespace ivory {

namespace {

constexpr double longest_frame = 0.1;  // seconds

// Keys that come with text of their own, or change nothing in a text field.
bool goes_with_text(Key key) {
    return (key >= Key::a && key <= Key::digit9) || key == Key::space || key >= Key::shift ||
           (key >= Key::minus && key <= Key::slash);
}

// One frame in the making: what has changed in it so far.
struct FrameInProgress {
    Input& input;
    std::bitset<mouse_button_count> buttons_changed;
    std::bitset<key_count> keys_changed;
    bool key_pressed = false;          // one that is no modifier
    bool editing_key_pressed = false;  // one that text must not overtake

    // Each `take` is false, and does nothing, where the event has to wait for the next frame.
    bool take(const MouseMoved& event) {
        if (buttons_changed.any()) return false;
        input.mouse = event.at;
        input.mouse_inside = true;
        return true;
    }
    bool take(const MouseLeft&) {
        if (buttons_changed.any()) return false;
        input.mouse_inside = false;
        return true;
    }
    bool take(const MouseButtonChanged& event) {
        const auto button = static_cast<std::size_t>(event.button);
        if (buttons_changed[button] || input.wheel != 0 || input.wheel_x != 0) return false;
        buttons_changed.set(button);
        input.mouse_down[button] = event.down;
        return true;
    }
    bool take(const WheelTurned& event) {
        if (buttons_changed.any()) return false;
        input.wheel_x += event.x;
        input.wheel += event.y;
        return true;
    }
    bool take(const KeyChanged& event) {
        const auto key = static_cast<std::size_t>(event.key);
        if (keys_changed[key] || buttons_changed.any()) return false;
        // ImGui sees the modifiers as they are at the frame's end: those of its keys
        if (event.key >= Key::shift && key_pressed) return false;
        keys_changed.set(key);
        input.key_down[key] = event.down;
        const auto held = [&](Key k) { return input.key_down[static_cast<std::size_t>(k)]; };
        input.modifiers = {held(Key::shift), held(Key::control), held(Key::alt), held(Key::super)};
        if (event.down) {
            input.pressed.push_back({event.key, input.modifiers, event.repeated});
            key_pressed = key_pressed || event.key < Key::shift;
            const Modifiers& with = input.modifiers;
            const bool shortcut = with.control || with.alt || with.super;
            editing_key_pressed = editing_key_pressed || !goes_with_text(event.key) ||
                                  (shortcut && event.key < Key::shift);
        }
        return true;
    }
    bool take(const TextTyped& event) {
        if (editing_key_pressed || buttons_changed.any()) return false;
        // a shortcut's letter is no text; Ctrl+Alt is how some systems report AltGr
        const Modifiers& held = input.modifiers;
        if (held.super || (held.control && !held.alt)) return true;
        input.text += event.character;
        return true;
    }
    bool take(const FilesDropped& event) {
        input.dropped.insert(input.dropped.end(), event.files.begin(), event.files.end());
        return true;
    }
    bool take(const Resized& event) {
        input.size = event.size;
        return true;
    }
    bool take(const Rescaled& event) {
        input.scale = event.scale;
        return true;
    }
    bool take(const ThemeChanged& event) {
        input.theme = event.theme;
        return true;
    }
    bool take(const CloseRequested&) {
        input.close_requested = true;
        return true;
    }
};

}  // namespace

EventQueue::EventQueue(WindowSize size, double scale) {
    frame_.size = size;
    frame_.scale = scale;
}

Input EventQueue::next_frame(double seconds) {
    frame_.elapsed = seconds;
    frame_.seconds = std::clamp(seconds, 1e-4, longest_frame);
    frame_.wheel = frame_.wheel_x = 0;
    frame_.pressed.clear();
    frame_.text.clear();
    frame_.dropped.clear();
    frame_.theme.reset();
    frame_.close_requested = false;

    FrameInProgress frame{frame_, {}, {}};
    while (!events_.empty() &&
           std::visit([&](const auto& event) { return frame.take(event); }, events_.front()))
        events_.pop_front();
    return frame_;
}

}  // namespace ivory
