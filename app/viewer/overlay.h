// The skeleton drawn over the picture: lines dimmed where they lie behind the surface, the iso-ring
// of the selected element, handles, the axis of a locked drag.
#pragma once

#include <optional>

#include "app/panels/viewer_state.h"
#include "app/viewer/handles.h"

struct ImDrawList;

namespace ivory {

// Draws into `list`, clipped to state.viewport by the caller. Depth comes from state.picture, scene and
// camera from `seen`: those of the picture that is shown, so that neither it nor what is drawn over it
// trails the other.
void draw_overlay(const ViewerState& state, const SeenScene& seen, const ViewportMouse& mouse,
                  ImDrawList& list);

// The handle that is held as it is drawn: where the hand has it, or where an earlier scene had it;
// nothing where that is out of sight.
[[nodiscard]] std::optional<Handle> held_handle(const SeenScene& seen, const Handle& grabbed);

}  // namespace ivory
