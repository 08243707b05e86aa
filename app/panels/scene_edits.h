// How a control changes the scene: at once, or while it is dragged; through the document, and either
// way as one entry of its history.
#pragma once

#include <functional>
#include <string>

#include "app/panels/viewer_state.h"

namespace ivory {

// Changes a copy of the scene and makes it an entry of the history, unless it has a fault: then
// that is the message.
void edit_scene(ViewerState& state, const std::string& what,
                const std::function<void(Scene&)>& change);

// A drag of a control begins, goes on or is left.
void begin_field_drag(ViewerState& state, const std::string& id, const std::string& what);
void drag_field(ViewerState& state, const std::function<void(Scene&)>& change);
void end_field_drag(ViewerState& state);
// At the end of the panels: a control that vanished while it was dragged or typed into leaves
// nothing behind; Escape ends a drag as if it had never begun.
void end_lost_edits(ViewerState& state);

// One of ImGui's keys (ImGuiKey_Enter) went down in this frame, and no modifier is held with it.
[[nodiscard]] bool plain_key_pressed(int imgui_key);

}  // namespace ivory
