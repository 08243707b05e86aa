#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/panels/actions.h"
#include "app/panels/buttons.h"
#include "app/panels/layout.h"
#include "app/panels/names.h"
#include "app/panels/parts.h"
#include "app/panels/shown_text.h"
#include "app/panels/theme.h"
#include "app/shape/shapes.h"
#include "core/render/shade.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

constexpr double row_height = 28;  // pixels at scale 1
constexpr const char* dragged_row = "row";

// Of the sign on a button that adds a shape, and of the gap to its name; pixels at scale 1.
constexpr double sign_side = 11, sign_gap = 5;

float sign_and_name_width(const ViewerState& state, Shape shape) {
    const std::string label = with_shape(shape, []<class S>() { return std::string(S::label); });
    return px(state, sign_side + sign_gap) + ImGui::CalcTextSize(label.c_str()).x;
}

// A button that adds: the shape's sign and its name.
void add_button(ViewerState& state, Shape shape, float width) {
    const auto [word, label] = with_shape(shape, []<class S>() {
        return std::pair{std::string(S::word), std::string(S::label)};
    });
    const Palette& colors = palette(state.theme);
    const bool clicked = text_button(state, "add." + word, "", width);
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    tooltip(("Add " + std::string(with_article(shape))).c_str());
    const float side = px(state, sign_side), gap = px(state, sign_gap);
    const float middle = 0.5f * (lo.y + hi.y), height = ImGui::GetFontSize();
    const float x = std::floor(0.5f * (lo.x + hi.x - sign_and_name_width(state, shape)));
    ImDrawList& list = *ImGui::GetWindowDrawList();
    draw_icon(list, shape, {x + 0.5f * side, middle}, side, packed(colors.accent));
    list.AddText({x + side + gap, std::floor(middle - 0.5f * height)}, packed(colors.text),
                 label.c_str());
    if (clicked) add_element(state, shape);
}

// In rows of three: each column has the room that its longest name needs, and a third of what is left.
void draw_add_buttons(ViewerState& state) {
    constexpr std::size_t columns = 3;
    const float spacing = px(state, 4);
    std::array<float, columns> widths{};
    for (std::size_t i = 0; i < shape_count; ++i) {
        float& width = widths[i % columns];
        width = std::max(width, sign_and_name_width(state, static_cast<Shape>(i)));
    }
    const float needed = std::accumulate(widths.begin(), widths.end(), (columns - 1) * spacing);
    const float more = (field_width() - needed) / columns;
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding,
                        {px(state, 4), ImGui::GetStyle().FramePadding.y});
    for (std::size_t i = 0; i < shape_count; ++i) {
        const std::size_t column = i % columns;
        if (column > 0) ImGui::SameLine(0, spacing);
        const bool is_last = column + 1 == columns;
        add_button(state, static_cast<Shape>(i),
                   is_last ? field_width() : std::floor(widths[column] + more));
    }
    ImGui::PopStyleVar();
}

// Rows can be dragged to another place of the list.
void drag_and_drop(ViewerState& state, std::size_t row) {
    if (ImGui::BeginDragDropSource(ImGuiDragDropFlags_SourceNoPreviewTooltip)) {
        ImGui::SetDragDropPayload(dragged_row, &row, sizeof(row));
        ImGui::EndDragDropSource();
    }
    if (ImGui::BeginDragDropTarget()) {
        const ImGuiPayload* const payload =
            ImGui::AcceptDragDropPayload(dragged_row, ImGuiDragDropFlags_AcceptNoDrawDefaultRect |
                                                          ImGuiDragDropFlags_AcceptBeforeDelivery);
        if (payload != nullptr) {
            const std::size_t from = *static_cast<const std::size_t*>(payload->Data);
            const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
            const float y = from < row ? hi.y : lo.y;
            ImGui::GetWindowDrawList()->AddLine({lo.x, y}, {hi.x, y},
                                                packed(palette(state.theme).accent), px(state, 2));
            if (payload->IsDelivery()) move_element(state, from, row);
        }
        ImGui::EndDragDropTarget();
    }
}

