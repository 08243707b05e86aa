#include "app/viewer/state_file.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/viewer/handles.h"
#include "core/render/tiles.h"
#include "core/scene/scene_json.h"

namespace ivory {

namespace {

using nlohmann::json;

json triple(const Vec3d& v) { return json::array({v.x, v.y, v.z}); }

json camera_json(const Camera& camera) {
    return {{"position", triple(camera.position)},
            {"target", triple(camera.target)},
            {"up", triple(camera.up)},
            {"fov", camera.fov},
            {"projection", projection_words[static_cast<std::size_t>(camera.projection)]},
            {"height", seen_height(camera)}};
}

json rectangle(const WindowRect& rect) {
    return json::array({rect.x, rect.y, rect.width, rect.height});
}

json handles_json(const ViewerState& state, const std::vector<std::string>& names) {
    json all = json::object();
    for (std::size_t element = 0; element < names.size(); ++element) {
        json handles = json::object();
        for (const Handle& handle : handles_of(state, element))
            handles[handle.name] = json::array({handle.at.x, handle.at.y});
        if (!handles.empty()) all[names[element]] = std::move(handles);
    }
    return all;
}

// Times and places to a thousandth.
json rounded(double value) { return std::round(1000 * value) / 1000; }

json rounded(const std::optional<double>& value) { return value ? rounded(*value) : json(nullptr); }

json frames_json(const std::deque<FrameRecord>& frames, std::uint64_t count) {
    const std::size_t first = frames.size() - std::min<std::uint64_t>(count, frames.size());
    json lists = {{"at", json::array()},
                  {"took", json::array()},
                  {"drew", json::array()},
                  {"asked", json::array()},
                  {"age", json::array()},
                  {"resolution", json::array()},
                  {"fine", json::array()},
                  {"handle_to_surface", json::array()},
                  {"handle_to_hand", json::array()}};
    for (std::size_t i = first; i < frames.size(); ++i) {
        const FrameRecord& frame = frames[i];
        lists["at"].push_back(rounded(frame.at));
        lists["took"].push_back(rounded(frame.took));
        lists["drew"].push_back(rounded(frame.drew));
        lists["asked"].push_back(frame.asked);
        lists["age"].push_back(rounded(frame.age));
        lists["resolution"].push_back(frame.resolution);
        lists["fine"].push_back(rounded(frame.fine));
        lists["handle_to_surface"].push_back(rounded(frame.handle_to_surface));
        lists["handle_to_hand"].push_back(rounded(frame.handle_to_hand));
    }
    return lists;
}

}  // namespace

json state_json(Viewer& viewer, const StateBefore& before) {
    const ViewerState& state = viewer.state();
    const Document& document = state.document;
    const std::vector<std::string> names = element_names(document.scene());
    const PictureState& picture = state.picture;

    json all;
    all["viewport"] = rectangle(state.viewport);
    all["selection"] = nullptr;
    if (document.selected()) all["selection"] = names[*document.selected()];
    const Camera& camera = state.view.camera;
    all["camera"] = camera_json(camera);
    all["view"] = {{"undo", state.view.can_undo()},
                   {"redo", state.view.can_redo()},
                   {"saved", state.view.is_saved()},
                   {"chosen", nullptr}};
    if (state.panels.view) all["view"]["chosen"] = *state.panels.view;
    all["handles"] = handles_json(state, names);
    all["widgets"] = json::object();
    for (const auto& [id, widget] : state.widgets.all())
        if (const auto part = widget.visible_part()) all["widgets"][id] = rectangle(*part);
    const TileGrid grid(state.viewport.width, state.viewport.height);
    all["tiles"] = {{"total", grid.tiles.size()},
                    {"traced", viewer.totals().tiles_traced - before.tiles}};
    all["pixels"] = {
        {"hit", picture.hit}, {"miss", picture.miss}, {"unresolved", picture.unresolved}};
    all["final"] = viewer.final();
    all["milliseconds"] = {{"frames", viewer.times().frames}, {"edits", viewer.times().edits}};
    all["frames"] = frames_json(viewer.frames(), viewer.frame_count() - before.frames);
    all["message"] = state.message.text;
    all["path"] = nullptr;
    if (document.path()) all["path"] = document.path()->string();
    all["dirty"] = document.dirty();
    all["undo"] = document.undo_name();
    all["redo"] = document.redo_name();
    all["theme"] = state.theme == Theme::dark ? "dark" : "light";
    all["scale"] = state.scale;
    return all;
}

std::string state_text(const json& state) {
    const auto text = [](const json& value) {
        return value.dump(-1, ' ', false, json::error_handler_t::replace);
    };
    std::string all = "{";
    for (const auto& [key, value] : state.items()) {
        all += (all.size() > 1 ? ",\n  " : "\n  ") + text(key) + ": ";
        const bool nested = value.is_object() && !value.empty() &&
                            (value.front().is_object() || value.front().is_array());
        if (!nested) {
            all += text(value);
            continue;
        }
        std::string inner;
        for (const auto& [inner_key, inner_value] : value.items())
            inner +=
                (inner.empty() ? "\n    " : ",\n    ") + text(inner_key) + ": " + text(inner_value);
        all += "{" + inner + "\n  }";
    }
    return all + "\n}\n";
}

json whole_scene_json(const ViewerState& state) {
    Scene scene = state.scene_with_view();
    if (!scene.lights) scene.lights = default_lights();
    const std::vector<std::string> names = element_names(scene);
    json whole = json::parse(write_scene(scene));
    whole["camera"] = camera_json(*scene.camera);
    if (scene.views.empty()) whole["views"] = json::array();
    for (std::size_t i = 0; i < scene.elements.size(); ++i) {
        json& element = whole["elements"][i];
        element["name"] = names[i];
        element["kernel"] = kernel_word(scene.elements[i].kernel);
        element["strength"] = scene.elements[i].strength;
        element["width"] = scene.elements[i].width;
        element["visible"] = scene.elements[i].visible;
    }
    return whole;
}

}  // namespace ivory
