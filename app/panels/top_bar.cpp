#include <imgui.h>

#include <cmath>
#include <string>

#include "app/panels/actions.h"
#include "app/panels/buttons.h"
#include "app/panels/layout.h"
#include "app/panels/parts.h"
#include "app/panels/theme.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

void menu_entry(ViewerState& state, const ActionInfo& action) {
    const std::string label = label_of(state, action.action) + "      ###" + action.id;
    const bool on = is_on(state, action.action);
    const bool switches = action.action == Action::orthographic ||
                          action.action == Action::skeleton || action.action == Action::theme ||
                          action.action == Action::panels || action.action == Action::help;
    const bool possible = is_possible(state, action.action);
    ImGui::BeginDisabled(!possible);
    const bool chosen = ImGui::MenuItem(label.c_str(), action.keys, on);
    state.widgets.add(action.id, switches ? WidgetKind::toggle : WidgetKind::button, on);
    ImGui::EndDisabled();
    if (chosen) run(state, action.action);
    if (action.ends_with_separator) ImGui::Separator();
}

void menu(ViewerState& state, const char* id, const char* label) {
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {px(state, 12), px(state, 8)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(state, 12), px(state, 10)});
    const bool open = ImGui::BeginMenu(label);
    if (open) {
        const std::string prefix = std::string(id) + ".";
        for (const ActionInfo& action : all_actions())
            if (std::string(action.id).starts_with(prefix)) menu_entry(state, action);
        ImGui::EndMenu();
    }
    ImGui::PopStyleVar(2);
    state.widgets.add(id, WidgetKind::menu);
}

void tool(ViewerState& state, const char* id, Icon icon, Action action) {
    const ActionInfo& about = info(action);
    std::string hint = label_of(state, action);
    if (*about.keys != '\0') hint += std::string("   ") + about.keys;
    if (icon_button(state, id, icon, hint.c_str(), is_possible(state, action),
                    is_on(state, action)))
        run(state, action);
    ImGui::SameLine(0, px(state, 2));
}

void view_tool(ViewerState& state, const char* id, const char* label, Action action) {
    const ActionInfo& about = info(action);
    ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0, 0, 0, 0));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding,
                        {px(state, 7), ImGui::GetStyle().FramePadding.y});
    if (text_button(state, id, label)) run(state, action);
    ImGui::PopStyleVar();
    ImGui::PopStyleColor();
    tooltip((std::string(about.label) + " view   " + about.keys).c_str());
    ImGui::SameLine(0, px(state, 2));
}

void divider(const ViewerState& state, float y) {
    ImGui::SameLine(0, px(state, 10));
    ImGui::SetCursorPosY(y);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float height = ImGui::GetFrameHeight();
    ImGui::GetWindowDrawList()->AddLine({at.x, at.y + 0.15f * height},
                                        {at.x, at.y + 0.85f * height},
                                        packed(palette(state.theme).line), px(state, 1));
    ImGui::Dummy({px(state, 1), height});
    ImGui::SameLine(0, px(state, 10));
}

void draw_tools(ViewerState& state, float y) {
    divider(state, y);
    tool(state, "toolbar.undo", Icon::undo, Action::undo);
    tool(state, "toolbar.redo", Icon::redo, Action::redo);
    divider(state, y);
    tool(state, "toolbar.frame_all", Icon::frame, Action::frame_all);
    view_tool(state, "toolbar.front", "Front", Action::front);
    view_tool(state, "toolbar.right", "Right", Action::right);
    view_tool(state, "toolbar.top", "Top", Action::top);
    tool(state, "toolbar.orthographic", Icon::orthographic, Action::orthographic);
    divider(state, y);
    tool(state, "toolbar.skeleton", Icon::skeleton, Action::skeleton);
    tool(state, "toolbar.theme", Icon::theme, Action::theme);
}

void draw_file_name(const ViewerState& state) {
    const auto& path = state.document.path();
    const Palette& colors = palette(state.theme);
    const std::string name = path ? printable(path->filename().string(), 60) : "untitled";
    // a dot for changes that are not saved, a ring for the view alone
    const bool dirty = state.document.dirty(), unsaved_view = path && !state.view.is_saved();
    const float dot = dirty || unsaved_view ? px(state, 14) : 0;
    const float width = ImGui::CalcTextSize(name.c_str()).x + dot;
    const float x = ImGui::GetWindowWidth() - px(state, 14) - width;
    if (x < ImGui::GetCursorPosX()) return;
    ImGui::SetCursorPos({std::floor(x + dot), 0});
    const ImVec2 middle{std::floor(x) + px(state, 4),
                        0.5f * static_cast<float>(top_bar_height(state))};
    ImDrawList& list = *ImGui::GetWindowDrawList();
    if (dirty)
        list.AddCircleFilled(middle, px(state, 3.5), packed(colors.accent));
    else if (unsaved_view)
        list.AddCircle(middle, px(state, 3.2), packed(colors.accent), 0, px(state, 1.3));
    ImGui::TextUnformatted(name.c_str());
    if (!path) return;
    const std::string whole = printable(path->string(), 400);
    tooltip(
        (unsaved_view ? whole + "\nThe view is not saved; Ctrl+S saves it too." : whole).c_str());
}

}  // namespace

int top_bar_height(const ViewerState& state) {
    return static_cast<int>(std::lround(40 * state.scale));
}

void draw_top_bar(ViewerState& state) {
    const Palette& colors = palette(state.theme);
    const int height = top_bar_height(state);
    const auto room = static_cast<float>(height);
    // ImGui's menu bar is as high as one line of text and its padding
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding,
                        {px(state, 8), std::floor(0.5f * (room - ImGui::GetFontSize()))});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(state, 6), 0});
    begin_panel("top bar", {0, 0, state.window.width, height},
                ImGuiWindowFlags_MenuBar | ImGuiWindowFlags_NoScrollbar |
                    ImGuiWindowFlags_NoScrollWithMouse);
    const bool drawn = ImGui::BeginMenuBar();
    ImGui::PopStyleVar(2);
    if (drawn) {
        menu(state, "file", "File");
        menu(state, "edit", "Edit");
        menu(state, "view", "View");
        menu(state, "help", "Help");
        draw_tools(state, std::floor(0.5f * (room - ImGui::GetFrameHeight())));
        draw_file_name(state);
        const float bottom = room - 0.5f * px(state, 1);
        ImGui::GetWindowDrawList()->AddLine({0, bottom},
                                            {static_cast<float>(state.window.width), bottom},
                                            packed(colors.line), px(state, 1));
        ImGui::EndMenuBar();
    }
    ImGui::End();
}

}  // namespace ivory
