#include "app/panels/actions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "app/panels/camera_moves.h"
#include "app/panels/files.h"
#include "app/panels/names.h"
#include "app/panels/panels.h"
#include "app/panels/saved_views.h"
#include "app/panels/scene_edits.h"
#include "app/shape/shapes.h"
#include "core/field/field.h"
#include "core/render/framing.h"
#include "core/scene/error.h"

namespace ivory {

namespace {

constexpr Modifiers plain{};
constexpr Modifiers ctrl{.control = true};
constexpr Modifiers alt{.alt = true};
constexpr Modifiers ctrl_shift{.shift = true, .control = true};

constexpr std::array actions = {
    ActionInfo{Action::start_anew, "file.new", "New", "Ctrl+N", {Key::n, ctrl}},
    ActionInfo{Action::open, "file.open", "Open\xE2\x80\xA6", "Ctrl+O", {Key::o, ctrl}, true},
    ActionInfo{Action::save, "file.save", "Save", "Ctrl+S", {Key::s, ctrl}},
    ActionInfo{Action::save_as,
               "file.save_as",
               "Save as\xE2\x80\xA6",
               "Ctrl+Shift+S",
               {Key::s, ctrl_shift},
               true},
    ActionInfo{Action::screenshot, "file.screenshot", "Screenshot", "F12", {Key::f12, plain}, true},
    ActionInfo{Action::quit, "file.quit", "Quit", "Ctrl+Q", {Key::q, ctrl}},
    ActionInfo{Action::undo, "edit.undo", "Undo", "Ctrl+Z", {Key::z, ctrl}},
    ActionInfo{Action::redo, "edit.redo", "Redo", "Ctrl+Shift+Z", {Key::z, ctrl_shift}, true},
    ActionInfo{Action::duplicate, "edit.duplicate", "Duplicate", "Ctrl+D", {Key::d, ctrl}},
    ActionInfo{Action::remove, "edit.delete", "Delete", "Del", {Key::del, plain}},
    ActionInfo{Action::hide, "edit.hide", "Hide", "H", {Key::h, plain}},
    ActionInfo{Action::frame_all, "view.frame_all", "Frame all", "Home", {Key::home, plain}},
    ActionInfo{Action::focus, "view.focus", "Focus selected", "F", {Key::f, plain}, true},
    ActionInfo{Action::front, "view.front", "Front", "1", {Key::digit1, plain}},
    ActionInfo{Action::back, "view.back", "Back", "Ctrl+1", {Key::digit1, ctrl}},
    ActionInfo{Action::right, "view.right", "Right", "3", {Key::digit3, plain}},
    ActionInfo{Action::left, "view.left", "Left", "Ctrl+3", {Key::digit3, ctrl}},
    ActionInfo{Action::top, "view.top", "Top", "7", {Key::digit7, plain}},
    ActionInfo{Action::bottom, "view.bottom", "Bottom", "Ctrl+7", {Key::digit7, ctrl}},
    ActionInfo{
        Action::orthographic, "view.orthographic", "Orthographic", "5", {Key::digit5, plain}, true},
    ActionInfo{Action::undo_move, "view.undo", "Undo move", "Alt+Left", {Key::left, alt}},
    ActionInfo{Action::redo_move, "view.redo", "Redo move", "Alt+Right", {Key::right, alt}},
    ActionInfo{
        Action::copy_camera, "view.copy", "Copy camera", "Ctrl+Shift+C", {Key::c, ctrl_shift}},
    ActionInfo{
        Action::paste_camera, "view.paste", "Paste camera", "Ctrl+Shift+V", {Key::v, ctrl_shift}},
    ActionInfo{Action::keep_view, "view.keep", "Keep this view", "", {}, true},
    ActionInfo{Action::skeleton, "view.skeleton", "Skeleton", "S", {Key::s, plain}},
    ActionInfo{Action::panels, "view.panels", "Panels", "Tab", {Key::tab, plain}},
    ActionInfo{Action::theme, "view.theme", "Light theme", "", {}},
    ActionInfo{Action::help, "help.keys", "Mouse and keys", "?", {}},
};

// The surface, or, where it is empty, the elements that could make one.
void frame_all(ViewerState& state) {
    const Scene& scene = state.document.scene();
    const Projection view = state.projection();
    const double aspect = static_cast<double>(view.size().width) / view.size().height;
    try {
        const Framing framing = frame_surface(compile(scene), view.camera(), aspect);
        if (!framing.empty || scene.elements.empty()) {
            move_camera(state, framing.camera);
            return;
        }
    } catch (const Error& error) {
        state.say_error(error.what());
        return;
    }
    Box3 box;
    for (const Element& element : scene.elements) box.include(box_around(element));
    move_camera(state, framed(view, box));
}

void remove_selected(ViewerState& state) {
    Document& document = state.document;
    const std::size_t element = *document.selected();
    const std::string what = "Delete " + names_of(state)[element];
    Scene scene = without_element(document.scene(), element);
    // the one that takes its place in the list, so that Del can be pressed again
    const std::size_t left = scene.elements.size();
    document.edit(what, std::move(scene),
                  left == 0 ? std::nullopt : std::optional(std::min(element, left - 1)));
}

void duplicate_selected(ViewerState& state) {
    Document& document = state.document;
    const std::size_t element = *document.selected();
    document.edit("Duplicate " + names_of(state)[element], with_copy(document.scene(), element),
                  element + 1);
}

void focus_selected(ViewerState& state) {
    const Element& element = state.document.scene().elements[*state.document.selected()];
    move_camera(state, framed(state.projection(), box_around(element)));
}

}  // namespace

std::span<const ActionInfo> all_actions() { return actions; }

const ActionInfo& info(Action action) {
    return *std::find_if(actions.begin(), actions.end(),
                         [&](const ActionInfo& candidate) { return candidate.action == action; });
}

bool is_possible(const ViewerState& state, Action action) {
    switch (action) {
        case Action::undo:
            return !state.document.undo_name().empty();
        case Action::redo:
            return !state.document.redo_name().empty();
        case Action::undo_move:
            return state.view.can_undo();
        case Action::redo_move:
            return state.view.can_redo();
        case Action::remove:
        case Action::duplicate:
        case Action::hide:
        case Action::focus:
            return state.document.selected().has_value();
        default:
            return true;
    }
}

bool is_on(const ViewerState& state, Action action) {
    switch (action) {
        case Action::orthographic:
            return state.projection().is_orthographic();
        case Action::skeleton:
            return state.skeleton_shown;
        case Action::theme:
            return state.theme == Theme::light;
        case Action::panels:
            return !state.panels_hidden;
        case Action::help:
            return state.help_shown;
        default:
            return false;
    }
}

std::string label_of(const ViewerState& state, Action action) {
    const std::string label = info(action).label;
    const auto about = [&](const std::string& what) {
        return what.empty() ? label : label + ": " + what;
    };
    if (action == Action::undo) return about(state.document.undo_name());
    if (action == Action::redo) return about(state.document.redo_name());
    const bool view_alone = !state.document.dirty() && !state.view.is_saved();
    if (action == Action::save && state.document.path() && view_alone) return "Save this view";
    const auto selected = state.document.selected();
    if (action == Action::hide && selected && !state.document.scene().elements[*selected].visible)
        return "Show";
    return label;
}

void run(ViewerState& state, Action action) {
    if (!is_possible(state, action)) return;
    const auto look_along = [&](int axis, bool opposite) {
        move_camera(state, along_axis(state.projection(), axis, opposite));
    };
    switch (action) {
        case Action::start_anew:
            request_new(state);
            return;
        case Action::open:
            browse_to_open(state);
            return;
        case Action::save:
            save_or_ask(state, std::nullopt);
            return;
        case Action::save_as:
            browse_to_save(state, std::nullopt);
            return;
        case Action::screenshot:
            state.screenshot_wanted = free_screenshot_path(state);
            return;
        case Action::quit:
            request_quit(state);
            return;
        case Action::undo:
            state.document.undo();
            return;
        case Action::redo:
            state.document.redo();
            return;
        case Action::remove:
            remove_selected(state);
            return;
        case Action::duplicate:
            duplicate_selected(state);
            return;
        case Action::hide: {
            const std::size_t element = *state.document.selected();
            set_visible(state, element, !state.document.scene().elements[element].visible);
            return;
        }
        case Action::frame_all:
            frame_all(state);
            return;
        case Action::focus:
            focus_selected(state);
            return;
        case Action::front:
            look_along(2, false);
            return;
        case Action::back:
            look_along(2, true);
            return;
        case Action::right:
            look_along(0, false);
            return;
        case Action::left:
            look_along(0, true);
            return;
        case Action::top:
            look_along(1, false);
            return;
        case Action::bottom:
            look_along(1, true);
            return;
        case Action::orthographic:
            set_projection(state, state.projection().is_orthographic()
                                      ? Camera::Projection::perspective
                                      : Camera::Projection::orthographic);
            return;
        case Action::undo_move:
            state.view.undo();
            return;
        case Action::redo_move:
            state.view.redo();
            return;
        case Action::copy_camera:
            copy_camera(state);
            return;
        case Action::paste_camera:
            paste_camera(state);
            return;
        case Action::keep_view:
            keep_view(state);
            return;
        case Action::skeleton:
            state.skeleton_shown = !state.skeleton_shown;
            return;
        case Action::theme:
            state.theme = state.theme == Theme::dark ? Theme::light : Theme::dark;
            return;
        case Action::panels:
            state.panels_hidden = !state.panels_hidden;
            return;
        case Action::help:
            state.help_shown = !state.help_shown;
            return;
    }
}

std::filesystem::path free_screenshot_path(const ViewerState& state) {
    namespace fs = std::filesystem;
    const auto& scene = state.document.path();
    const std::string name = scene ? scene->filename().string() : "untitled";
    const std::string stem = name.substr(0, name.find('.'));
    std::error_code ignored;
    for (int n = 1;; ++n) {
        fs::path path = (stem.empty() ? "ivory" : stem) + "-" + std::to_string(n) + ".png";
        if (!fs::exists(path, ignored)) return path;
    }
}

void add_element(ViewerState& state, Shape shape) {
    Document& document = state.document;
    const std::vector<Element>& elements = document.scene().elements;
    // as wide as what is there already
    const double size = document.selected() ? elements[*document.selected()].width
                        : !elements.empty() ? elements.back().width
                                            : 1;
    Element element = new_element(shape, state.view.camera.target, size, elements.size());
    const std::string what = std::string("Add ") + shape_word(element.skeleton);
    const std::size_t place = elements.size();
    document.edit(what, with_element(document.scene(), std::move(element)), place);
}

void move_element(ViewerState& state, std::size_t element, std::size_t to) {
    Document& document = state.document;
    if (element == to || to >= document.scene().elements.size()) return;
    auto selected = document.selected();
    if (selected == element) {
        selected = to;
    } else if (selected) {
        if (element < *selected && *selected <= to)
            --*selected;
        else if (to <= *selected && *selected < element)
            ++*selected;
    }
    document.edit("Move " + names_of(state)[element] + (to < element ? " up" : " down"),
                  with_element_moved(document.scene(), element, to), selected);
}

void set_visible(ViewerState& state, std::size_t element, bool visible) {
    edit_scene(state, (visible ? "Show " : "Hide ") + names_of(state)[element],
               [&](Scene& scene) { scene.elements[element].visible = visible; });
}

}  // namespace ivory
