// What menus, buttons and keys do: one table for all three, so that each says the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "app/document/elements.h"
#include "app/panels/viewer_state.h"
#include "app/platform/input.h"

namespace ivory {

enum class Action : std::uint8_t {
    start_anew,
    open,
    save,
    save_as,
    screenshot,
    quit,
    undo,
    redo,
    remove,
    duplicate,
    hide,
    frame_all,
    focus,
    front,
    back,
    right,
    left,
    top,
    bottom,
    orthographic,
    undo_move,
    redo_move,
    copy_camera,
    paste_camera,
    keep_view,
    skeleton,
    theme,
    panels,
    help,
};

struct Shortcut {
    Key key = Key::none;
    Modifiers modifiers;
};

struct ActionInfo {
    Action action;
    const char* id;     // of its menu entry
    const char* label;  // there
    const char* keys;   // as written there, "Ctrl+Shift+Z"; empty: none
    Shortcut shortcut;  // key none: it comes as text ('?'), or there is none
    bool ends_with_separator = false;
};

// In the order of the menus.
[[nodiscard]] std::span<const ActionInfo> all_actions();
[[nodiscard]] const ActionInfo& info(Action action);

[[nodiscard]] bool is_possible(const ViewerState& state, Action action);
// Of those that switch something: whether it is on.
[[nodiscard]] bool is_on(const ViewerState& state, Action action);
// The label with what it is about: "Undo Move point 1".
[[nodiscard]] std::string label_of(const ViewerState& state, Action action);

// Nothing where it is not possible.
void run(ViewerState& state, Action action);

// In the current folder, called after the scene's file and a number; nothing has that name yet.
[[nodiscard]] std::filesystem::path free_screenshot_path(const ViewerState& state);

// A new element where the orbit has its centre, selected.
void add_element(ViewerState& state, Shape shape);
// The element goes to that place of the list; selected or not it stays so.
void move_element(ViewerState& state, std::size_t element, std::size_t to);
void set_visible(ViewerState& state, std::size_t element, bool visible);

}  // namespace ivory
