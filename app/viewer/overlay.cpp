#include "app/viewer/overlay.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/shape/shapes.h"
#include "core/kernel/kernels.h"
#include "core/render/camera.h"
#include "core/render/shade.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

// Over a picture of any colour: light lines with a dark border, whatever the theme.
constexpr ImU32 selected_color = IM_COL32(255, 190, 92, 255);
constexpr ImU32 handle_color = IM_COL32(252, 250, 244, 255);
constexpr ImU32 border_color = IM_COL32(16, 17, 20, 210);
constexpr ImU32 label_background = IM_COL32(20, 21, 25, 225);
constexpr std::array<ImU32, 3> axis_colors = {
    IM_COL32(242, 98, 92, 255), IM_COL32(126, 208, 108, 255), IM_COL32(104, 158, 250, 255)};

// Of what lies behind the surface: light enough to follow, faint enough to tell.
constexpr float behind_alpha = 0.5f, border_behind_alpha = 0.16f;
constexpr double piece_pixels = 7;  // at scale 1: of a line between two looks at the depth
constexpr int most_pieces = 96;
// Beyond so many elements the lines of all would hide the picture, and take longer to draw than it.
constexpr std::size_t most_borders = 60, most_lines = 3'000;

ImVec2 vec(WindowPoint p) { return {static_cast<float>(p.x), static_cast<float>(p.y)}; }

ImU32 with_alpha(ImU32 color, float share) {
    const float alpha = static_cast<float>(color >> IM_COL32_A_SHIFT) * share;
    return (color & ~IM_COL32_A_MASK) | (static_cast<ImU32>(alpha + 0.5f) << IM_COL32_A_SHIFT);
}

// Its own colour, halfway to white: the surface around it has that colour too.
ImU32 line_color(const Element& element) {
    const Rgba8 c = to_srgb(element.color);
    const auto lighter = [](std::uint8_t byte) { return (byte + 2 * 255) / 3; };
    return IM_COL32(lighter(c.r), lighter(c.g), lighter(c.b), 255);
}

class Pen {
  public:
    Pen(const ViewerState& state, const SeenScene& seen, ImDrawList& list)
        : state_(state),
          seen_(seen),
          list_(list),
          px_(static_cast<float>(state.scale)),
          count_(seen.scene.elements.size()) {}

    [[nodiscard]] float px(double pixels) const { return static_cast<float>(pixels) * px_; }
    // The width of a line, in whole pixels: ImGui draws such lines with half the corners.
    [[nodiscard]] float line_width(double pixels) const {
        return std::max(1.0f, std::round(px(pixels)));
    }
    [[nodiscard]] const SeenScene& seen() const { return seen_; }
    [[nodiscard]] const Projection& view() const { return seen_.view; }

    // In the window.
    [[nodiscard]] std::optional<WindowPoint> project(const Vec3d& place) const {
        const auto at = view().project(place);
        if (!at) return std::nullopt;
        return WindowPoint{at->x + seen_.rect.x, at->y + seen_.rect.y};
    }

    // Behind the surface as the picture on the screen has it.
    [[nodiscard]] bool behind(const Vec3d& place) const {
        const auto seen = view().project(place);
        if (!seen) return false;
        // of the way; of what an orthographic camera sees, which may be far away, and of a float
        const auto depth = static_cast<double>(state_.picture.depth_at(*seen));
        const double slack = view().is_orthographic()
                                 ? 5e-4 * height_of(view().camera()) + 0x1p-22 * depth
                                 : 5e-4 * depth;
        return view().distance_to(place) > depth + slack;
    }

    void skeleton(const Element& element, bool selected) {
        const ImU32 color = selected ? selected_color : line_color(element);
        const SkeletonLines drawn = skeleton_lines(element);
        for (const SkeletonLine& line : drawn.lines) {
            if (line.size() == 1) {
                dot(line.front(), color, selected);
                continue;
            }
            run_.clear();
            pending_ = false;
            for (std::size_t i = 0; i + 1 < line.size(); ++i)
                pieces(line[i], line[i + 1], color, selected);
            flush(color, selected);
        }
        if (selected) return;
        for (const Vec3d& place : drawn.dots) dot(place, color, selected);
    }

