#include "app/panels/layout.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>

#include "app/panels/theme.h"

namespace ivory {

namespace {

constexpr float tooltip_delay = 0.5f;  // seconds
constexpr double label_width = 84;     // pixels at scale 1

}  // namespace

void tooltip(const char* text) {
    if (*text == '\0' || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
    if (GImGui->HoveredIdTimer < tooltip_delay || ImGui::IsMouseDown(ImGuiMouseButton_Left)) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 30);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

bool begin_dialog(const ViewerState& state, const char* name, float width, float height) {
    const auto window_width = static_cast<float>(state.window.width);
    const auto window_height = static_cast<float>(state.window.height);
    ImGui::SetNextWindowPos({std::floor(0.5f * window_width), std::floor(0.5f * window_height)},
                            ImGuiCond_Always, {0.5f, 0.5f});
    ImGuiWindowFlags flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                             ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                             ImGuiWindowFlags_NoNavInputs;
    if (width > 0) {
        ImGui::SetNextWindowSize(
            {std::min(width, 0.96f * window_width), std::min(height, 0.96f * window_height)});
    } else {
        flags |= ImGuiWindowFlags_AlwaysAutoResize;
    }
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(state, 24), px(state, 20)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, px(state, 8));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, px(state, 1));
    const bool drawn = ImGui::BeginPopupModal(name, nullptr, flags);
    ImGui::PopStyleVar(3);
    return drawn;
}

void section(const ViewerState& state, const char* title) {
    const Palette& colors = palette(state.theme);
    if (ImGui::GetCursorPosY() > ImGui::GetStyle().WindowPadding.y + 1) {
        const ImVec2 at = ImGui::GetCursorScreenPos();
        const float y = std::floor(at.y + px(state, 7));
        const float left = ImGui::GetWindowPos().x;
        ImGui::GetWindowDrawList()->AddLine({left, y}, {left + ImGui::GetWindowWidth(), y},
                                            packed(colors.line), px(state, 1));
        ImGui::Dummy({0, px(state, 10)});
    }
    ImGui::PushFont(state.fonts.strong);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(title);
    ImGui::PopFont();
}

void label(const ViewerState& state, const char* text) {
    ImGui::PushStyleColor(ImGuiCol_Text, palette(state.theme).quiet);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(text);
    ImGui::PopStyleColor();
    ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + px(state, label_width));
}

float field_width() { return std::max(1.0f, std::floor(ImGui::GetContentRegionAvail().x)); }

}  // namespace ivory
