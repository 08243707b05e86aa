#include "app/panels/camera_moves.h"

#include <imgui.h>

#include <cstddef>
#include <string>

#include "core/scene/error.h"
#include "core/scene/scene_json.h"

namespace ivory {

namespace {

// Around the surface of the scene as it stands, in a drag too.
const Box3& surface_box(ViewerState& state) {
    return state.panels.surface.around(state.document.scene_value());
}

Camera before_surface(ViewerState& state, const Camera& camera) {
    return camera.is_orthographic() ? with_plane_before(camera, surface_box(state)) : camera;
}

}  // namespace

void drag_camera(ViewerState& state, const Camera& camera) {
    if (camera != state.view.camera) state.view.move_on(before_surface(state, camera));
}

void move_camera(ViewerState& state, const Camera& camera) {
    if (camera != state.view.camera) state.view.move_to(before_surface(state, camera));
}

void drag_camera_as_written(ViewerState& state, const Camera& camera) {
    const bool section = camera.is_orthographic() && !plane_is_before(camera, surface_box(state));
    state.view.move_on(camera, section);
}

void set_camera(ViewerState& state, const Camera& camera) {
    state.view.end_move();
    drag_camera_as_written(state, camera);
    state.view.end_move();
}

void set_projection(ViewerState& state, Camera::Projection projection) {
    move_camera(state, in_projection(state.view.camera, projection));
}

void keep_plane_before_surface(ViewerState& state) {
    if (state.view.is_section || !state.view.camera.is_orthographic()) return;
    // A drag of the threshold changes what all elements reach. In a large scene the room before the
    // surface has to serve until it ends.
    constexpr std::size_t most_in_a_frame = 500;
    const Document& document = state.document;
    if (document.dragging() && document.scene().elements.size() > most_in_a_frame &&
        state.panels.surface.quickly_around(document.scene_value()) == nullptr)
        return;
    state.view.camera = before_surface(state, state.view.camera);
}

void copy_camera(ViewerState& state) {
    ImGui::SetClipboardText(write_camera(state.view.camera).c_str());
    state.say("The camera is in the clipboard");
}

void paste_camera(ViewerState& state) {
    const char* const text = ImGui::GetClipboardText();
    try {
        const Camera camera =
            parse_camera(text == nullptr ? "" : text, "the clipboard holds no camera");
        if (state.message.error) state.message = {};
        set_camera(state, camera);
    } catch (const Error& error) {
        state.say_error(std::string(error.what()) +
                        "; a camera is {\"position\": [0, 0, 8], \"target\": [0, 0, 0]}");
    }
}

}  // namespace ivory