    // A closed line of the picture.
    void ring(const PictureLine& line, bool dashed) {
        points_.clear();
        for (const WindowPoint& p : line)
            points_.push_back(vec({p.x + seen_.rect.x, p.y + seen_.rect.y}));
        if (!dashed) {
            closed_line(with_alpha(border_color, 0.5f), line_width(4));
            closed_line(with_alpha(selected_color, 0.85f), line_width(2));
            return;
        }
        for (std::size_t i = 0; i < points_.size(); i += 2)
            list_.AddLine(points_[i], points_[(i + 1) % points_.size()],
                          with_alpha(selected_color, 0.6f), px(1.4));
    }

  private:
    void closed_line(ImU32 color, float thickness) {
        list_.AddPolyline(points_.data(), static_cast<int>(points_.size()), color,
                          ImDrawFlags_Closed, thickness);
    }

    void dot(const Vec3d& place, ImU32 color, bool selected) {
        const auto at = project(place);
        if (!at || !state_.viewport.contains(*at)) return;
        const bool hidden = behind(place);
        const float alpha = hidden ? behind_alpha : 1;
        const float radius = px(selected ? 4 : 3.2);
        if (count_ > most_borders) {
            const ImVec2 p = vec(*at);
            const float half = px(1.5);
            list_.AddRectFilled({p.x - half, p.y - half}, {p.x + half, p.y + half},
                                with_alpha(color, alpha));
            return;
        }
        list_.AddCircleFilled(vec(*at), radius + px(1.3),
                              with_alpha(border_color, hidden ? border_behind_alpha : 1));
        list_.AddCircleFilled(vec(*at), radius, with_alpha(color, alpha));
    }

    // A straight line, cut where it passes behind the surface or the camera.
    void pieces(const Vec3d& a, const Vec3d& b, ImU32 color, bool selected) {
        const auto seen_a = project(a), seen_b = project(b);
        int count = most_pieces;
        if (seen_a && seen_b) {
            const double length = std::hypot(seen_a->x - seen_b->x, seen_a->y - seen_b->y);
            count = static_cast<int>(
                std::clamp(length / (piece_pixels * state_.scale), 1.0, double{most_pieces}));
        }
        auto before = seen_a;
        for (int i = 1; i <= count; ++i) {
            const double share = static_cast<double>(i) / count, middle = (i - 0.5) / count;
            const auto next = project((1 - share) * a + share * b);
            if (before && next) {
                const bool hidden = behind((1 - middle) * a + middle * b);
                if (hidden != run_behind_) flush(color, selected);
                run_behind_ = hidden;
                if (run_.empty()) run_.push_back(vec(*before));
                // short pieces, of a small circle, are drawn together
                if (pending_) run_.pop_back();
                run_.push_back(vec(*next));
                const ImVec2 from = run_[run_.size() - 2];
                pending_ = std::hypot(run_.back().x - from.x, run_.back().y - from.y) < px(4);
            } else {
                flush(color, selected);
            }
            before = next;
        }
    }

    void flush(ImU32 color, bool selected) {
        if (run_.size() >= 2) {
            const float alpha = run_behind_ ? behind_alpha : 1;
            const int count = static_cast<int>(run_.size());
            if (selected || count_ <= most_borders)
                list_.AddPolyline(
                    run_.data(), count,
                    with_alpha(border_color, run_behind_ ? border_behind_alpha : 0.8f), 0,
                    line_width(selected ? 5 : 4));
            list_.AddPolyline(run_.data(), count, with_alpha(color, alpha), 0,
                              line_width(selected ? 3 : 2));
        }
        run_.clear();
        pending_ = false;
    }

    const ViewerState& state_;
    const SeenScene& seen_;
    ImDrawList& list_;
    float px_;
    std::size_t count_;
    std::vector<ImVec2> run_, points_;  // of the line that is being drawn
    bool run_behind_ = false;
    bool pending_ = false;  // its last point is too near to the one before to stay
};

// How many widths from the skeleton the element alone reaches the threshold, F_i = T, to about 1e-12;
// -1 where its field stays below T everywhere.
double iso_widths(const Element& element, double threshold) {
    const auto field = [&](double q) {
        return element.strength * kernel_at(element.kernel, q * q).lo;
    };
    if (!(field(0) >= threshold)) return -1;
    double inside = 0, outside = 1;
    while (outside < 64 && field(outside) >= threshold) outside *= 2;
    for (int step = 0; step < 50; ++step) {
        const double middle = 0.5 * (inside + outside);
        (field(middle) >= threshold ? inside : outside) = middle;
    }
    return inside;
}

