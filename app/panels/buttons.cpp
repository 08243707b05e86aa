#include "app/panels/buttons.h"

#include <imgui.h>

#include "app/panels/layout.h"
#include "app/panels/theme.h"

namespace ivory {

bool toggle(ViewerState& state, const std::string& id, const char* text, bool on) {
    ImGui::PushID(id.c_str());
    const bool clicked = ImGui::Checkbox(text, &on);
    state.widgets.add(id, WidgetKind::toggle, clicked ? !on : on);
    ImGui::PopID();
    return clicked;
}

bool icon_button(ViewerState& state, const std::string& id, Icon icon, const char* hint,
                 bool enabled, bool on) {
    const Palette& colors = palette(state.theme);
    ImGui::BeginDisabled(!enabled);
    ImGui::PushID(id.c_str());
    const float side = ImGui::GetFrameHeight();
    const bool clicked = ImGui::InvisibleButton("##icon", {side, side});
    state.widgets.add(id, WidgetKind::button);
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float rounding = ImGui::GetStyle().FrameRounding;
    if (ImGui::IsItemActive()) {
        list.AddRectFilled(lo, hi, packed(colors.field_active), rounding);
    } else if (ImGui::IsItemHovered()) {
        list.AddRectFilled(lo, hi, packed(colors.field_hovered), rounding);
    }
    const float alpha = enabled ? 1 : ImGui::GetStyle().DisabledAlpha;
    draw_icon(list, icon, {0.5f * (lo.x + hi.x), 0.5f * (lo.y + hi.y)}, 0.52f * side,
              packed(on ? colors.accent : colors.text, alpha));
    ImGui::PopID();
    ImGui::EndDisabled();
    tooltip(hint);
    return clicked;
}

bool text_button(ViewerState& state, const std::string& id, const char* text, float width,
                 bool enabled, bool strong) {
    const Palette& colors = palette(state.theme);
    ImGui::BeginDisabled(!enabled);
    if (strong) {
        ImGui::PushStyleColor(ImGuiCol_Button, colors.accent);
        ImGui::PushStyleColor(ImGuiCol_ButtonHovered, colors.accent);
        ImGui::PushStyleColor(ImGuiCol_ButtonActive, colors.accent);
        ImGui::PushStyleColor(ImGuiCol_Text, colors.accent_text);
    }
    ImGui::PushID(id.c_str());
    const bool clicked = ImGui::Button(text, {width, 0});
    state.widgets.add(id, WidgetKind::button);
    ImGui::PopID();
    if (strong) ImGui::PopStyleColor(4);
    ImGui::EndDisabled();
    return clicked;
}

}  // namespace ivory
