// One turn of the viewer's loop: the same in a window and in memory.
#pragma once

#include <functional>
#include <memory>
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
    int threads = 1;               // of the renderer
    double tolerance = 1e-6;       // E of the pictures, as `ivory render` has it
    std::function<void()> wake;    // called by other threads: `frame` has something new to show
    bool renderer_yields = false;  // see RenderSession::Settings
    bool hold_back_coarse = true;  // see RenderSession::poll
};

// What the last frames and edits took: the newest last, at most 256 of each.
struct ViewerTimes {
    std::vector<double> frames;  // milliseconds from input to the end of drawing
    // from the input that changed scene or view to its first picture drawn
    std::vector<double> edits;
};

class Viewer {
  public:
    // The context is current and outlives the viewer. One viewer at a time. Throws Error where
    // OpenGL lacks something.
    Viewer(Context& context, ViewerSettings settings);
    ~Viewer();
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;

    // Input in, a frame drawn into the context's buffer and presented. Never waits for the
    // renderer. Nothing is drawn while the window has no size.
    void frame(const Input& input);
    // Until it is called again: frames with nothing over the picture, neither skeleton, handles and
    // rings nor a tooltip or dialog.
    void hide_overlay(bool hidden);

    // Seconds after which a frame is wanted though nothing happens; < 0: none is.
    [[nodiscard]] double next_frame_wanted() const;
    // The scene and view that stand have no picture yet, not even a coarse one.
    [[nodiscard]] bool awaits_first_picture() const;
    // The picture that is shown is final, of the scene and view that stand.
    [[nodiscard]] bool final() const;

    [[nodiscard]] ViewerState& state();
    [[nodiscard]] const ViewportMouse& mouse() const;
    [[nodiscard]] SessionTotals totals() const;
    [[nodiscard]] const ViewerTimes& times() const;
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
