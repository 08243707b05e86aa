#include "app/panels/saved_views.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "app/panels/camera_moves.h"
#include "app/panels/scene_edits.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

std::vector<SavedView>::iterator find_view(Scene& scene, const std::string& name) {
    return std::find_if(scene.views.begin(), scene.views.end(),
                        [&](const SavedView& view) { return view.name == name; });
}

bool has_view(const Scene& scene, const std::string& name) {
    return std::any_of(scene.views.begin(), scene.views.end(),
                       [&](const SavedView& view) { return view.name == name; });
}

std::string free_name(const Scene& scene) {
    for (std::size_t number = scene.views.size() + 1;; ++number) {
        std::string name = "View " + std::to_string(number);
        if (!has_view(scene, name)) return name;
    }
}

}  // namespace

void keep_view(ViewerState& state) {
    const std::string name = free_name(state.document.scene());
    edit_scene(state, "Keep " + name, [&](Scene& scene) {
        scene.views.push_back({name, state.view.camera});
    });
    state.panels.view = name;
}

void choose_view(ViewerState& state, const std::string& name) {
    for (const SavedView& view : state.document.scene().views) {
        if (view.name != name) continue;
        state.panels.view = name;
        set_camera(state, view.camera);
        return;
    }
}

void rename_view(ViewerState& state, const std::string& name, const std::string& to) {
    const bool is_free = !has_view(state.document.scene(), to);
    edit_scene(state, "Rename " + printable(name, 60), [&](Scene& scene) {
        if (const auto view = find_view(scene, name); view != scene.views.end()) view->name = to;
    });
    if (is_free && has_view(state.document.scene(), to)) state.panels.view = to;
}

void replace_view(ViewerState& state, const std::string& name) {
    edit_scene(state, "Replace " + printable(name, 60), [&](Scene& scene) {
        if (const auto view = find_view(scene, name); view != scene.views.end())
            view->camera = state.view.camera;
    });
}

void delete_view(ViewerState& state, const std::string& name) {
    edit_scene(state, "Delete " + printable(name, 60), [&](Scene& scene) {
        if (const auto view = find_view(scene, name); view != scene.views.end())
            scene.views.erase(view);
    });
}

}  // namespace ivory
