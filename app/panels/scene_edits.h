// How a control changes the scene, or the camera of the view: at once, or while it is dragged, either
// way as one entry of the document's history or one move of the view.
#pragma once

#include <functional>
#include <string>

#include "app/panels/viewer_state.h"

namespace ivory {

// Changes a copy of the scene and makes it an entry of the history, unless it has a fault: then
// that is the message.
void edit_scene(ViewerState& state, const std::string& what,
                const std::function<void(Scene&)>& change);

// The same with the camera, as a move of the view that can be undone there.
void edit_camera(ViewerState& state, const std::function<void(Camera&)>& change);

// A drag of a control begins, goes on or is left. What has a fault changes nothing.
void begin_field_drag(ViewerState& state, const std::string& id, const std::string& what);
void drag_field(ViewerState& state, const std::function<void(Scene&)>& change);
void begin_camera_field_drag(ViewerState& state, const std::string& id);
void drag_camera_field(ViewerState& state, const std::function<void(Camera&)>& change);
void end_field_drag(ViewerState& state);
// At the end of the panels: a control that vanished while it was dragged or typed into leaves
// nothing behind; Escape ends a drag as if it had never begun.
void end_lost_edits(ViewerState& state);

// One of ImGui's keys (ImGuiKey_Enter) went down in this frame, and no modifier is held with it.
[[nodiscard]] bool plain_key_pressed(int imgui_key);

}  // namespace ivory
