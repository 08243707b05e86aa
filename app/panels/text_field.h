// Lines of text to type into; what comes of it is the caller's.
#pragma once

#include <imgui.h>

#include <string>

#include "app/panels/viewer_state.h"

namespace ivory {

// True once, when a new text has been entered; `text` holds it. A click selects what stands there.
// `hint` stands in an empty field.
bool text_field(ViewerState& state, const std::string& id, std::string& text, float width,
                const char* hint = "", bool focus = false);

// Without anything of its own: ImGui's line, for a std::string that grows as is typed.
bool input_text(const char* name, const char* hint, std::string& text, ImGuiInputTextFlags flags);

}  // namespace ivory
