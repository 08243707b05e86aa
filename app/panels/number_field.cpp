#include "app/panels/number_field.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <utility>
#include <variant>

#include "app/document/tidy.h"
#include "app/panels/layout.h"
#include "app/panels/scene_edits.h"
#include "app/panels/text_field.h"
#include "app/panels/theme.h"
#include "app/panels/typed_number.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

constexpr double drag_slack = 3;  // pixels at scale 1 before a press is a drag
constexpr double fine = 0.1;      // of the way, with Shift

bool item_is_disabled() { return (ImGui::GetItemFlags() & ImGuiItemFlags_Disabled) != 0; }

std::string rounded_number(double value, int digits) {
    std::array<char, 40> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "%.*g", digits, value);
    return buffer.data();
}

// The shortest decimal that is exactly the value, or as many of its digits as are to be shown and fit.
std::string fitted_number(const NumberField& field, float width) {
    std::string text = number_text(field.value);
    if (field.digits) {
        const std::string few = rounded_number(field.value, *field.digits);
        if (few.size() < text.size()) text = few;
    }
    for (int digits = 9; digits >= 2 && ImGui::CalcTextSize(text.c_str()).x > width; --digits)
        text = rounded_number(field.value, digits);
    return text;
}

// --- it is being typed into ---

void open_typing(ViewerState& state, const NumberField& field) {
    const std::string text = number_text(field.value);
    state.panels.number = TypedNumber{field.id, text, text};
}

void take_typed(ViewerState& state, const NumberField& field, const SetNumber& set) {
    const TypedNumber typed = *std::exchange(state.panels.number, std::nullopt);
    if (typed.text == typed.before) return;
    const auto value = parse_number(typed.text, field.value);
    if (!value) {
        state.say_error(in_quotes(typed.text) + " is not a number; " + number_text(field.value) +
                        " stays");
        return;
    }
    if (*value == field.value) return;  // in other words
    if (const auto* const in_scene = std::get_if<SetInScene<double>>(&set))
        edit_scene(state, field.what, [&](Scene& scene) { (*in_scene)(scene, *value); });
    else
        edit_camera(state,
                    [&](Camera& camera) { std::get<SetInCamera<double>>(set)(camera, *value); });
}

void typed_number(ViewerState& state, const NumberField& field, float width, const SetNumber& set) {
    TypedNumber& typed = *state.panels.number;
    typed.drawn = true;
    if (!typed.focused) ImGui::SetKeyboardFocusHere();
    typed.focused = true;
    ImGui::SetNextItemWidth(width);
    input_text("##typed", "", typed.text, ImGuiInputTextFlags_AutoSelectAll);
    state.widgets.add(field.id, WidgetKind::number);
    const bool active = ImGui::IsItemActive();
    ++typed.frames;
    if (active && plain_key_pressed(ImGuiKey_Tab)) {
        take_typed(state, field, set);
        state.panels.type_next = true;
    } else if (ImGui::IsItemDeactivated() || (!active && typed.frames > 3)) {
        take_typed(state, field, set);
    }
}

// --- it can be dragged ---

void begin_drag(ViewerState& state, const NumberField& field, const SetNumber& set) {
    if (std::holds_alternative<SetInScene<double>>(set))
        begin_field_drag(state, field.id, field.what);
    else
        begin_camera_field_drag(state, field.id);
}

void drag_to(ViewerState& state, const SetNumber& set, double value) {
    if (const auto* const in_scene = std::get_if<SetInScene<double>>(&set))
        drag_field(state, [&](Scene& scene) { (*in_scene)(scene, value); });
    else
        drag_camera_field(
            state, [&](Camera& camera) { std::get<SetInCamera<double>>(set)(camera, value); });
}

// From a press to its release: a drag, or a click that opens the field.
void follow_drag(ViewerState& state, const NumberField& field, const SetNumber& set, bool hovered,
                 bool active) {
    DraggedField& drag = state.panels.dragged;
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsItemActivated()) drag = {field.id, field.value, 0, io.MousePos.x, false, false};
    if (active && drag.id == field.id && !drag.cancelled) {
        const auto slack = static_cast<float>(drag_slack * state.scale);
        if (!drag.begun && ImGui::IsMouseDragging(ImGuiMouseButton_Left, slack)) {
            begin_drag(state, field, set);
            drag.start = field.value;  // an undo since the press has changed it
        }
        if (drag.begun && io.MousePos.x != drag.last_x) {
            drag.way += (io.KeyShift ? fine : 1) * static_cast<double>(io.MousePos.x - drag.last_x);
            const double step = io.KeyShift ? fine * field.step : field.step;
            const double value = tidy(drag.start + drag.way / state.scale * field.step,
                                      exponent_above(step * 0.999));
            const double within = std::clamp(value, field.least, field.greatest);
            drag_to(state, set, within);
        }
        drag.last_x = io.MousePos.x;
    }
    if (ImGui::IsItemDeactivated() && drag.id == field.id) {
        const bool was_click = !drag.begun && !drag.cancelled && hovered;
        end_field_drag(state);
        if (was_click) open_typing(state, field);
    }
}