void draw_row(ViewerState& state, std::size_t row, float width) {
    const Palette& colors = palette(state.theme);
    // by value: a click may change the scene
    const Element element = state.document.scene().elements[row];
    const std::string name = names_of(state)[row];
    const float height = px(state, row_height);
    const bool selected = state.document.selected() == row;

    ImGui::PushID(static_cast<int>(row));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    if (selected) {
        list.AddRectFilled(at, {at.x + width, at.y + height}, packed(colors.selected_row),
                           px(state, 4));
    } else if (ImGui::IsWindowHovered() &&
               ImGui::IsMouseHoveringRect(at, {at.x + width, at.y + height})) {
        list.AddRectFilled(at, {at.x + width, at.y + height}, packed(colors.hovered_row),
                           px(state, 4));
    }
    const bool clicked = ImGui::InvisibleButton("##row", {width - height, height});
    state.widgets.add("row." + name, WidgetKind::row);
    if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left))
        state.panels.name_wanted = true;
    drag_and_drop(state, row);

    const float alpha = element.visible ? 1 : 0.45f;
    const float middle = at.y + 0.5f * height;
    const Rgba8 c = to_srgb(element.color);
    const ImU32 swatch = ImGui::ColorConvertFloat4ToU32({static_cast<float>(c.r) / 255,
                                                         static_cast<float>(c.g) / 255,
                                                         static_cast<float>(c.b) / 255, alpha});
    list.AddCircleFilled({at.x + px(state, 14), middle}, px(state, 5.5), swatch);
    draw_icon(list, shape_of_skeleton(element.skeleton), {at.x + px(state, 34), middle},
              px(state, 12), packed(colors.quiet, alpha));
    const float text_left = at.x + px(state, 48);
    const std::string whole_name = shown_text(state, printable(name, 200));
    const std::string shown = fitted_text(whole_name, at.x + width - height - text_left);
    list.AddText({text_left, std::floor(middle - 0.5f * ImGui::GetFontSize())},
                 packed(colors.text, alpha), shown.c_str());
    if (shown != whole_name) tooltip(whole_name.c_str());

    ImGui::SameLine(0, 0);
    const bool eye_clicked = ImGui::InvisibleButton("##eye", {height, height});
    state.widgets.add("row." + name + ".visible", WidgetKind::toggle, element.visible);
    const bool lit = ImGui::IsItemHovered() || !element.visible || selected;
    draw_icon(list, element.visible ? Icon::eye : Icon::eye_closed,
              {at.x + width - 0.5f * height, middle}, px(state, 15),
              packed(ImGui::IsItemHovered() ? colors.text : colors.quiet, lit ? 1 : 0.55f));
    tooltip(element.visible ? "Hide" : "Show");
    ImGui::PopID();

    if (clicked) state.document.select(row);
    if (eye_clicked) set_visible(state, row, !element.visible);
}

// Rows out of sight are where they would be drawn: `first` is the place of the first one.
Widgets::Search rows_out_of_sight(ViewerState& state, ImVec2 first, float width, float height) {
    const ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec2 lo = list.GetClipRectMin(), hi = list.GetClipRectMax();
    const auto whole = [](float x) { return static_cast<int>(std::floor(x)); };
    const WindowRect clip{whole(lo.x), whole(lo.y), whole(hi.x - lo.x), whole(hi.y - lo.y)};
    return [=, &state](const std::string& id) -> std::optional<Widget> {
        const std::string prefix = "row.", suffix = ".visible";
        if (!id.starts_with(prefix)) return std::nullopt;
        std::string name = id.substr(prefix.size());
        auto row = place_of(state, name);
        const bool eye = !row && name.ends_with(suffix);
        if (eye) {
            name.resize(name.size() - suffix.size());
            row = place_of(state, name);
        }
        if (!row || *row >= state.document.scene().elements.size()) return std::nullopt;
        const float y = first.y + static_cast<float>(*row) * height;
        if (!eye)
            return Widget{WidgetKind::row,
                          {whole(first.x), whole(y), whole(width - height), whole(height)},
                          clip,
                          false,
                          true};
        return Widget{WidgetKind::toggle,
                      {whole(first.x + width - height), whole(y), whole(height), whole(height)},
                      clip,
                      state.document.scene().elements[*row].visible,
                      true};
    };
}

