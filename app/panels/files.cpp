#include "app/panels/files.h"

#include <utility>

#include "app/panels/panels.h"
#include "core/field/field.h"
#include "core/render/camera.h"
#include "core/scene/error.h"
#include "core/scene/scene_json.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

void take_document(ViewerState& state, Document document, const Camera& camera, bool automatic) {
    state.document = std::move(document);
    state.view = {camera, automatic};
    state.panels.number.reset();
    state.panels.text = {};
    state.panels.dragged = {};
    state.panels.row_shown.reset();
    state.panels.ranged.reset();
    state.message = {};
}

void ask_or_perform(ViewerState& state, Pending pending) {
    state.document.end_drag();
    if (!state.document.dirty()) {
        perform(state, pending);
        return;
    }
    state.panels.question = std::move(pending);
    state.panels.browser.mode = FileBrowser::Mode::closed;
}

std::string shown_name(const std::filesystem::path& path) {
    return printable(path.filename().string(), 80);
}

}  // namespace

void open_scene(ViewerState& state, const std::filesystem::path& path) {
    Document document = Document::open(path, state.stop);
    const WindowSize size = state.viewport.width > 0 ? state.viewport.size() : WindowSize{16, 9};
    const Scene& scene = document.scene();
    const Camera camera = camera_of(scene, compile(scene), size.width, size.height);
    const bool automatic = !scene.camera;
    take_document(state, std::move(document), camera, automatic);
}

void save_scene(ViewerState& state, const std::filesystem::path& path) {
    save_scene(state.scene_with_view(), path);
    state.document.mark_saved(path);
}

void request_open(ViewerState& state, const std::filesystem::path& path) {
    // nobody is asked about changes for the sake of a file that cannot be opened
    try {
        if (state.document.dirty()) (void)read_scene(path, state.stop);
    } catch (const Error& error) {
        state.say_error(error.what());
        return;
    }
    ask_or_perform(state, {Pending::Kind::open, path});
}

void request_new(ViewerState& state) { ask_or_perform(state, {Pending::Kind::start_anew, {}}); }

void request_quit(ViewerState& state) { ask_or_perform(state, {Pending::Kind::quit, {}}); }

void perform(ViewerState& state, const Pending& pending) {
    try {
        switch (pending.kind) {
            case Pending::Kind::open:
                open_scene(state, pending.path);
                break;
            case Pending::Kind::start_anew:
                take_document(state, Document(), default_camera({}, 16.0 / 9), true);
                break;
            case Pending::Kind::quit:
                state.quit = true;
                break;
        }
    } catch (const Error& error) {
        state.say_error(error.what());
    }
}

bool save_and_go_on(ViewerState& state, const std::filesystem::path& path,
                    std::optional<Pending> after) {
    state.document.end_drag();
    try {
        save_scene(state, path);
    } catch (const Error& error) {
        state.say_error(error.what());
        return false;
    }
    state.say("Saved " + shown_name(path));
    if (after) perform(state, *after);
    return true;
}

void save_or_ask(ViewerState& state, std::optional<Pending> after) {
    if (state.document.path() && *state.document.path() != "-") {
        save_and_go_on(state, *state.document.path(), std::move(after));
    } else {
        browse_to_save(state, std::move(after));
    }
}

}  // namespace ivory
