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
// To the document's file, unless another program has changed it: that is asked about. Without a
// file to one that is asked for. Then what was pending is done.
void save_or_ask(ViewerState& state, std::optional<Pending> after);
// To a file of that name; where there is one already, after the question. False: a failure, which
// is the message, or a question.
bool save_as(ViewerState& state, const std::filesystem::path& path, std::optional<Pending> after);
// The answers to state.panels.file_question, which is over then or asked again. False as above.
bool overwrite(ViewerState& state);
void reload(ViewerState& state);
// Without a question.
void perform(ViewerState& state, const Pending& pending);

// Popups over everything else.
void draw_dialogs(ViewerState& state);
void draw_file_browser(ViewerState& state);
// state.panels.file_question, over the popup in which it is called, or else over all.
void draw_file_question(ViewerState& state);

}  // namespace ivory
