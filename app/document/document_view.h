// The view of a document: its camera, and the cameras that were left, to come back to.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/scene/scene.h"

namespace ivory {

// Not part of the document, but saved with it. Its moves are undone apart from edits, one gesture at a
// time: what changes between the first `move_on` and `end_move` is one entry.
class DocumentView {
  public:
    DocumentView() = default;
    // As it is opened: `saved` is what the file says.
    DocumentView(const Camera& the_camera, std::optional<Camera> saved, bool section = false)
        : camera(the_camera), automatic(!saved), is_section(section), saved_(std::move(saved)) {}

    // To be read; changed by the functions below, or without an entry: where an automatic view is made
    // anew and where the camera changes but not what it sees.
    Camera camera{{0, 0, 8}, {0, 0, 0}};
    // The file had no camera and the view has not been touched: as long as the scene has not been
    // edited either, Viewer frames it, anew for each size of the viewport.
    bool automatic = true;
    // An orthographic camera's plane cuts the surface, and somebody wrote it so. Any other one's is kept
    // before the surface.
    bool is_section = false;

    // A gesture goes on, or begins. Nothing where the camera is that already.
    void move_on(const Camera& to, bool section = false);
    void end_move();
    // The camera is again what it was before the gesture, and nothing has happened.
    void cancel_move();
    // At once, after the end of a gesture that may run.
    void move_to(const Camera& to);

    // The number of the gesture that runs; 0: none does.
    [[nodiscard]] std::size_t gesture() const { return before_ ? gestures_ : 0; }

    [[nodiscard]] bool can_undo() const { return before_ || !left_.empty(); }
    [[nodiscard]] bool can_redo() const { return !before_ && !undone_.empty(); }
    // Ends a running gesture. False where there is nothing to undo or redo.
    bool undo();
    bool redo();

    // The camera is what the file has, or nobody has chosen it.
    [[nodiscard]] bool is_saved() const { return automatic || camera == saved_; }
    void mark_saved() { saved_ = camera; }

  private:
    struct Place {
        Camera camera;
        bool automatic = false, is_section = false;
    };

    [[nodiscard]] Place here() const { return {camera, automatic, is_section}; }
    void go(const Place& to);

    std::vector<Place> left_, undone_;  // the last one last
    std::optional<Place> before_;       // the gesture that runs
    std::size_t gestures_ = 0;          // begun so far
    std::optional<Camera> saved_;
};

}  // namespace ivory
