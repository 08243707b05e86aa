#include "app/panels/choice_field.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "app/panels/layout.h"
#include "app/panels/theme.h"

namespace ivory {

namespace {

// The words' widths together.
float texts_of(std::span<const Choice> choices) {
    float texts = 0;
    for (const Choice& choice : choices) texts += ImGui::CalcTextSize(choice.label).x;
    return texts;
}

std::span<const Choice> row_at(std::span<const Choice> choices, std::size_t first,
                               std::size_t columns) {
    return choices.subspan(first, std::min(columns, choices.size() - first));
}

// As many in a row as there is room for.
std::size_t columns_of(const ViewerState& state, std::span<const Choice> choices, float width) {
    std::size_t columns = choices.size();
    const auto fits = [&] {
        for (std::size_t first = 0; first < choices.size(); first += columns) {
            const auto row = row_at(choices, first, columns);
            const auto count = static_cast<float>(row.size());
            if (texts_of(row) + 2 * px(state, 4) * count > width) return false;
        }
        return true;
    };
    while (columns > 1 && !fits()) --columns;
    return columns;
}

}  // namespace

std::optional<std::size_t> choice_field(ViewerState& state, const std::string& id,
                                        std::span<const Choice> choices, std::size_t now) {
    const Palette& colors = palette(state.theme);
    const float width = field_width();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float height = ImGui::GetFrameHeight();
    const std::size_t columns = columns_of(state, choices, width);
    const std::size_t rows = (choices.size() + columns - 1) / columns;
    const float all_rows = static_cast<float>(rows) * height;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float rounding = ImGui::GetStyle().FrameRounding;
    list.AddRectFilled(at, {at.x + width, at.y + all_rows}, packed(colors.field), rounding);

    std::optional<std::size_t> clicked;
    float pad = 0;
    for (std::size_t i = 0; i < choices.size(); ++i) {
        const Choice& choice = choices[i];
        if (i % columns == 0) {
            const auto row = row_at(choices, i, columns);
            pad = (width - texts_of(row)) / (2 * static_cast<float>(row.size()));
            ImGui::SetCursorScreenPos({at.x, at.y + static_cast<float>(i / columns) * height});
        }
        const ImVec2 text = ImGui::CalcTextSize(choice.label);
        ImGui::PushID(choice.label);
        if (ImGui::InvisibleButton("##choice", {text.x + 2 * pad, height})) clicked = i;
        state.widgets.add(id + "." + choice.word, WidgetKind::button);
        const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
        if (i == now) {
            list.AddRectFilled(lo, hi, packed(colors.accent), rounding);
        } else if (ImGui::IsItemHovered()) {
            list.AddRectFilled(lo, hi, packed(colors.field_hovered), rounding);
        }
        list.AddText({std::floor(lo.x + pad), std::floor(0.5f * (lo.y + hi.y - text.y))},
                     packed(i == now ? colors.accent_text : colors.text), choice.label);
        ImGui::PopID();
        ImGui::SameLine(0, 0);
    }
    const auto whole = [](float x) { return static_cast<int>(std::floor(x)); };
    state.widgets.add(id, WidgetKind::choice,
                      {whole(at.x), whole(at.y), whole(width), whole(all_rows)});
    ImGui::NewLine();
    return clicked;
}

}  // namespace ivory
