// A canvas that follows a scene as it is edited: for each request it says which tiles are to be made
// anew, and leaves the others as they are. What it leaves nobody can tell from the request's
// picture; `rest` and `kept` say what is to be done until every byte is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "app/platform/window_rect.h"
#include "app/viewer/shown_picture.h"
#include "app/viewer/touched_tiles.h"
#include "core/field/field.h"
#include "core/render/canvas.h"
#include "core/render/render.h"
#include "core/scene/scene.h"

namespace ivory {

struct CanvasWork {
    Task task;
    std::vector<std::uint8_t> selected;  // by tile, not 0: to be done
    std::vector<std::uint8_t> kept;      // and these show an earlier scene's pixels until the rest

    [[nodiscard]] bool empty() const {
        return std::find(selected.begin(), selected.end(), 1) == selected.end();
    }
};

// Used by one thread; the canvas is the job's while there is one.
class EditedCanvas {
  public:
    EditedCanvas(int threads, double tolerance) : threads_(threads), tolerance_(tolerance) {}

    // From now on it is that picture's. Throws as compile and make_view do; then, as after any fault
    // of its jobs, `abandon`.
    [[nodiscard]] CanvasWork follow(const PictureRequest& request);
    // What is left of that, after a job that was cut short.
    [[nodiscard]] CanvasWork unfinished() const;
    // In tiles that see something, as they last were: those that see nothing take a fraction. Of
    // those that are selected, and of a picture of which nothing is there.
    [[nodiscard]] double effort(const std::vector<std::uint8_t>& selected) const;
    [[nodiscard]] double whole_effort() const;
    // All pixels of the tile have been traced and shaded.
    void finish(std::size_t tile) { tiles_[tile] = is_stretched_ ? Tile::kept : Tile::exact; }
    // All that was selected to be shaded has been.
    void finish_shading();
    // Its tiles are not what a canvas would be that had never seen another scene.
    [[nodiscard]] bool is_inexact() const;
    // From now on all work is that of such a canvas: there is time to compile the scene.
    void rest();
    // Its finished tiles that are not. `rest` comes first, and nothing is unfinished.
    [[nodiscard]] CanvasWork kept() const;
    // Whatever state it is in: the next picture begins with nothing.
    void abandon();

    [[nodiscard]] const Picture& picture() const { return picture_; }
    [[nodiscard]] Canvas& canvas() { return *canvas_; }
    // For Task::shade: see JobSettings.
    [[nodiscard]] const std::vector<std::uint32_t>& recolored() const { return recolored_; }

  private:
    // What a tile of the canvas shows.
    enum class Tile : std::uint8_t {
        outdated,  // something else, or not all of it
        kept,      // pixels of an earlier scene that nobody can tell from this one's
        exact,     // this scene
    };
    // What of a request is as it was in the one before.
    struct Likeness {
        bool size, view, light;
        bool places;     // of the elements: all but their colours
        bool threshold;  // where `places`
    };

    [[nodiscard]] Likeness likeness(const PictureRequest& before, const PictureRequest& now) const;
    void take_colors(const Scene& scene, bool same_light);
    [[nodiscard]] bool take_scene(const Scene* before, const Scene& scene, const Likeness& same);
    void compile_anew(const Scene& scene);
    void lay_out(WindowSize size);
    [[nodiscard]] std::optional<std::vector<std::uint8_t>> touched_since(const Scene& before);
    [[nodiscard]] double effort_of(std::size_t tile) const;

    int threads_;
    double tolerance_;
    PictureRequest request_;  // what all that follows is of
    std::unique_ptr<Canvas> canvas_;
    std::shared_ptr<Field> field_;  // that of picture_; changed while there is no job
    // Its hierarchy is not what compile would make of the scene: pictures are not final yet.
    bool is_stretched_ = false;
    double lists_threshold_ = 0;  // T for which the canvas' lists are
    Picture picture_;
    std::vector<Tile> tiles_;
    Task task_ = Task::trace_and_shade;      // what is unfinished wants
    std::vector<TileDirection> directions_;  // of picture_.view; empty: not made yet
    // Elements of picture_.field whose new colours have not come to all tiles yet, and whether
    // those and lights and background have.
    std::vector<std::uint32_t> recolored_;
    bool is_shaded_ = true;
};

}  // namespace ivory
