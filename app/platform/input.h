// What a person did since the last frame, wherever it comes from: a GLFW window or a headless script.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/platform/window_rect.h"

namespace ivory {

enum class MouseButton : std::uint8_t { left, right, middle };
inline constexpr std::size_t mouse_button_count = 3;

// Keys that the viewer knows. Letters and digits are those of the keyboard layout, not of the key's
// place; the keypad's digits are the same keys. Other characters, `?` among them, come as text.
enum class Key : std::uint8_t {
    none,
    // clang-format off
    a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z,
    digit0, digit1, digit2, digit3, digit4, digit5, digit6, digit7, digit8, digit9,
    f1, f2, f3, f4, f5, f6, f7, f8, f9, f10, f11, f12,
    // clang-format on
    escape,
    enter,
    tab,
    backspace,
    insert,
    del,
    space,
    left,
    right,
    up,
    down,
    home,
    end,
    page_up,
    page_down,
    minus,
    equal,
    comma,
    period,
    slash,
    keypad_enter,
    shift,
    control,
    alt,
    super,
};
inline constexpr std::size_t key_count = static_cast<std::size_t>(Key::super) + 1;

enum class Theme : std::uint8_t { dark, light };

struct Modifiers {
    bool shift = false, control = false, alt = false, super = false;
    friend bool operator==(const Modifiers&, const Modifiers&) = default;
};

struct KeyPress {
    Key key = Key::none;
    Modifiers modifiers;
    bool repeated = false;  // by the keyboard, the key being held
};

// One frame's input: what is held now, and what has happened since the frame before. A button or key
// changes at most once in a frame (EventQueue sees to it), so that no click is lost.
struct Input {
    double elapsed = 1.0 / 60;  // seconds since the frame before
    double seconds = 1.0 / 60;  // the same, > 0 and never long: animations go on after a sleep
    WindowSize size;            // of the frame buffer; 0 x 0 while minimised
    double scale = 1;           // HiDPI: everything drawn is this many times as large

    WindowPoint mouse;
    bool mouse_inside = false;  // the pointer is over the window, or dragging from it
    std::array<bool, mouse_button_count> mouse_down{};
    double wheel = 0;    // steps of the wheel, > 0 away from the user
    double wheel_x = 0;  // > 0 to the left

    Modifiers modifiers;
    std::array<bool, key_count> key_down{};
    std::vector<KeyPress> pressed;     // keys that went down, or repeat
    std::u32string text;               // typed characters
    std::vector<std::string> dropped;  // files dropped on the window
    std::optional<Theme> theme;        // the window system has changed to it
    bool close_requested = false;      // the window's close button

    [[nodiscard]] bool down(MouseButton button) const {
        return mouse_down[static_cast<std::size_t>(button)];
    }
};

struct MouseMoved {
    WindowPoint at;
};
struct MouseLeft {};
struct MouseButtonChanged {
    MouseButton button;
    bool down;
};
struct WheelTurned {
    double x, y;
};
struct KeyChanged {
    Key key;
    bool down;
    bool repeated;
};
struct TextTyped {
    char32_t character;
};
struct FilesDropped {
    std::vector<std::string> files;
};
struct Resized {
    WindowSize size;
};
struct Rescaled {
    double scale;
};
struct ThemeChanged {
    Theme theme;
};
struct CloseRequested {};
using Event =
    std::variant<MouseMoved, MouseLeft, MouseButtonChanged, WheelTurned, KeyChanged, TextTyped,
                 FilesDropped, Resized, Rescaled, ThemeChanged, CloseRequested>;

// Turns the stream of events into frames. Dear ImGui 1.86 samples state once a frame: a press and its
// release in one frame would be no click, and text is taken before keys. So a frame ends before an
// event that would hide an earlier one or overtake it; moves merge, and so does everything else.
class EventQueue {
  public:
    explicit EventQueue(WindowSize size, double scale = 1);

    // An Event, or what may be one.
    template <class SomeEvent>
    void push(SomeEvent&& event) {
        events_.emplace_back(std::forward<SomeEvent>(event));
    }
    // Nothing waits.
    [[nodiscard]] bool empty() const { return events_.empty(); }
    // The next frame's input, `seconds` after the last one; with nothing waiting, what is held and
    // nothing that happened.
    [[nodiscard]] Input next_frame(double seconds);
    // The last frame's input.
    [[nodiscard]] const Input& last_frame() const { return frame_; }

  private:
    std::deque<Event> events_;
    Input frame_;
};

}  // namespace ivory
