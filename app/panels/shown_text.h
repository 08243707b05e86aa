// Text as the fonts and the room allow to show it.
#pragma once

#include <string>

#include "app/panels/viewer_state.h"

namespace ivory {

// `text` with every character that no font draws as \u{539F}, and what such a text stands for.
[[nodiscard]] std::string shown_text(const ViewerState& state, const std::string& text);
[[nodiscard]] std::string meant_text(const std::string& shown);
// Fonts that have its characters are wanted from the next frame on.
void want_glyphs(ViewerState& state, const std::string& text);

// `text`, or as much of it as has room beside an ellipsis.
[[nodiscard]] std::string fitted_text(const std::string& text, float width);

}  // namespace ivory
