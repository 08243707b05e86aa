// The skeleton drawn over the picture: lines dimmed where they lie behind the surface, the iso-ring
// of the selected element, handles, the axis of a locked drag.
#pragma once

#include "app/panels/viewer_state.h"
#include "app/viewer/handles.h"

struct ImDrawList;

namespace ivory {

// Draws into `list`, clipped to state.viewport by the caller. Depth comes from state.picture.
void draw_overlay(const ViewerState& state, const ViewportMouse& mouse, ImDrawList& list);

}  // namespace ivory
