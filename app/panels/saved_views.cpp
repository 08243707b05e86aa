#include "app/panels/saved_views.h"

#include "app/panels/camera_moves.h"
#include "app/panels/scene_edits.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

bool has_view(const ViewerState& state, const std::string& name) {
    return find_view(state.document.scene().views, name).has_value();
}

std::string free_name(const ViewerState& state) {
    for (std::size_t number = state.document.scene().views.size() + 1;; ++number) {
        std::string name = "View " + std::to_string(number);
        if (!has_view(state, name)) return name;
    }
}

}  // namespace

std::optional<std::size_t> find_view(const std::vector<SavedView>& views, const std::string& name) {
    for (std::size_t k = 0; k < views.size(); ++k)
        if (views[k].name == name) return k;
    return std::nullopt;
}

void keep_view(ViewerState& state) {
    const std::string name = free_name(state);
    edit_scene(state, "Keep " + name, [&](Scene& scene) {
        scene.views.push_back({name, state.view.camera});
    });
    state.panels.view = name;
}

void choose_view(ViewerState& state, const std::string& name) {
    const std::vector<SavedView>& views = state.document.scene().views;
    const auto view = find_view(views, name);
    if (!view) return;
    state.panels.view = name;
    set_camera(state, views[*view].camera);
}

void rename_view(ViewerState& state, const std::string& name, const std::string& to) {
    const bool is_free = !has_view(state, to);
    edit_scene(state, "Rename " + printable(name, 60), [&](Scene& scene) {
        if (const auto view = find_view(scene.views, name)) scene.views[*view].name = to;
    });
    if (is_free && has_view(state, to)) state.panels.view = to;
}

void replace_view(ViewerState& state, const std::string& name) {
    edit_scene(state, "Replace " + printable(name, 60), [&](Scene& scene) {
        if (const auto view = find_view(scene.views, name))
            scene.views[*view].camera = state.view.camera;
    });
}

void delete_view(ViewerState& state, const std::string& name) {
    edit_scene(state, "Delete " + printable(name, 60), [&](Scene& scene) {
        if (const auto view = find_view(scene.views, name))
            scene.views.erase(scene.views.begin() + static_cast<std::ptrdiff_t>(*view));
    });
}

}  // namespace ivory
