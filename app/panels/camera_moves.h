// How the camera of the view changes, whoever changes it: by hand, as it was written, or so that
// nothing is seen of it.
#pragma once

#include "app/panels/viewer_state.h"

namespace ivory {

// By hand: a part of a gesture, which DocumentView::end_move ends, or a gesture of its own. An
// orthographic camera's plane stays before the surface.
void drag_camera(ViewerState& state, const Camera& camera);
void move_camera(ViewerState& state, const Camera& camera);
// To a camera that somebody wrote down, to the last bit: a plane that cuts the surface was meant to.
void drag_camera_as_written(ViewerState& state, const Camera& camera);
void set_camera(ViewerState& state, const Camera& camera);
// What is seen at the target keeps its size.
void set_projection(ViewerState& state, Camera::Projection projection);

// After edits of the scene, in each frame: an orthographic camera's plane that the surface has come to
// is before it again. Not a move that could be undone, for nothing is seen of it.
void keep_plane_before_surface(ViewerState& state);

// The clipboard and the camera as a scene has it. What holds no camera is refused with a message.
void copy_camera(ViewerState& state);
void paste_camera(ViewerState& state);

}  // namespace ivory
