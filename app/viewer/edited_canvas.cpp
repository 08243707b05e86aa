#include "app/viewer/edited_canvas.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/render/camera.h"
#include "core/render/shade.h"
#include "core/trace/methods/method.h"

namespace ivory {

namespace {

// Whether nothing but colours, lights, background and threshold tells the two scenes apart.
bool same_elements(const Scene& a, const Scene& b) {
    if (a.elements.size() != b.elements.size()) return false;
    for (std::size_t i = 0; i < a.elements.size(); ++i) {
        const Element &p = a.elements[i], &q = b.elements[i];
        if (!(p.skeleton == q.skeleton && p.kernel == q.kernel && p.strength == q.strength &&
              p.width == q.width && p.widths == q.widths && p.visible == q.visible))
            return false;
    }
    return true;
}

}  // namespace

CanvasWork EditedCanvas::follow(const PictureRequest& request) {
    const PictureRequest before = std::exchange(request_, request);
    const Scene& scene = *request.scene;
    const Likeness same = likeness(before, request);
    const bool whole = std::find(tiles_.begin(), tiles_.end(), Tile::outdated) == tiles_.end();
    if (same.view && same.places && same.threshold && whole) {
        take_colors(scene, same.light);
        task_ = Task::shade;
        return unfinished();
    }
    task_ = Task::trace_and_shade;

    const bool keeps_lists = take_scene(before.scene.get(), scene, same);
    if (!same.view) {
        picture_.view = make_view(request.camera);
        directions_.clear();
    }
    picture_.lighting = make_lighting(scene, picture_.view);
    picture_.method = methods().front();
    picture_.options.tolerance = tolerance_;
    if (!same.size) lay_out(request.size);
    if (!keeps_lists) canvas_->forget_lists();

    std::optional<std::vector<std::uint8_t>> touched;  // none: all
    // where the shading of new colours was cut short, tiles show old ones
    if (same.view && same.light && is_shaded_) touched = touched_since(*before.scene);
    recolored_.clear();
    is_shaded_ = true;
    for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
        if (!touched || (*touched)[tile] != 0)
            tiles_[tile] = Tile::outdated;
        else if (tiles_[tile] == Tile::exact)
            tiles_[tile] = Tile::kept;
    }
    return unfinished();
}

EditedCanvas::Likeness EditedCanvas::likeness(const PictureRequest& before,
                                              const PictureRequest& now) const {
    const Scene* const scene = before.scene.get();
    Likeness same{};
    same.size = canvas_ != nullptr && before.size == now.size;
    same.view = same.size && before.camera == now.camera;
    same.places = scene != nullptr && same_elements(*scene, *now.scene);
    same.threshold = same.places && scene->threshold == now.scene->threshold;
    same.light = scene != nullptr && scene->lights == now.scene->lights &&
                 scene->background == now.scene->background;
    return same;
}

// Every pixel stays what it hits.
void EditedCanvas::take_colors(const Scene& scene, bool same_light) {
    const std::vector<std::uint32_t> changed = recolor(*field_, scene);
    if (changed.empty() && same_light) return;  // of what is owed nothing is another
    std::vector<std::uint32_t> all;
    std::set_union(recolored_.begin(), recolored_.end(), changed.begin(), changed.end(),
                   std::back_inserter(all));
    recolored_ = std::move(all);
    is_shaded_ = false;
    picture_.lighting = make_lighting(scene, picture_.view);
}

// Makes field_ that of the scene; whether the tiles' lists, which are of the scene `before` (null:
// none), still hold.
bool EditedCanvas::take_scene(const Scene* before, const Scene& scene, const Likeness& same) {
    const bool has_field = field_ != nullptr && before != nullptr;
    // A whole picture would have to be made anew when the hand rests.
    const bool spares_rebuilding = same.view || !is_stretched_;
    const Refit refitted =
        has_field && spares_rebuilding ? refit(*field_, *before, scene) : Refit::impossible;
    if (refitted == Refit::impossible) {
        compile_anew(scene);
        return false;
    }
    is_stretched_ = is_stretched_ || refitted == Refit::stretched;
    const double share = scene.threshold / lists_threshold_;
    if (same.view && same.places && share > 0.5 && share < 2) {
        canvas_->forget_empty_lists();
        return true;
    }
    lists_threshold_ = scene.threshold;
    return false;
}

void EditedCanvas::compile_anew(const Scene& scene) {
    field_.reset();
    field_ = std::make_shared<Field>(compile(scene, threads_));
    picture_.field = field_;
    is_stretched_ = false;
    lists_threshold_ = scene.threshold;
}

void EditedCanvas::lay_out(WindowSize size) {
    canvas_.reset();  // the memory of one is enough
    canvas_ = std::make_unique<Canvas>(size.width, size.height, false, true);
    tiles_.resize(canvas_->grid.tiles.size());
}

std::optional<std::vector<std::uint8_t>> EditedCanvas::touched_since(const Scene& before) {
    if (directions_.empty()) directions_ = tile_directions(picture_.view, request_.size);
    return touched_tiles(before, *request_.scene, request_.camera.position, directions_);
}

CanvasWork EditedCanvas::unfinished() const {
    CanvasWork work{task_, std::vector<std::uint8_t>(tiles_.size()),
                    std::vector<std::uint8_t>(tiles_.size())};
    for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
        work.selected[tile] =
            task_ == Task::shade
                ? !is_shaded_ && !canvas_->stands_empty(tile, picture_.lighting.background)
                : tiles_[tile] == Tile::outdated;
        work.kept[tile] = tiles_[tile] == Tile::kept;
    }
    return work;
}

double EditedCanvas::effort_of(std::size_t tile) const {
    constexpr double of_empty = 0.1;
    return canvas_->tiles[tile].empty ? of_empty : 1;
}

double EditedCanvas::effort(const std::vector<std::uint8_t>& selected) const {
    double sum = 0;
    for (std::size_t tile = 0; tile < selected.size(); ++tile)
        if (selected[tile] != 0) sum += effort_of(tile);
    return sum;
}

double EditedCanvas::whole_effort() const {
    double sum = 0;
    for (std::size_t tile = 0; tile < tiles_.size(); ++tile) sum += effort_of(tile);
    return sum;
}

void EditedCanvas::finish_shading() {
    recolored_.clear();
    is_shaded_ = true;
}

bool EditedCanvas::is_inexact() const {
    return is_stretched_ || std::find(tiles_.begin(), tiles_.end(), Tile::kept) != tiles_.end();
}

void EditedCanvas::rest() {
    if (!is_stretched_) return;
    compile_anew(*request_.scene);
    canvas_->forget_lists();
    std::replace(tiles_.begin(), tiles_.end(), Tile::exact, Tile::kept);
}

CanvasWork EditedCanvas::kept() const {
    CanvasWork work{Task::trace_and_shade, std::vector<std::uint8_t>(tiles_.size()), {}};
    for (std::size_t tile = 0; tile < tiles_.size(); ++tile)
        work.selected[tile] = tiles_[tile] == Tile::kept;
    work.kept = work.selected;
    return work;
}

void EditedCanvas::abandon() {
    canvas_.reset();
    tiles_.clear();
    field_.reset();
}

}  // namespace ivory
