// Handles: the places of a skeleton that can be grabbed in the viewport, and the drag of one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "app/document/orbit.h"
#include "app/panels/viewer_state.h"
#include "app/platform/input.h"
#include "app/shape/shape_in_hand.h"
#include "core/scene/scene.h"

namespace ivory {

// One degree of freedom to grab.
struct Handle : Grip {
    std::size_t element = 0;
    WindowPoint at;    // in the window, frame-buffer pixels; within the viewport
    WindowPoint seen;  // where its place in the scene is seen: `at`, unless it was moved aside
};

// Pixels at scale 1 around a handle within which it can be grabbed; handles stand twice that apart.
inline constexpr double grab_radius = 11;

// A scene as it is seen in a rectangle of the window: as it stands, or as of the picture that is shown.
struct SeenScene {
    const Scene& scene;
    Projection view;
    WindowRect rect;  // of view.size()
    double scale;
    const std::optional<KeptArrow>& arrow;
    bool stands;  // it is the one that stands
};
[[nodiscard]] SeenScene as_it_stands(const ViewerState& state);

// The handles of one element that lie in the rectangle, or in the viewport. No two of them hide one another:
// where two would fall together (a circle's normal seen along itself) the later one is moved aside, to the
// first free place of eight around it, beginning at the right and going down.
[[nodiscard]] std::vector<Handle> handles_of(const SeenScene& seen, std::size_t element);
[[nodiscard]] std::vector<Handle> handles_of(const ViewerState& state, std::size_t element);

// The mouse in the viewport: orbit, pan, zoom, pick, hover, and a handle's drag with axis lock (X,
// Y, Z, again to unlock), Shift for fine, Ctrl for round numbers and Escape to cancel. One object
// for the life of the viewer.
class ViewportMouse {
  public:
    // Before draw_panels: a handle that is held goes where the pointer is, so that fields and overlay
    // show the same scene.
    void follow(ViewerState& state, const Input& input);
    // After draw_panels, before draw_overlay; only what no panel takes (ImGui's WantCaptureMouse).
    void update(ViewerState& state, const Input& input);
    // A handle is held: keys X, Y, Z and Escape belong to the drag.
    [[nodiscard]] bool dragging_handle() const { return grabbed_.has_value(); }
    // Where it is now.
    [[nodiscard]] const std::optional<Handle>& grabbed() const { return grabbed_; }
    [[nodiscard]] const std::optional<Handle>& hovered() const { return hovered_; }
    [[nodiscard]] std::optional<int> locked_axis() const { return axis_; }
    // Of the drag: where the handle was when it was grabbed.
    [[nodiscard]] const Vec3d& grabbed_from() const { return grabbed_from_; }

  private:
    enum class Does : std::uint8_t {
        nothing,
        press,  // left, not yet moved: a click or an orbit
        orbit,
        pan,
        grab,    // a handle is held since this frame; text fields first take what was typed
        drag,    // a handle
        ignore,  // until the button is let go
    };

    void press(ViewerState& state, const Input& input);
    void move(ViewerState& state, const Input& input);
    void release(ViewerState& state);
    void hover(const ViewerState& state, const Input& input);
    void begin_drag(ViewerState& state);
    void drag(ViewerState& state, const Input& input);
    void let_go();
    void click(ViewerState& state);
    void center_orbit(ViewerState& state) const;
    void end_wheel(ViewerState& state);

    std::optional<Handle> grabbed_, hovered_;
    std::optional<int> axis_;

    Does does_ = Does::nothing;
    MouseButton button_ = MouseButton::left;  // the one that began it
    std::array<bool, mouse_button_count> was_down_{};
    WindowPoint pressed_at_, last_;
    double clock_ = 0, pressed_when_ = -1;  // seconds
    bool clicked_before_ = false;           // the last press was a click's
    bool again_ = false;                    // this one makes it a double click
    double wheeled_when_ = 0;
    std::size_t wheel_gesture_ = 0;  // the move of the camera that turns of the wheel are part of

    Element start_;  // of the drag
    Vec3d grabbed_from_;
    WindowPoint grabbed_at_;  // the handle's, in the window
    double dx_ = 0, dy_ = 0;  // of the drag, pixels; with Shift fewer than the pointer's
    bool round_ = false;
    std::optional<double> arrow_;  // the length that a normal's arrow goes by
};

}  // namespace ivory
