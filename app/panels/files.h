// Opening, saving and leaving, with the question about unsaved changes between. See also panels.h.
#pragma once

#include <optional>

#include "app/panels/panel_memory.h"
#include "app/panels/viewer_state.h"

namespace ivory {

// An empty scene, at once or after the question.
void request_new(ViewerState& state);
// The file browser.
void browse_to_open(ViewerState& state);
void browse_to_save(ViewerState& state, std::optional<Pending> after);
// To the document's file, or to one that is asked for; then what was pending is done.
void save_or_ask(ViewerState& state, std::optional<Pending> after);
// Saves there and does what was pending; a failure is the message, and false.
bool save_and_go_on(ViewerState& state, const std::filesystem::path& path,
                    std::optional<Pending> after);
// Without a question.
void perform(ViewerState& state, const Pending& pending);

// Popups over everything else.
void draw_dialogs(ViewerState& state);
void draw_file_browser(ViewerState& state);

}  // namespace ivory
