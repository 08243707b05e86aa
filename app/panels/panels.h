// The panels around the picture. Document in, edit out: they change ViewerState and nothing else.
#pragma once

#include <filesystem>

#include "app/panels/viewer_state.h"
#include "app/platform/input.h"

namespace ivory {

// Colours, spacing and roundings of a theme, for that scale. Sets ImGui's style whole.
void apply_theme(Theme theme, double scale);

// Between ImGui::NewFrame and Render, once a frame: lays out the window, sets state.viewport (the
// part that no panel covers, at least 1 x 1), draws every panel, dialog and message, and records
// every control in state.widgets. With panels_hidden the viewport is the whole window.
void draw_panels(ViewerState& state);

// So many seconds of real time have passed since the last frame: a message that has been read by now
// goes, an error later than others. At the start of each frame.
void age_message(ViewerState& state, double seconds);

// The keys of the bindings table, for what no text field has taken. Before draw_panels.
void handle_keys(ViewerState& state, const Input& input);

// A file named on the command line, dropped on the window or picked: opened at once, or after the
// question about unsaved changes. A broken file leaves everything as it is but the message.
void request_open(ViewerState& state, const std::filesystem::path& path);
// Opens without a question. Throws Error.
void open_scene(ViewerState& state, const std::filesystem::path& path);
// Writes scene_with_view(), under a temporary name and renamed. Throws Error.
void save_scene(ViewerState& state, const std::filesystem::path& path);
// The window's close button and Ctrl+Q: state.quit, at once or after the question.
void request_quit(ViewerState& state);

// A frame is needed soon although nothing happens: a message fades, a caret blinks. Seconds, or <
// 0.
[[nodiscard]] double next_frame_wanted(const ViewerState& state);

}  // namespace ivory
