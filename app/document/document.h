// The scene being edited: an immutable value with a history, its file and what is selected in it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/document/file_stamp.h"
#include "core/scene/scene.h"
#include "core/scene/stop.h"

namespace ivory {

// Every change of the scene goes through `edit` (one entry of the history) or through a drag (many
// values, one entry). The view's camera is not part of it: orbiting changes the view alone.
class Document {
  public:
    using SceneValue = std::shared_ptr<const Scene>;  // never null; equal pointers, equal scenes
    using Selection = std::optional<std::size_t>;     // an index into scene().elements

    Document();  // an empty scene, without a path
    // The scene of a file. Throws Error, one line, and looks at `stop`, as `read_scene` does.
    [[nodiscard]] static Document open(const std::filesystem::path& path, const Stop& stop = {});

    // The scene as it stands, the value of a running drag included.
    [[nodiscard]] const Scene& scene() const { return *current_; }
    [[nodiscard]] SceneValue scene_value() const { return current_; }

    // A new entry of the history, called `what` ("Move point 1"); none where nothing changes.
    // A running drag is committed before. The selection stays, or becomes `selected`, where there
    // still is such an element.
    void edit(const std::string& what, Scene scene);
    void edit(const std::string& what, Scene scene, Selection selected);

    // A drag: from `begin_drag` on, `drag_to` replaces the scene without an entry; `end_drag` makes
    // one entry of it all, `cancel_drag` restores the scene that was, to the byte and the pointer.
    void begin_drag(const std::string& what);
    void drag_to(Scene scene);
    void end_drag();
    void cancel_drag();
    [[nodiscard]] bool dragging() const { return before_drag_ != nullptr; }

    // Empty where there is nothing; otherwise what would be undone or redone.
    [[nodiscard]] std::string undo_name() const;
    [[nodiscard]] std::string redo_name() const;
    // The selection comes back with the scene. False where there is nothing to undo or redo.
    bool undo();
    bool redo();

    [[nodiscard]] const std::optional<std::filesystem::path>& path() const { return path_; }
    // The scene differs from what was last opened or saved.
    [[nodiscard]] bool dirty() const { return dirty_; }
    // The scene has just been written there, as these bytes.
    void mark_saved(const std::filesystem::path& path, std::string_view bytes);
    // Whether the file at `path` still is what was last opened or saved; `same` where there is no
    // path or it stands for standard input.
    [[nodiscard]] OnDisk on_disk() const;
    // The scene of the file as it stands now, as an entry of the history: what was there before
    // comes back by undo. Not dirty then. False where it is the same scene, and no entry is made.
    // Throws Error, and nothing is changed.
    bool reload();

    // Kept valid through edits, undo and redo.
    [[nodiscard]] Selection selected() const { return selected_; }
    // An index beyond the last element selects nothing.
    void select(Selection element);

  private:
    struct Entry {
        std::string what;
        SceneValue scene;
        Selection selected;  // when the entry was last left
    };

    void set_current(SceneValue scene, Selection selected);
    void push(const std::string& what, SceneValue scene, Selection selected);
    void forget_oldest();

    std::vector<Entry> history_;  // history_[0] is the scene as opened, or the oldest that is kept
    std::size_t position_ = 0;    // the entry that stands
    SceneValue current_;
    SceneValue before_drag_;  // null where no drag runs
    std::string drag_name_;
    SceneValue saved_;
    bool dirty_ = false;
    std::optional<std::filesystem::path> path_;
    std::optional<FileStamp> stamp_;  // of the file at path_, when it was last read or written
    Selection selected_;
};

}  // namespace ivory
