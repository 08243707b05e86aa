#include "app/document/document.h"

#include <utility>

#include "core/scene/read_file.h"
#include "core/scene/scene_json.h"

namespace ivory {

namespace {

// So many elements are kept in all the scenes of the history together, about 300 MB; a scene of a
// few hundred elements can be undone ten thousand times.
constexpr std::size_t most_elements_kept = 2'000'000;

struct SceneFile {
    Document::SceneValue scene;
    std::optional<FileStamp> stamp;
};

SceneFile read_scene_file(const std::filesystem::path& path, const Stop& stop) {
    // Before it is read: what is written meanwhile is seen as a change later.
    std::optional<FileStamp> stamp = path == "-" ? std::nullopt : FileStamp::of(path);
    const std::string bytes = read_file(path, stop);
    if (stamp) stamp->set_contents(bytes);
    return {std::make_shared<const Scene>(parse_scene(bytes, file_label(path), stop)), stamp};
}

}  // namespace

Document::Document() {
    current_ = std::make_shared<const Scene>();
    saved_ = current_;
    history_.push_back({"", current_, std::nullopt});
}

Document Document::open(const std::filesystem::path& path, const Stop& stop) {
    Document document;
    const SceneFile file = read_scene_file(path, stop);
    document.current_ = file.scene;
    document.stamp_ = file.stamp;
    document.saved_ = document.current_;
    document.history_.front().scene = document.current_;
    document.path_ = path;
    return document;
}

void Document::set_current(SceneValue scene, Selection selected) {
    current_ = std::move(scene);
    dirty_ = current_ != saved_ && *current_ != *saved_;
    select(selected);
}

void Document::push(const std::string& what, SceneValue scene, Selection selected) {
    history_.resize(position_ + 1);  // what had been undone is gone
    history_.push_back({what, scene, selected});
    ++position_;
    set_current(std::move(scene), selected);
    forget_oldest();
}

void Document::forget_oldest() {
    std::size_t elements = 0;
    for (const Entry& entry : history_) elements += entry.scene->elements.size() + 1;
    std::size_t forgotten = 0;
    while (elements > most_elements_kept && forgotten + 1 < position_) {
        elements -= history_[forgotten].scene->elements.size() + 1;
        ++forgotten;
    }
    history_.erase(history_.begin(), history_.begin() + static_cast<std::ptrdiff_t>(forgotten));
    position_ -= forgotten;
}

void Document::edit(const std::string& what, Scene scene) {
    edit(what, std::move(scene), selected_);
}

void Document::edit(const std::string& what, Scene scene, Selection selected) {
    end_drag();
    if (scene == *current_) return;
    push(what, std::make_shared<const Scene>(std::move(scene)), selected);
}

void Document::begin_drag(const std::string& what) {
    end_drag();
    before_drag_ = current_;
    drag_name_ = what;
}

void Document::drag_to(Scene scene) {
    if (!dragging() || scene == *current_) return;
    set_current(
        scene == *before_drag_ ? before_drag_ : std::make_shared<const Scene>(std::move(scene)),
        selected_);
}

void Document::end_drag() {
    if (!dragging()) return;
    const SceneValue before = std::exchange(before_drag_, nullptr);
    if (current_ != before) push(drag_name_, current_, selected_);
}

void Document::cancel_drag() {
    if (dragging()) set_current(std::exchange(before_drag_, nullptr), selected_);
}

std::string Document::undo_name() const { return position_ > 0 ? history_[position_].what : ""; }

std::string Document::redo_name() const {
    return position_ + 1 < history_.size() ? history_[position_ + 1].what : "";
}

bool Document::undo() {
    end_drag();
    if (position_ == 0) return false;
    --position_;
    set_current(history_[position_].scene, history_[position_].selected);
    return true;
}

bool Document::redo() {
    end_drag();
    if (position_ + 1 >= history_.size()) return false;
    ++position_;
    set_current(history_[position_].scene, history_[position_].selected);
    return true;
}

void Document::mark_saved(const std::filesystem::path& path, std::string_view bytes) {
    path_ = path;
    stamp_ = FileStamp::of(path);
    if (stamp_) stamp_->set_contents(bytes);
    saved_ = current_;
    dirty_ = false;
}

OnDisk Document::on_disk() const {
    return path_ && stamp_ ? compare_with_disk(*path_, *stamp_) : OnDisk::same;
}

bool Document::reload() {
    end_drag();
    const SceneFile file = read_scene_file(path_.value(), {});
    stamp_ = file.stamp;
    const bool differs = *file.scene != *current_;
    if (differs) push("Reload", file.scene, selected_);
    saved_ = current_;
    dirty_ = false;
    return differs;
}

void Document::select(Selection element) {
    if (element && *element >= current_->elements.size()) element.reset();
    selected_ = element;
    history_[position_].selected = element;
}

}  // namespace ivory
