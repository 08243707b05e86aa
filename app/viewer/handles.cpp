#include "app/viewer/handles.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>

#include "app/panels/camera_moves.h"
#include "app/shape/shapes.h"
#include "app/viewer/picking.h"
#include "core/math/direction.h"
#include "core/scene/scene_fault.h"

namespace ivory {

namespace {

constexpr double click_slack = 4;          // pixels at scale 1 that a click may move
constexpr double double_click_time = 0.4;  // seconds from press to press
constexpr double skeleton_radius = 9;      // pixels at scale 1 from which a skeleton is clicked
constexpr double fine = 0.1;               // of the pointer's way, with Shift
constexpr double wheel_pause = 0.6;        // seconds after which a turn of the wheel is another one

double distance(WindowPoint a, WindowPoint b) { return std::hypot(a.x - b.x, a.y - b.y); }

WindowPoint in_picture(const ViewerState& state, WindowPoint at) {
    return {at.x - state.viewport.x, at.y - state.viewport.y};
}

// Where a handle at `seen` can stand apart from those before it.
WindowPoint free_place(const std::vector<Handle>& before, WindowPoint seen,
                       const WindowRect& viewport, double scale) {
    const double apart = 2 * grab_radius * scale;
    const auto is_free = [&](WindowPoint at) {
        return viewport.contains(at) &&
               std::all_of(before.begin(), before.end(),
                           [&](const Handle& other) { return distance(other.at, at) >= apart; });
    };
    if (is_free(seen)) return seen;
    for (const double ring : {1.3, 2.4, 3.5}) {
        for (int turn = 0; turn < 8; ++turn) {
            const double angle = turn * 0.7853981633974483;  // pi / 4
            const WindowPoint at{std::round(seen.x + ring * apart * std::cos(angle)),
                                 std::round(seen.y + ring * apart * std::sin(angle))};
            if (is_free(at)) return at;
        }
    }
    return seen;
}

std::optional<int> axis_of(Key key) {
    if (key == Key::x) return 0;
    if (key == Key::y) return 1;
    if (key == Key::z) return 2;
    return std::nullopt;
}

// Escape, and Ctrl+Z: what it would undo is not done yet.
bool cancels(const KeyPress& press) {
    const Modifiers& with = press.modifiers;
    if (with.alt || with.super) return false;
    // while Shift and Ctrl are held for the drag, too
    return press.key == Key::escape || (press.key == Key::z && with.control && !with.shift);
}

// The length of arrow to go by: nothing where the normal's own length serves.
std::optional<double> arrow_of(const SeenScene& seen, std::size_t element) {
    const auto& kept = seen.arrow;
    if (!kept || kept->element != element) return std::nullopt;
    const HandView view{seen.view, seen.scale};
    for (const Grip& grip : grips_of(view, seen.scene.elements[element]))
        if (grip.kind == GripKind::direction && std::get<Vec3d>(grip.value) == kept->normal)
            return kept->length;
    return std::nullopt;
}

}  // namespace

SeenScene as_it_stands(const ViewerState& state) {
    return {
        state.document.scene(), state.projection(), state.viewport, state.scale, state.arrow, true};
}

std::vector<Handle> handles_of(const SeenScene& seen, std::size_t element) {
    std::vector<Handle> handles;
    if (element >= seen.scene.elements.size()) return handles;
    const HandView view{seen.view, seen.scale, arrow_of(seen, element)};
    for (Grip& grip : grips_of(view, seen.scene.elements[element])) {
        const auto in_view = view.projection.project(grip.place);
        if (!in_view) continue;
        const WindowPoint at{in_view->x + seen.rect.x, in_view->y + seen.rect.y};
        if (!seen.rect.contains(at)) continue;
        const WindowPoint free = free_place(handles, at, seen.rect, seen.scale);
        handles.push_back({std::move(grip), element, free, at});
    }
    return handles;
}

std::vector<Handle> handles_of(const ViewerState& state, std::size_t element) {
    return handles_of(as_it_stands(state), element);
}

void ViewportMouse::follow(ViewerState& state, const Input& input) {
    if (does_ != Does::drag || !state.document.dragging()) return;
    drag(state, input);
    last_ = input.mouse;
}

void ViewportMouse::update(ViewerState& state, const Input& input) {
    clock_ += input.elapsed;
    if (clock_ - wheeled_when_ > wheel_pause) end_wheel(state);
    // the drag was ended by something else: another document was opened
    if (does_ == Does::drag && !state.document.dragging()) let_go();

    const bool has_moved = input.mouse != last_;
    if (does_ == Does::grab) {
        begin_drag(state);
        if (does_ == Does::drag) drag(state, input);  // from now on `follow` does it
    } else if (has_moved) {
        move(state, input);
    }
    hover(state, input);
    if (does_ == Does::nothing) {
        press(state, input);
    } else if (!input.down(button_)) {
        release(state);
        hover(state, input);
    }
    const bool free = !ImGui::GetIO().WantCaptureMouse && input.mouse_inside &&
                      state.viewport.contains(input.mouse);
    if (input.wheel != 0 && free && (does_ == Does::nothing || does_ == Does::press)) {
        drag_camera(state, zoomed(state.projection(), in_picture(state, input.mouse), input.wheel));
        wheel_gesture_ = state.view.gesture();
        wheeled_when_ = clock_;
    }

    last_ = input.mouse;
    was_down_ = input.mouse_down;
    if (does_ == Does::drag || does_ == Does::grab || does_ == Does::pan)
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeAll);
    else if (hovered_)
        ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
}

