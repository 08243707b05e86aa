// What is clicked. Each control records itself in state.widgets.
#pragma once

#include <string>

#include "app/panels/icons.h"
#include "app/panels/viewer_state.h"

namespace ivory {

// A box and its label; true where it was clicked.
bool toggle(ViewerState& state, const std::string& id, const char* label, bool on);

// True where it was clicked. `on`: shown as switched on.
bool icon_button(ViewerState& state, const std::string& id, Icon icon, const char* tooltip,
                 bool enabled = true, bool on = false);
bool text_button(ViewerState& state, const std::string& id, const char* label, float width = 0,
                 bool enabled = true, bool strong = false);

}  // namespace ivory
