#include "app/panels/scene_edits.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "app/panels/camera_moves.h"
#include "core/render/camera.h"
#include "core/scene/error.h"
#include "core/scene/scene_fault.h"

namespace ivory {

namespace {

// Faults of what a drag in a panel can change; the whole scene would be too much for every frame.
bool has_fault(const Scene& scene, std::optional<std::size_t> selected) {
    if (!(scene.threshold > 0 && std::isfinite(scene.threshold))) return true;
    if (selected && find_fault(scene.elements[*selected])) return true;
    return scene.lights &&
           std::any_of(scene.lights->begin(), scene.lights->end(),
                       [](const Light& light) { return find_fault(light).has_value(); });
}

// Of an orthographic camera without a height it is written out first: what follows from its place
// would change with that.
Camera changed_camera(const ViewerState& state, const std::function<void(Camera&)>& change) {
    Camera camera = with_height(state.view.camera);
    change(camera);
    return camera;
}

void begin(DraggedField& drag, const std::string& id, bool of_camera) {
    drag.id = id;
    drag.begun = true;
    drag.cancelled = false;
    drag.of_camera = of_camera;
}

}  // namespace

void edit_scene(ViewerState& state, const std::string& what,
                const std::function<void(Scene&)>& change) {
    Scene scene = state.document.scene();
    try {
        change(scene);
    } catch (const Error& error) {
        state.say_error(error.what());
        return;
    }
    if (const auto fault = find_fault(scene)) {
        state.say_error(fault->message);
        return;
    }
    if (state.message.error) state.message = {};  // what was wrong has been put right
    state.document.edit(what, std::move(scene));
}

void edit_camera(ViewerState& state, const std::function<void(Camera&)>& change) {
    const Camera camera = changed_camera(state, change);
    if (const auto fault = find_fault(camera)) {
        state.say_error(fault->message);
        return;
    }
    if (state.message.error) state.message = {};
    set_camera(state, camera);
}

void begin_field_drag(ViewerState& state, const std::string& id, const std::string& what) {
    begin(state.panels.dragged, id, false);
    state.document.begin_drag(what);
}

void begin_camera_field_drag(ViewerState& state, const std::string& id) {
    begin(state.panels.dragged, id, true);
    state.view.end_move();
}

void drag_camera_field(ViewerState& state, const std::function<void(Camera&)>& change) {
    if (!state.panels.dragged.begun || state.panels.dragged.cancelled) return;
    const Camera camera = changed_camera(state, change);
    if (!find_fault(camera)) drag_camera_as_written(state, camera);
}

void drag_field(ViewerState& state, const std::function<void(Scene&)>& change) {
    if (!state.document.dragging() || state.panels.dragged.cancelled) return;
    Scene scene = state.document.scene();
    change(scene);
    if (!has_fault(scene, state.document.selected())) state.document.drag_to(std::move(scene));
}

void end_field_drag(ViewerState& state) {
    if (!state.panels.dragged.begun) return;
    state.panels.dragged.begun = false;
    if (state.panels.dragged.of_camera)
        state.view.end_move();
    else
        state.document.end_drag();
}

void end_lost_edits(ViewerState& state) {
    DraggedField& drag = state.panels.dragged;
    if (drag.begun && plain_key_pressed(ImGuiKey_Escape)) {
        if (drag.of_camera)
            state.view.cancel_move();
        else
            state.document.cancel_drag();
        drag.begun = false;
        drag.cancelled = true;
    }
    if (drag.begun && !ImGui::IsAnyItemActive()) end_field_drag(state);

    PanelMemory& memory = state.panels;
    if (memory.number && !std::exchange(memory.number->drawn, false)) memory.number.reset();
    memory.type_next = false;
}

bool plain_key_pressed(int imgui_key) {
    const ImGuiIO& io = ImGui::GetIO();
    return !io.KeyCtrl && !io.KeyShift && !io.KeyAlt && !io.KeySuper &&
           ImGui::IsKeyPressed(ImGui::GetKeyIndex(static_cast<ImGuiKey>(imgui_key)), false);
}

}  // namespace ivory