void ViewportMouse::hover(const ViewerState& state, const Input& input) {
    hovered_.reset();
    if (grabbed_ || does_ != Does::nothing) return;
    if (!state.skeleton_shown || !state.document.selected() || !input.mouse_inside) return;
    if (ImGui::GetIO().WantCaptureMouse || !state.viewport.contains(input.mouse)) return;
    double least = grab_radius * state.scale;
    for (Handle& handle : handles_of(state, *state.document.selected())) {
        const double away = distance(handle.at, input.mouse);
        if (away > least) continue;
        least = away;
        hovered_ = std::move(handle);
    }
}

void ViewportMouse::press(ViewerState& state, const Input& input) {
    const auto pressed = [&](MouseButton button) {
        return input.down(button) && !was_down_[static_cast<std::size_t>(button)];
    };
    if (!pressed(MouseButton::left) && !pressed(MouseButton::middle)) return;
    if (ImGui::GetIO().WantCaptureMouse || !state.viewport.contains(input.mouse)) return;

    end_wheel(state);
    button_ = pressed(MouseButton::left) ? MouseButton::left : MouseButton::middle;
    if (button_ == MouseButton::middle) {
        does_ = Does::pan;
    } else if (hovered_) {
        does_ = Does::grab;
        grabbed_ = std::exchange(hovered_, std::nullopt);
    } else if (input.modifiers.shift) {
        does_ = Does::pan;
    } else {
        does_ = Does::press;
    }
    again_ = button_ == MouseButton::left && clicked_before_ &&
             clock_ - pressed_when_ <= double_click_time &&
             distance(pressed_at_, input.mouse) <= click_slack * state.scale;
    clicked_before_ = false;
    pressed_at_ = input.mouse;
    pressed_when_ = clock_;
}

void ViewportMouse::begin_drag(ViewerState& state) {
    const Scene& scene = state.document.scene();
    if (grabbed_->element >= scene.elements.size()) {
        let_go();
        return;
    }
    // What was typed into a field may just have been taken over: the handle is where it is now.
    for (const Handle& handle : handles_of(state, grabbed_->element))
        if (handle.name == grabbed_->name) grabbed_ = handle;
    start_ = scene.elements[grabbed_->element];
    arrow_ = arrow_of(as_it_stands(state), grabbed_->element);
    if (grabbed_->kind == GripKind::direction && !arrow_) {
        arrow_ = length_of(std::get<Vec3d>(grabbed_->value));
    }
    grabbed_from_ = grabbed_->place;
    grabbed_at_ = grabbed_->at;
    dx_ = dy_ = 0;
    round_ = false;
    axis_.reset();
    does_ = Does::drag;
    state.document.begin_drag(
        change_name(grabbed_->kind, grabbed_->part, element_names(scene)[grabbed_->element]));
}

