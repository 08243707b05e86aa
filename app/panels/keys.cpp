#include <imgui.h>

#include <algorithm>

#include "app/panels/actions.h"
#include "app/panels/panels.h"

namespace ivory {

namespace {

constexpr Modifiers plain{};

bool same(const Shortcut& shortcut, const KeyPress& press) {
    return shortcut.key != Key::none && shortcut.key == press.key &&
           shortcut.modifiers == press.modifiers;
}

void press(ViewerState& state, const KeyPress& press) {
    if (press.key == Key::escape && press.modifiers == plain) {
        if (state.help_shown)
            state.help_shown = false;
        else if (state.message.error)
            state.message = {};
        else
            state.document.select(std::nullopt);
        return;
    }
    const Shortcut second_redo{Key::y, {.control = true}};
    if (same(second_redo, press)) {
        run(state, Action::redo);
        return;
    }
    // held down, only a step back or forth goes on
    for (const ActionInfo& action : all_actions()) {
        const bool repeats = action.action == Action::undo || action.action == Action::redo ||
                             action.action == Action::undo_move ||
                             action.action == Action::redo_move;
        if (same(action.shortcut, press) && (repeats || !press.repeated)) run(state, action.action);
    }
}

}  // namespace

void handle_keys(ViewerState& state, const Input& input) {
    // keys belong to a drag, a text field or a dialog first
    if (state.document.dragging() || ImGui::GetIO().WantTextInput || state.panels.number) return;
    if (state.panels.dialog_open() || state.panels.dragged.begun) return;
    // A menu or a colour picker has the plain keys, Escape among them: one can undo and save with it open.
    const bool popup =
        ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    for (const KeyPress& key : input.pressed)
        if (!popup || key.modifiers.control) press(state, key);
    if (popup) return;
    const Modifiers& held = input.modifiers;  // Shift may be how '?' is typed
    if (held.control || held.alt || held.super) return;
    if (input.text.find(U'?') != std::u32string::npos) run(state, Action::help);
}

}  // namespace ivory
