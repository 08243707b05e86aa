// One turn of the viewer's loop: the same in a window and in memory.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/panels/viewer_state.h"
#include "app/platform/context.h"
#include "app/platform/input.h"
#include "app/viewer/render_session.h"
#include "core/render/frame.h"

namespace ivory {

class ViewportMouse;

struct ViewerSettings {
    int threads = 1;                 // of the renderer
    double tolerance = 1e-6;         // E of the pictures, as `ivory render` has it
    std::function<void()> wake;      // called by other threads: `frame` has something new to show
    bool renderer_yields = false;    // see RenderSession::Settings
    double frame_budget = 1.0 / 30;  // see Viewer::set_frame_budget
};

// What the last frames and edits took: the newest last, at most 256 of each.
struct ViewerTimes {
    std::vector<double> frames;  // milliseconds from input to the end of drawing
    // from the input that changed scene or view to its first picture drawn
    std::vector<double> edits;
};

// What one frame showed. Times in milliseconds.
struct FrameRecord {
    double at = 0;    // from the viewer's beginning to the frame's input
    double took = 0;  // from there to the end of drawing
    double drew = 0;  // of that, what came after the picture was there, or was waited for no longer
    bool asked = false;  // the input wants another picture than the one before
    std::optional<double>
        age;  // of a picture that is shown first: from its input to the end of drawing
    double resolution = 1, fine = 1;  // as in PictureState
    // While a handle is held, pixels in the window: from where it is drawn to where the scene and
    // camera of the picture that is shown have it, and to where the hand has it.
    std::optional<double> handle_to_surface, handle_to_hand;
};

class Viewer {
  public:
    // The context is current and outlives the viewer. One viewer at a time. Throws Error where
    // OpenGL lacks something.
    Viewer(Context& context, ViewerSettings settings);
    ~Viewer();
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;

    // Input in, a frame drawn into the context's buffer and presented. Waits for a picture of that
    // input as long as it still can be drawn within the budget, and never for a final one. Nothing
    // is drawn while the window has no size.
    void frame(const Input& input);
    // Seconds from input to the frame that shows it, which is what pictures are made coarse for.
    void set_frame_budget(double seconds);
    // Until it is called again: frames with nothing over the picture, neither skeleton, handles and
    // rings nor a tooltip or dialog.
    void hide_overlay(bool hidden);

    // Seconds after which a frame is wanted though nothing happens; < 0: none is.
    [[nodiscard]] double next_frame_wanted() const;
    // The picture that is shown is final, of the scene and view that stand, and nothing fades.
    [[nodiscard]] bool final() const;

    [[nodiscard]] ViewerState& state();
    [[nodiscard]] const ViewportMouse& mouse() const;
    [[nodiscard]] SessionTotals totals() const;
    [[nodiscard]] const ViewerTimes& times() const;
    // The last frames, the newest last, at most 2048; and how many there were of all.
    [[nodiscard]] const std::deque<FrameRecord>& frames() const;
    [[nodiscard]] std::uint64_t frame_count() const;
    // "Ivory", the scene's file and a mark where it has changed.
    [[nodiscard]] std::string title() const;
    // The shape of pointer that ImGui or the viewport asks for.
    [[nodiscard]] Cursor cursor() const;
    // The last frame, read back from the colour buffer. No planes but `color` are set.
    [[nodiscard]] Frame read_back() const;

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace ivory