void ViewportMouse::move(ViewerState& state, const Input& input) {
    const double dx = input.mouse.x - last_.x, dy = input.mouse.y - last_.y;
    switch (does_) {
        case Does::press:
            if (distance(pressed_at_, input.mouse) <= click_slack * state.scale) return;
            does_ = Does::orbit;
            end_wheel(state);
            drag_camera(state, orbited(state.projection(), input.mouse.x - pressed_at_.x,
                                       input.mouse.y - pressed_at_.y));
            return;
        case Does::orbit:
            drag_camera(state, orbited(state.projection(), dx, dy));
            return;
        case Does::pan:
            drag_camera(state, panned(state.projection(), dx, dy));
            return;
        case Does::nothing:
        case Does::grab:
        case Does::drag:
        case Does::ignore:
            return;
    }
}

void ViewportMouse::drag(ViewerState& state, const Input& input) {
    bool changed = input.mouse != last_;
    for (const KeyPress& press : input.pressed) {
        if (press.repeated) continue;
        if (cancels(press)) {
            state.document.cancel_drag();
            let_go();
            return;
        }
        // Shift and Ctrl are the drag's own, but Ctrl+X is no X
        const Modifiers& with = press.modifiers;
        if (with.control || with.alt || with.super) continue;
        if (const auto axis = axis_of(press.key)) {
            axis_ = axis_ == axis ? std::nullopt : axis;
            changed = true;
        }
    }
    changed = changed || round_ != input.modifiers.control;
    round_ = input.modifiers.control;
    if (!changed) return;

    const double share = input.modifiers.shift ? fine : 1;
    dx_ += share * (input.mouse.x - last_.x);
    dy_ += share * (input.mouse.y - last_.y);
    const HandView view{state.projection(), state.scale, arrow_};
    auto moved = moved_by(view, start_, grabbed_->name, {dx_, dy_, axis_, round_});
    if (!moved) return;
    if (find_fault(*moved)) return;  // a normal of length 0, a place beyond all doubles

    for (Grip& grip : grips_of(view, *moved))
        if (grip.name == grabbed_->name) static_cast<Grip&>(*grabbed_) = std::move(grip);
    // what was moved aside stays so far beside its place
    const auto seen = view.projection.project(grabbed_->place),
               seen_before = view.projection.project(grabbed_from_);
    if (seen && seen_before) {
        grabbed_->seen = {seen->x + state.viewport.x, seen->y + state.viewport.y};
        grabbed_->at = {grabbed_at_.x + seen->x - seen_before->x,
                        grabbed_at_.y + seen->y - seen_before->y};
    }
    if (grabbed_->kind == GripKind::direction)
        state.arrow = KeptArrow{grabbed_->element, std::get<Vec3d>(grabbed_->value), *arrow_};
    Scene scene = state.document.scene();
    scene.elements[grabbed_->element] = std::move(*moved);
    state.document.drag_to(std::move(scene));
}

void ViewportMouse::release(ViewerState& state) {
    switch (std::exchange(does_, Does::nothing)) {
        case Does::press:
            if (again_) {
                center_orbit(state);
            } else {
                clicked_before_ = true;
                click(state);
            }
            break;
        case Does::drag:
            state.document.end_drag();
            // the first click selected, and so brought a handle under the pointer
            if (again_ && dx_ == 0 && dy_ == 0) center_orbit(state);
            break;
        case Does::orbit:
        case Does::pan:
            state.view.end_move();
            break;
        case Does::nothing:
        case Does::grab:
        case Does::ignore:
            break;
    }
    grabbed_.reset();
    axis_.reset();
}

void ViewportMouse::end_wheel(ViewerState& state) {
    if (wheel_gesture_ != 0 && wheel_gesture_ == state.view.gesture()) state.view.end_move();
    wheel_gesture_ = 0;
}

void ViewportMouse::let_go() {
    grabbed_.reset();
    axis_.reset();
    does_ = Does::ignore;
}

void ViewportMouse::click(ViewerState& state) {
    const Scene& scene = state.document.scene();
    const Projection view = state.projection();
    const WindowPoint at = in_picture(state, pressed_at_);
    auto picked = pick_surface(scene, view, at);
    if (!picked && state.skeleton_shown)
        picked = pick_skeleton(scene, view, at, skeleton_radius * state.scale);
    state.document.select(picked ? std::optional(picked->element) : std::nullopt);
}

void ViewportMouse::center_orbit(ViewerState& state) const {
    const Projection view = state.projection();
    const auto picked = pick_surface(state.document.scene(), view, in_picture(state, pressed_at_));
    if (picked) move_camera(state, centred(view, *picked->place));
}

}  // namespace ivory