void scroll_to_selected(ViewerState& state, float height) {
    const auto selected = state.document.selected();
    if (state.panels.row_shown == selected) return;
    state.panels.row_shown = selected;
    if (!selected) return;
    const float top = static_cast<float>(*selected) * height;
    const float room = ImGui::GetWindowHeight();
    if (top < ImGui::GetScrollY()) ImGui::SetScrollY(top);
    if (top + height > ImGui::GetScrollY() + room) ImGui::SetScrollY(top + height - room);
}

void draw_rows(ViewerState& state, float list_height) {
    ImGui::BeginChild("rows", {0, list_height}, false,
                      ImGuiWindowFlags_NoNavInputs | ImGuiWindowFlags_NoNavFocus);
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
    const float height = px(state, row_height);
    const float width = field_width();
    const std::size_t count = state.document.scene().elements.size();
    if (count == 0) {
        ImGui::PushStyleColor(ImGuiCol_Text, palette(state.theme).quiet);
        ImGui::TextWrapped("An empty scene. Add %s to begin.", one_of_all_shapes().c_str());
        ImGui::PopStyleColor();
    }
    scroll_to_selected(state, height);
    const ImVec2 start = ImGui::GetCursorScreenPos();
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(count), height);
    while (clipper.Step())
        for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row)
            if (static_cast<std::size_t>(row) < state.document.scene().elements.size())
                draw_row(state, static_cast<std::size_t>(row), width);
    state.widgets.set_out_of_sight(rows_out_of_sight(state, start, width, height));
    ImGui::PopStyleVar();
    ImGui::EndChild();
}

void draw_row_buttons(ViewerState& state) {
    const auto selected = state.document.selected();
    const std::size_t count = state.document.scene().elements.size();
    const bool first = selected == std::size_t{0};
    const bool last = selected && *selected + 1 == count;
    if (icon_button(state, "element.up", Icon::up, "Move up", selected && !first))
        move_element(state, *selected, *selected - 1);
    ImGui::SameLine(0, px(state, 2));
    if (icon_button(state, "element.down", Icon::down, "Move down", selected && !last))
        move_element(state, *selected, *selected + 1);
    const float side = ImGui::GetFrameHeight();
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - 2 * side - px(state, 2));
    if (icon_button(state, "element.duplicate", Icon::copy, "Duplicate   Ctrl+D",
                    selected.has_value()))
        run(state, Action::duplicate);
    ImGui::SameLine(0, px(state, 2));
    if (icon_button(state, "element.delete", Icon::trash, "Delete   Del", selected.has_value()))
        run(state, Action::remove);
}

}  // namespace

void draw_scene_panel(ViewerState& state, const WindowRect& rect) {
    begin_panel("scene", rect, ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
    section(state, "Elements");
    const std::size_t count = state.document.scene().elements.size();
    if (count > 0) {
        const std::string number = std::to_string(count);
        ImGui::SameLine(ImGui::GetWindowContentRegionMax().x -
                        ImGui::CalcTextSize(number.c_str()).x);
        ImGui::TextDisabled("%s", number.c_str());
    }
    draw_add_buttons(state);
    ImGui::Dummy({0, px(state, 2)});
    const float below = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemSpacing.y;
    draw_rows(state, std::max(px(state, row_height), ImGui::GetContentRegionAvail().y - below));
    draw_row_buttons(state);
    ImGui::End();
}

}  // namespace ivory