void draw_number(const ViewerState& state, const NumberField& field, float width, bool hovered,
                 bool active) {
    const Palette& colors = palette(state.theme);
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec4& background = active    ? colors.field_active
                               : hovered ? colors.field_hovered
                                         : colors.field;
    const float alpha = item_is_disabled() ? ImGui::GetStyle().DisabledAlpha : 1;
    const float rounding = ImGui::GetStyle().FrameRounding;
    list.AddRectFilled(lo, hi, packed(background, alpha), rounding);
    if (field.axis) {
        const ImVec4& mark = *field.axis == 0 ? colors.x : *field.axis == 1 ? colors.y : colors.z;
        list.AddRectFilled(lo, {lo.x + px(state, 3), hi.y}, packed(mark, alpha), rounding,
                           ImDrawFlags_RoundCornersLeft);
    }
    const std::string text = fitted_number(field, width - px(state, field.axis ? 17 : 14));
    const ImVec2 extent = ImGui::CalcTextSize(text.c_str());
    const float left = field.axis ? px(state, 3) : 0;
    const float x = std::floor(lo.x + left + 0.5f * (hi.x - lo.x - left - extent.x));
    list.PushClipRect(lo, hi, true);
    list.AddText({x, std::floor(0.5f * (lo.y + hi.y - extent.y))}, packed(colors.text, alpha),
                 text.c_str());
    list.PopClipRect();
    if (const std::string whole = number_text(field.value); whole != text) tooltip(whole.c_str());
}

void dragged_number(ViewerState& state, const NumberField& field, float width,
                    const SetNumber& set) {
    ImGui::InvisibleButton("##number", {width, ImGui::GetFrameHeight()});
    state.widgets.add(field.id, WidgetKind::number);
    const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
    if (hovered || active) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    follow_drag(state, field, set, hovered, active);
    draw_number(state, field, width, hovered, active);
}

}  // namespace

double step_in_scene(const ViewerState& state) {
    const double length =
        state.projection().length_of_pixel(state.view.camera.target) * state.scale;
    const double exponent = std::round(std::log10(length));
    return std::isfinite(exponent) ? std::pow(10.0, exponent) : 0.01;
}

void number_field(ViewerState& state, const NumberField& field, float width, const SetNumber& set) {
    PanelMemory& memory = state.panels;
    ImGui::PushID(field.id.c_str());
    const bool enabled = !item_is_disabled();
    const bool typing = memory.number && memory.number->id == field.id;
    const ImVec2 lo = ImGui::GetCursorScreenPos();
    const ImVec2 hi{lo.x + width, lo.y + ImGui::GetFrameHeight()};
    const bool ctrl_clicked =
        ImGui::IsMouseClicked(ImGuiMouseButton_Left) && ImGui::GetIO().KeyCtrl &&
        ImGui::IsMouseHoveringRect(lo, hi) &&
        ImGui::IsWindowHovered(ImGuiHoveredFlags_AllowWhenBlockedByActiveItem);
    if (!typing && enabled && (ctrl_clicked || memory.type_next)) {
        open_typing(state, field);
        memory.type_next = false;
    }
    if (memory.number && memory.number->id == field.id) {
        typed_number(state, field, width, set);
    } else {
        dragged_number(state, field, width, set);
    }
    ImGui::PopID();
}

void vector_fields(ViewerState& state, const std::string& id, const std::string& what,
                   const Vec3d& value, double step, const SetVector& set) {
    const float spacing = px(state, 4);
    const float third = std::floor((field_width() - 2 * spacing) / 3);
    // far from the origin a third of the line has no room for what a drag changes
    bool one_line = true;
    for (int axis = 0; axis < 3; ++axis) {
        const double seen =
            tidy(value[static_cast<std::size_t>(axis)], exponent_above(step * 0.999));
        const float text = ImGui::CalcTextSize(number_text(seen).c_str()).x;
        one_line = one_line && (text <= third - px(state, 17) || std::abs(seen) < 1e4);
    }
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        if (axis > 0 && one_line) ImGui::SameLine(0, spacing);
        if (axis > 0 && !one_line) label(state, "");
        // the last takes what rounding left
        const float width = axis < 2 && one_line ? third : field_width();
        const NumberField field{
            .id = id + "." + "xyz"[k], .what = what, .value = value[k], .step = step, .axis = axis};
        const auto with = [&](double number) {
            Vec3d changed = value;
            changed[k] = number;
            return changed;
        };
        if (const auto* const in_scene = std::get_if<SetInScene<Vec3d>>(&set))
            number_field(state, field, width,
                         [&](Scene& scene, double number) { (*in_scene)(scene, with(number)); });
        else
            number_field(state, field, width, [&](Camera& camera, double number) {
                std::get<SetInCamera<Vec3d>>(set)(camera, with(number));
            });
    }
}

}  // namespace ivory
