#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>

#include "app/panels/actions.h"
#include "app/panels/buttons.h"
#include "app/panels/layout.h"
#include "app/panels/parts.h"
#include "app/panels/theme.h"

namespace ivory {

namespace {

// Keys that are pressed together are joined by '+', alternatives by " / ".
struct Binding {
    std::string_view keys, does;
};
struct Group {
    const char* title;
    std::span<const Binding> bindings;
};

constexpr std::array looking = {
    Binding{"Left drag", "orbit"},
    Binding{"Middle drag / Shift+Left drag", "pan"},
    Binding{"Wheel", "zoom to the pointer"},
    Binding{"Double click", "orbit around that place"},
    Binding{"Home", "frame all"},
    Binding{"F", "focus the selected element"},
    Binding{"1 / 3 / 7", "front, right, top"},
    Binding{"Ctrl+1 / 3 / 7", "back, left, bottom"},
    Binding{"5", "orthographic or perspective"},
    Binding{"Alt+Left / Alt+Right", "undo, redo a move of the camera"},
    Binding{"Ctrl+Shift+C / V", "copy, paste the camera"},
};
constexpr std::array handles = {
    Binding{"Click", "select"},
    Binding{"Left drag", "move a handle"},
    Binding{"X / Y / Z", "lock to an axis, while dragging"},
    Binding{"Shift", "finer, while dragging"},
    Binding{"Ctrl", "round numbers, while dragging"},
    Binding{"Esc / Ctrl+Z", "cancel the drag"},
    Binding{"Esc", "select nothing"},
};
constexpr std::array editing = {
    Binding{"Ctrl+Z", "undo"},      Binding{"Ctrl+Shift+Z / Ctrl+Y", "redo"},
    Binding{"Ctrl+D", "duplicate"}, Binding{"Del", "delete"},
    Binding{"H", "hide or show"},
};
constexpr std::array numbers = {
    Binding{"Left drag", "change, with Shift finer"},
    Binding{"Click / Ctrl+Click", "type exactly; also +=1, *=2"},
    Binding{"Tab", "type into the next"},
};
constexpr std::array files = {
    Binding{"Ctrl+N", "new scene"}, Binding{"Ctrl+O", "open; or drop a file"},
    Binding{"Ctrl+S", "save"},      Binding{"Ctrl+Shift+S", "save as"},
    Binding{"F12", "screenshot"},   Binding{"Ctrl+Q", "quit"},
};
constexpr std::array window = {
    Binding{"Tab", "hide or show the panels"},
    Binding{"S", "hide or show the skeleton"},
    Binding{"?", "this overview"},
};
constexpr std::array<Group, 3> left_groups = {
    {{"Looking", looking}, {"Numbers", numbers}, {"Window", window}}};
constexpr std::array<Group, 3> right_groups = {
    {{"Handles", handles}, {"Editing", editing}, {"Files", files}}};

constexpr double keys_width = 228, column_width = 440, gap = 36;  // pixels at scale 1

// A key as a cap, other words as they are; returns the x after it.
float draw_word(const ViewerState& state, ImDrawList& list, ImVec2 at, std::string_view word,
                bool cap) {
    const Palette& colors = palette(state.theme);
    const char* const begin = word.data();
    const char* const end = word.data() + word.size();
    const ImVec2 size = ImGui::CalcTextSize(begin, end);
    if (!cap) {
        list.AddText(at, packed(colors.quiet), begin, end);
        return at.x + size.x;
    }
    const float pad = px(state, 6);
    list.AddRectFilled({at.x, at.y - px(state, 2)},
                       {at.x + size.x + 2 * pad, at.y + size.y + px(state, 2)},
                       packed(colors.field_hovered), px(state, 4));
    list.AddText({at.x + pad, at.y}, packed(colors.text), begin, end);
    return at.x + size.x + 2 * pad;
}

void draw_keys(const ViewerState& state, std::string_view keys) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    ImVec2 at = ImGui::GetCursorScreenPos();
    while (!keys.empty()) {
        const std::size_t joint = std::min(keys.find('+'), keys.find(" / "));
        at.x = draw_word(state, list, at, keys.substr(0, joint), true);
        if (joint == std::string_view::npos) break;
        const bool plus = keys[joint] == '+';
        at.x = draw_word(state, list, {at.x + px(state, 4), at.y}, plus ? "+" : "/", false) +
               px(state, 4);
        keys.remove_prefix(joint + (plus ? 1 : 3));
    }
}

void draw_group(const ViewerState& state, const Group& group) {
    ImGui::PushFont(state.fonts.strong);
    ImGui::PushStyleColor(ImGuiCol_Text, palette(state.theme).accent);
    ImGui::TextUnformatted(group.title);
    ImGui::PopStyleColor();
    ImGui::PopFont();
    ImGui::Dummy({0, px(state, 2)});
    const float left = ImGui::GetCursorPosX();
    for (const Binding& binding : group.bindings) {
        draw_keys(state, binding.keys);
        ImGui::SetCursorPosX(left + px(state, keys_width));
        ImGui::TextUnformatted(binding.does.data(), binding.does.data() + binding.does.size());
        ImGui::Dummy({0, px(state, 1)});
    }
    ImGui::Dummy({0, px(state, 10)});
}

}  // namespace

void draw_help(ViewerState& state) {
    if (!state.help_shown) return;
    const auto width = static_cast<float>(state.window.width),
               height = static_cast<float>(state.window.height);
    const float pad = px(state, 28);
    // one below the other where they have no room beside each other
    const bool two_columns = px(state, 2 * column_width + gap) + 2 * pad <= 0.98f * width;
    const float columns = px(state, two_columns ? 2 * column_width + gap : column_width);
    ImGui::SetNextWindowPos({std::floor(0.5f * width), std::floor(0.5f * height)}, ImGuiCond_Always,
                            {0.5f, 0.5f});
    ImGui::SetNextWindowSizeConstraints({0, 0}, {0.98f * width, 0.98f * height});
    ImGui::SetNextWindowFocus();
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {pad, px(state, 22)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, px(state, 8));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, px(state, 1));
    ImGui::PushStyleColor(ImGuiCol_WindowBg, palette(state.theme).popup);
    ImGui::Begin("help", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoNavInputs);
    ImGui::PopStyleColor();
    ImGui::PopStyleVar(3);
    ImGui::PushFont(state.fonts.strong);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("Mouse and keys");
    ImGui::PopFont();
    ImGui::SameLine(pad + columns - ImGui::GetFrameHeight());
    if (icon_button(state, "help.close", Icon::cross, "Close   Esc")) state.help_shown = false;
    ImGui::Dummy({0, px(state, 6)});
    const float top = ImGui::GetCursorPosY();
    for (const Group& group : left_groups) draw_group(state, group);
    if (two_columns) ImGui::SetCursorPos({pad + px(state, column_width + gap), top});
    ImGui::BeginGroup();
    for (const Group& group : right_groups) draw_group(state, group);
    ImGui::EndGroup();
    const bool clicked_outside = ImGui::IsMouseClicked(ImGuiMouseButton_Left) &&
                                 !ImGui::IsWindowAppearing() &&
                                 !ImGui::IsWindowHovered(ImGuiHoveredFlags_RootAndChildWindows);
    ImGui::End();
    if (clicked_outside) state.help_shown = false;
}

}  // namespace ivory
