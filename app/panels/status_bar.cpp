#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>

#include "app/panels/buttons.h"
#include "app/panels/layout.h"
#include "app/panels/parts.h"
#include "app/panels/shown_text.h"
#include "app/panels/theme.h"

namespace ivory {

namespace {

// 1234567 -> "1,234,567"
std::string grouped(std::uint64_t number) {
    std::string text = std::to_string(number);
    for (std::ptrdiff_t at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3)
        text.insert(static_cast<std::size_t>(at), ",");
    return text;
}

std::string shown_time(double milliseconds) {
    std::array<char, 32> text{};
    if (milliseconds < 10) {
        std::snprintf(text.data(), text.size(), "%.1f ms", milliseconds);
    } else if (milliseconds < 10'000) {
        std::snprintf(text.data(), text.size(), "%.0f ms", milliseconds);
    } else {
        std::snprintf(text.data(), text.size(), "%.1f s", milliseconds / 1000);
    }
    return text.data();
}

// A value and what it is, then room.
void figure(const ViewerState& state, const std::string& value, const char* what) {
    const Palette& colors = palette(state.theme);
    if (*what != '\0') {
        ImGui::PushStyleColor(ImGuiCol_Text, colors.quiet);
        ImGui::TextUnformatted(what);
        ImGui::PopStyleColor();
        ImGui::SameLine(0, px(state, 6));
    }
    ImGui::TextUnformatted(value.c_str());
    ImGui::SameLine(0, px(state, 20));
}

void draw_progress(const ViewerState& state) {
    const Palette& colors = palette(state.theme);
    const PictureState& picture = state.picture;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = px(state, 90), height = px(state, 4);
    const float y = std::floor(at.y + 0.5f * (ImGui::GetFontSize() - height));
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled({at.x, y}, {at.x + width, y + height}, packed(colors.field_active),
                       0.5f * height);
    const auto done = static_cast<float>(picture.final ? 1 : picture.progress);
    if (done > 0)
        list.AddRectFilled({at.x, y}, {at.x + std::max(width * done, height), y + height},
                           packed(picture.final ? colors.y : colors.accent), 0.5f * height);
    ImGui::Dummy({width, ImGui::GetFontSize()});
    ImGui::SameLine(0, px(state, 10));
    std::string text = "Final";
    if (!picture.fault.empty()) {
        text = "Not final";
    } else if (!picture.final && picture.progress >= 1) {
        text = "Smoothing";
    } else if (!picture.final) {
        text = "Refining " + std::to_string(static_cast<int>(100 * picture.progress)) + " %";
    }
    const float start = ImGui::GetCursorPosX();
    ImGui::TextUnformatted(text.c_str());
    ImGui::SameLine(start + px(state, 96));
}

void draw_figures(const ViewerState& state) {
    const PictureState& picture = state.picture;
    draw_progress(state);
    // at the right of its place, so that nothing beside it moves with its length
    const std::string time = shown_time(picture.milliseconds);
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + ImGui::CalcTextSize("8888 ms").x -
                         ImGui::CalcTextSize(time.c_str()).x);
    figure(state, time, "");
    figure(state, grouped(picture.hit), "hit");
    figure(state, grouped(picture.miss), "miss");
    figure(state, grouped(picture.unresolved), "unresolved");
    tooltip(
        "Pixels where the surface is proved, is proved not to be, and where neither could be "
        "proved.");
    figure(state, std::to_string(picture.threads), picture.threads == 1 ? "thread" : "threads");
    const std::string size =
        std::to_string(state.viewport.width) + " \xC3\x97 " + std::to_string(state.viewport.height);
    const float x = ImGui::GetWindowWidth() - px(state, 14) - ImGui::CalcTextSize(size.c_str()).x;
    if (x > ImGui::GetCursorPosX()) {
        ImGui::SameLine(std::floor(x));
        ImGui::TextDisabled("%s", size.c_str());
    }
}

// What the hand on a number or a handle can do besides; nullptr: there is none.
const char* hint(const ViewerState& state) {
    if (state.panels.number)
        return "Enter  set        Tab  the next        +=1  *=2  change by        Esc  leave";
    if (state.panels.dragged.begun) return "Shift  finer        Esc  cancel";
    if (state.document.dragging())
        return "X  Y  Z  along an axis        Shift  finer        Ctrl  round numbers        Esc  "
               "cancel";
    return nullptr;
}

void draw_hint(const ViewerState& state, const char* text) {
    draw_progress(state);
    ImGui::PushStyleColor(ImGuiCol_Text, palette(state.theme).quiet);
    ImGui::TextUnformatted(text);
    ImGui::PopStyleColor();
}

void draw_message_text(ViewerState& state) {
    const Palette& colors = palette(state.theme);
    const float side = ImGui::GetFrameHeight();
    const float right = ImGui::GetWindowWidth() - px(state, 8) - (state.message.error ? side : 0);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float left = ImGui::GetCursorPosX();
    const float room = std::max(right - left - px(state, 6), 1.0f);
    ImGui::GetWindowDrawList()->AddText(
        at, packed(state.message.error ? colors.error_text : colors.text),
        fitted_text(state.message.text, room).c_str());
    ImGui::Dummy({room, ImGui::GetFontSize()});
    tooltip(state.message.text.c_str());
    if (!state.message.error) return;
    ImGui::SameLine();
    ImGui::SetCursorPos({right, std::floor(0.5f * (ImGui::GetWindowHeight() - side))});
    if (icon_button(state, "error.close", Icon::cross, "Close")) state.message = {};
}

}  // namespace

int status_bar_height(const ViewerState& state) {
    return static_cast<int>(std::lround(30 * state.scale));
}

void draw_status_bar(ViewerState& state, const WindowRect& rect) {
    const Palette& colors = palette(state.theme);
    const float pad = std::floor(0.5f * (static_cast<float>(rect.height) - ImGui::GetFontSize()));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(state, 14), pad});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, state.message.error ? colors.error_bar : colors.bar);
    begin_panel("status bar", rect,
                ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
    ImGui::PopStyleColor();
    ImGui::PopStyleVar();
    const char* const what_else = hint(state);
    if (state.message.error || (!state.message.text.empty() && what_else == nullptr)) {
        draw_message_text(state);
    } else if (what_else != nullptr) {
        draw_hint(state, what_else);
    } else {
        draw_figures(state);
    }
    ImGui::End();
}

void draw_message(ViewerState& state) {
    if (state.message.text.empty()) return;
    const int height = status_bar_height(state);
    draw_status_bar(state, {0, state.window.height - height, state.window.width, height});
}

}  // namespace ivory