void draw_skeletons(const ViewerState& state, Pen& pen) {
    const Scene& scene = pen.seen().scene;
    const auto selected = state.document.selected();
    if (scene.elements.size() <= most_lines) {
        for (std::size_t i = 0; i < scene.elements.size(); ++i)
            if (scene.elements[i].visible && selected != i) pen.skeleton(scene.elements[i], false);
    }
    if (!selected || *selected >= scene.elements.size()) return;
    const Element& element = scene.elements[*selected];
    // Alone it is seen where F_i = T; one too weak for that, or carving, is hinted at by its width.
    const double widths = iso_widths(element, scene.threshold);
    for (const PictureLine& line : outline_of(pen.view(), element, widths > 0 ? widths : 1))
        pen.ring(line, !(widths > 0) || !element.visible);
    pen.skeleton(element, true);
}

void draw_handle(const Pen& pen, const Handle& handle, bool hovered, bool held, ImDrawList& list) {
    const ImVec2 at = vec(handle.at);
    const ImU32 fill = held || hovered ? selected_color : handle_color;
    const float radius = pen.px(held || hovered ? 7.5 : 5.5), border = pen.px(1.6);
    if (held || hovered)
        list.AddCircleFilled(at, pen.px(grab_radius + 1), with_alpha(selected_color, 0.28f));
    if (std::hypot(handle.at.x - handle.seen.x, handle.at.y - handle.seen.y) > 1)
        list.AddLine(at, vec(handle.seen), with_alpha(handle_color, 0.7f), pen.px(1));

    if (handle.kind == GripKind::whole) {
        const float half = 0.88f * radius;
        list.AddRectFilled({at.x - half - border, at.y - half - border},
                           {at.x + half + border, at.y + half + border}, border_color, pen.px(2.5));
        list.AddRectFilled({at.x - half, at.y - half}, {at.x + half, at.y + half}, fill,
                           pen.px(1.5));
    } else if (handle.kind == GripKind::length) {
        const float half = 1.2f * radius;
        list.AddNgonFilled(at, half + border * 1.3f, border_color, 4);
        list.AddNgonFilled(at, half, fill, 4);
    } else {
        list.AddCircleFilled(at, radius + border, border_color);
        list.AddCircleFilled(at, radius, fill);
    }
    if (handle.kind == GripKind::place || handle.kind == GripKind::direction) {
        // its element's colour in the middle
        const Rgba8 c = to_srgb(pen.seen().scene.elements[handle.element].color);
        list.AddCircleFilled(at, 0.45f * radius, IM_COL32(c.r, c.g, c.b, 255));
    }
}

// From a handle to those that stand out from it.
void draw_arms(const Pen& pen, const std::vector<Handle>& handles, ImDrawList& list) {
    for (const Handle& handle : handles) {
        const auto foot = std::find_if(handles.begin(), handles.end(), [&](const Handle& other) {
            return other.name == handle.arm;
        });
        if (foot == handles.end()) continue;
        const ImVec2 a = vec(foot->seen), b = vec(handle.seen);
        list.AddLine(a, b, with_alpha(border_color, 0.6f), pen.px(3.4));
        list.AddLine(a, b, with_alpha(handle_color, 0.85f), pen.px(1.4));
    }
}

void draw_locked_axis(const ViewerState& state, const Pen& pen, const Vec3d& place, int axis,
                      ImDrawList& list) {
    // long enough to leave the viewport on both sides, as far as it lies before the camera
    const double reach =
        pen.view().length_of_pixel(place) * 4 * (state.viewport.width + state.viewport.height);
    Vec3d direction;
    direction[static_cast<std::size_t>(axis)] = 1;
    for (const double side : {-1.0, 1.0}) {
        std::optional<WindowPoint> end;
        for (double share = 1; !end && share > 1e-3; share /= 2)
            end = pen.project(place + (side * share * reach) * direction);
        const auto start = pen.project(place);
        if (!start || !end) continue;
        list.AddLine(vec(*start), vec(*end), with_alpha(border_color, 0.5f), pen.px(3));
        list.AddLine(vec(*start), vec(*end), axis_colors[static_cast<std::size_t>(axis)],
                     pen.px(1.4));
    }
}

