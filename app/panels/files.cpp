#include "app/panels/files.h"

#include <utility>

#include "app/panels/camera_moves.h"
#include "app/panels/panels.h"
#include "core/field/field.h"
#include "core/render/camera.h"
#include "core/render/canvas.h"
#include "core/render/framing.h"
#include "core/scene/error.h"
#include "core/scene/read_file.h"
#include "core/scene/scene_json.h"
#include "core/scene/text.h"
#include "core/scene/write_file.h"

namespace ivory {

namespace {

void take_document(ViewerState& state, Document document, const DocumentView& view) {
    state.document = std::move(document);
    state.view = view;
    state.panels.number.reset();
    state.panels.text = {};
    state.panels.dragged = {};
    state.panels.row_shown.reset();
    state.panels.ranged.reset();
    state.panels.surface = {};
    state.panels.view.reset();
    // neither goes on about another document
    state.panels.file_question.reset();
    state.panels.browser.mode = FileBrowser::Mode::closed;
    state.message = {};
}

void ask_or_perform(ViewerState& state, Pending pending) {
    state.document.end_drag();
    if (!state.document.dirty()) {
        perform(state, pending);
        return;
    }
    state.panels.question = std::move(pending);
    state.panels.file_question.reset();
    state.panels.answer.reset();
    state.panels.browser.mode = FileBrowser::Mode::closed;
}

std::string shown_name(const std::filesystem::path& path) {
    return printable(path.filename().string(), 80);
}

void ask(ViewerState& state, FileQuestion question) {
    state.panels.file_question = std::move(question);
    state.panels.answer.reset();
}

void saved(ViewerState& state, const std::filesystem::path& path, std::string_view bytes,
           const std::optional<Pending>& after) {
    state.document.mark_saved(path, bytes);
    state.view.mark_saved();
    state.say("Saved " + shown_name(path));
    if (after) perform(state, *after);
}

// The scene as it is written.
std::string scene_bytes(ViewerState& state) {
    state.document.end_drag();
    return write_scene(state.scene_with_view());
}

}  // namespace

void open_scene(ViewerState& state, const std::filesystem::path& path) {
    Document document = Document::open(path, state.stop);
    const WindowSize size = state.viewport.width > 0 ? state.viewport.size() : WindowSize{16, 9};
    const Scene& scene = document.scene();
    const DocumentView view = [&] {
        try {
            const Field field = compile(scene);
            const Camera camera = camera_of(scene, field, size.width, size.height);
            const bool section = camera.is_orthographic() && !plane_is_before(camera, field.box);
            return DocumentView(camera, scene.camera, section);
        } catch (const Error& fault) {
            throw camera_fault(scene, path, fault);
        }
    }();
    take_document(state, std::move(document), view);
}

void save_scene(ViewerState& state, const std::filesystem::path& path) {
    const std::string bytes = scene_bytes(state);
    write_file(path, bytes);
    state.document.mark_saved(path, bytes);
    state.view.mark_saved();
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
                take_document(state, Document(),
                              {default_camera(compile({}), 16.0 / 9), std::nullopt});
                break;
            case Pending::Kind::quit:
                state.quit = true;
                break;
        }
    } catch (const Error& error) {
        state.say_error(error.what());
    }
}

bool save_as(ViewerState& state, const std::filesystem::path& path, std::optional<Pending> after) {
    try {
        std::error_code error;
        if (const auto kind = std::filesystem::status(path, error).type();
            kind != std::filesystem::file_type::regular &&
            kind != std::filesystem::file_type::not_found &&
            kind != std::filesystem::file_type::none)
            throw Error(file_label(path) + ": is not a file that scenes are kept in; name another");
        const std::string bytes = scene_bytes(state);
        if (!write_new_file(path, bytes)) {
            ask(state, {FileQuestion::Kind::replace, path, FileStamp::of(path), std::move(after)});
            return false;
        }
        saved(state, path, bytes, after);
        return true;
    } catch (const Error& error) {
        state.say_error(error.what());
        return false;
    }
}

bool overwrite(ViewerState& state) {
    FileQuestion question = *std::exchange(state.panels.file_question, std::nullopt);
    const std::optional<FileStamp> now = FileStamp::of(question.path);
    if (now &&
        (!question.seen || compare_with_disk(question.path, *question.seen) != OnDisk::same)) {
        question.seen = now;
        question.again = true;
        ask(state, std::move(question));
        return false;
    }
    try {
        const std::string bytes = scene_bytes(state);
        write_file(question.path, bytes);
        saved(state, question.path, bytes, question.after);
        return true;
    } catch (const Error& error) {
        state.say_error(error.what());
        return false;
    }
}

void reload(ViewerState& state) {
    state.panels.file_question.reset();
    bool differs = false;
    try {
        differs = state.document.reload();
    } catch (const Error& error) {
        state.say_error(error.what());
        return;
    }
    if (const std::optional<Camera>& camera = state.document.scene().camera) {
        set_camera(state, *camera);
        state.view.mark_saved();
    }
    state.say("Reloaded " + shown_name(*state.document.path()) +
              (differs ? "; Ctrl+Z brings back what was here" : ""));
}

void save_or_ask(ViewerState& state, std::optional<Pending> after) {
    const auto& file = state.document.path();
    if (!file || *file == "-") {
        browse_to_save(state, std::move(after));
        return;
    }
    const std::filesystem::path path = *file;
    const OnDisk on_disk = state.document.on_disk();
    if (on_disk == OnDisk::changed) {
        ask(state, {FileQuestion::Kind::changed, path, FileStamp::of(path), std::move(after)});
        return;
    }
    try {
        const std::string bytes = scene_bytes(state);
        if (on_disk == OnDisk::same) {
            write_file(path, bytes);
        } else if (!write_new_file(path, bytes)) {
            ask(state, {FileQuestion::Kind::changed, path, FileStamp::of(path), std::move(after)});
            return;
        }
        saved(state, path, bytes, after);
        if (on_disk == OnDisk::gone && !after)
            state.say("Saved " + shown_name(path) + " anew: the file had been deleted");
    } catch (const Error& error) {
        state.say_error(error.what());
    }
}

}  // namespace ivory
