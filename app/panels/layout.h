// Where things stand in a panel, and what stands over them: lines, headings, tooltips, dialogs.
#pragma once

#include "app/panels/viewer_state.h"

namespace ivory {

// The last item's, shown when the pointer rests on it.
void tooltip(const char* text);

// A dialog in the middle of the window, over everything; where it is drawn, ImGui::EndPopup
// follows. A size of 0 fits the contents.
bool begin_dialog(const ViewerState& state, const char* name, float width = 0, float height = 0);

// A heading with space above it, unless it is the first of its panel.
void section(const ViewerState& state, const char* title);
// Begins a line "label   field"; the field follows, as wide as field_width().
void label(const ViewerState& state, const char* text);
[[nodiscard]] float field_width();

// So many pixels at scale 1.
[[nodiscard]] inline float px(const ViewerState& state, double pixels) {
    return static_cast<float>(pixels * state.scale);
}

}  // namespace ivory