// Few digits, enough to follow a drag by.
std::string short_number(double value, double pixel) {
    const double digits = std::floor(std::log10(pixel));
    const double power = std::pow(10.0, std::clamp(-digits, 0.0, 12.0));
    return number_text(std::round(value * power) / power + 0.0);
}

std::string drag_label(const ViewportMouse& mouse, const Handle& handle, const Pen& pen) {
    const double pixel = pen.view().length_of_pixel(handle.place);
    if (const auto* length = std::get_if<double>(&handle.value))
        return handle.part + " " + short_number(*length, pixel);
    const bool is_direction = handle.kind == GripKind::direction;
    const auto& value = std::get<Vec3d>(handle.value);
    if (const auto axis = mouse.locked_axis()) {
        const auto k = static_cast<std::size_t>(*axis);
        const double by = handle.place[k] - mouse.grabbed_from()[k];
        const std::string change = short_number(by, pixel);
        return std::string(1, "XYZ"[k]) + "  " + short_number(value[k], pixel) +
               (is_direction ? "" : "  (" + std::string(by >= 0 ? "+" : "") + change + ")");
    }
    return short_number(value.x, pixel) + ",  " + short_number(value.y, pixel) + ",  " +
           short_number(value.z, pixel);
}

void draw_label(const ViewerState& state, const Pen& pen, const std::string& text,
                WindowPoint beside, ImDrawList& list) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const float pad = pen.px(7), gap = pen.px(18);
    const WindowRect& viewport = state.viewport;
    const auto left = static_cast<float>(viewport.x), top = static_cast<float>(viewport.y);
    const float right = left + static_cast<float>(viewport.width);
    ImVec2 at = vec(beside);
    at.x += gap;
    at.y -= gap + size.y;
    if (at.x + size.x + 2 * pad > right) at.x -= 2 * gap + size.x + 2 * pad;
    at.x = std::floor(std::max(at.x, left + pad));
    at.y = std::floor(std::max(at.y, top + pad));
    list.AddRectFilled({at.x - pad, at.y - 0.6f * pad},
                       {at.x + size.x + pad, at.y + size.y + 0.6f * pad}, label_background,
                       pen.px(5));
    list.AddText(at, handle_color, text.c_str());
}

}  // namespace

std::optional<Handle> held_handle(const SeenScene& seen, const Handle& grabbed) {
    if (seen.stands) return grabbed;
    for (Handle& handle : handles_of(seen, grabbed.element)) {
        if (handle.name != grabbed.name) continue;
        handle.at = handle.seen;
        return std::move(handle);
    }
    return std::nullopt;
}

void draw_overlay(const ViewerState& state, const SeenScene& seen, const ViewportMouse& mouse,
                  ImDrawList& list) {
    Pen pen(state, seen, list);
    draw_skeletons(state, pen);
    const auto selected = state.document.selected();
    if (!selected) return;

    if (!mouse.grabbed()) {
        const std::vector<Handle> handles = handles_of(seen, *selected);
        draw_arms(pen, handles, list);
        for (const Handle& handle : handles) {
            const bool hovered = mouse.hovered() && mouse.hovered()->name == handle.name;
            draw_handle(pen, handle, hovered, false, list);
        }
        return;
    }
    if (mouse.locked_axis())
        draw_locked_axis(state, pen, mouse.grabbed_from(), *mouse.locked_axis(), list);
    const std::optional<Handle> grabbed = held_handle(seen, *mouse.grabbed());
    if (!grabbed) return;
    std::vector<Handle> handles = handles_of(seen, grabbed->element);
    for (Handle& handle : handles)
        if (handle.name == grabbed->name) handle = *grabbed;
    draw_arms(pen, handles, list);
    for (const Handle& handle : handles)
        if (handle.name != grabbed->name) draw_handle(pen, handle, false, false, list);
    draw_handle(pen, *grabbed, false, true, list);
    if (state.document.dragging())
        draw_label(state, pen, drag_label(mouse, *grabbed, pen), grabbed->at, list);
}

}  // namespace ivory
