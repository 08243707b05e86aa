// The panels one by one. Each draws one ImGui window into its rectangle.
#pragma once

#include "app/panels/viewer_state.h"
#include "app/platform/window_rect.h"

namespace ivory {

// The height of the bars at the top and the bottom, in pixels.
[[nodiscard]] int top_bar_height(const ViewerState& state);
[[nodiscard]] int status_bar_height(const ViewerState& state);

// Menus, the most used buttons, the file's name.
void draw_top_bar(ViewerState& state);
// The list of the elements, and what adds, copies, deletes and reorders them.
void draw_scene_panel(ViewerState& state, const WindowRect& rect);
// The selected element, the surface and its lights, the camera and the views that are kept.
void draw_inspector_panel(ViewerState& state, const WindowRect& rect);
// State of the picture, or the message.
void draw_status_bar(ViewerState& state, const WindowRect& rect);
// The message alone, over the picture, while the panels are hidden.
void draw_message(ViewerState& state);
// All bindings, over everything.
void draw_help(ViewerState& state);

// Parts of the inspector panel.
void draw_inspector(ViewerState& state);
void draw_surface(ViewerState& state);
void draw_lights(ViewerState& state);
void draw_camera(ViewerState& state);
void draw_views(ViewerState& state);

// A fixed window without any decoration; ImGui::End follows in any case.
void begin_panel(const char* name, const WindowRect& rect, int more_flags = 0);

}  // namespace ivory
