#include "app/panels/theme.h"

#include <cmath>

#include "app/panels/panels.h"

namespace ivory {

namespace {

// 0xRRGGBB
ImVec4 rgb(unsigned hex, float alpha = 1) {
    const auto part = [&](unsigned shift) {
        return static_cast<float>(hex >> shift & 0xFFu) / 255.0f;
    };
    return {part(16), part(8), part(0), alpha};
}

Palette dark() {
    Palette p;
    p.bar = rgb(0x191B20);
    p.panel = rgb(0x1E2127);
    p.popup = rgb(0x22262D);
    p.field = rgb(0x2E333C);
    p.field_hovered = rgb(0x383E49);
    p.field_active = rgb(0x434A56);
    p.line = rgb(0x363B43);
    p.text = rgb(0xE8E6E1);
    p.quiet = rgb(0x9FA3AB);
    p.accent = rgb(0xE3B366);
    p.accent_text = rgb(0x1B1710);
    p.selected_row = rgb(0xE3B366, 0.20f);
    p.hovered_row = rgb(0xFFFFFF, 0.055f);
    p.error_bar = rgb(0x5A2226);
    p.error_text = rgb(0xFFE3DE);
    p.x = rgb(0xE0645C);
    p.y = rgb(0x7FBF6A);
    p.z = rgb(0x6C9CE8);
    return p;
}

Palette light() {
    Palette p;
    p.bar = rgb(0xEAE6DD);
    p.panel = rgb(0xF5F2EB);
    p.popup = rgb(0xFCFAF6);
    p.field = rgb(0xE4DFD4);
    p.field_hovered = rgb(0xDAD4C6);
    p.field_active = rgb(0xCFC8B8);
    p.line = rgb(0xD2CCBF);
    p.text = rgb(0x26241F);
    p.quiet = rgb(0x67635A);
    p.accent = rgb(0xB9791B);
    p.accent_text = rgb(0xFFFDF8);
    p.selected_row = rgb(0xB9791B, 0.22f);
    p.hovered_row = rgb(0x000000, 0.05f);
    p.error_bar = rgb(0xF3CDC7);
    p.error_text = rgb(0x5B1410);
    p.x = rgb(0xB8352C);
    p.y = rgb(0x3C7D2B);
    p.z = rgb(0x2D5FB4);
    return p;
}

}  // namespace

const Palette& palette(Theme theme) {
    static const Palette of_dark = dark(), of_light = light();
    return theme == Theme::dark ? of_dark : of_light;
}

void apply_theme(Theme theme, double scale) {
    const Palette& p = palette(theme);
    ImGuiStyle style;
    if (theme == Theme::dark) {
        ImGui::StyleColorsDark(&style);
    } else {
        ImGui::StyleColorsLight(&style);
    }

    style.WindowPadding = {12, 10};
    style.FramePadding = {8, 4};
    style.ItemSpacing = {6, 5};
    style.ItemInnerSpacing = {6, 4};
    style.CellPadding = {4, 3};
    style.IndentSpacing = 16;
    style.ScrollbarSize = 11;
    style.GrabMinSize = 10;
    style.WindowBorderSize = 0;
    style.ChildBorderSize = 0;
    style.PopupBorderSize = 1;
    style.FrameBorderSize = 0;
    style.WindowRounding = 0;
    style.ChildRounding = 4;
    style.PopupRounding = 6;
    style.FrameRounding = 4;
    style.GrabRounding = 3;
    style.ScrollbarRounding = 6;
    style.WindowTitleAlign = {0, 0.5f};
    style.DisabledAlpha = 0.42f;
    style.AntiAliasedLinesUseTex = true;
    style.ScaleAllSizes(static_cast<float>(scale));
    style.PopupBorderSize = std::round(static_cast<float>(scale));

    ImVec4* const c = style.Colors;
    c[ImGuiCol_Text] = p.text;
    c[ImGuiCol_TextDisabled] = p.quiet;
    c[ImGuiCol_WindowBg] = p.panel;
    c[ImGuiCol_ChildBg] = {0, 0, 0, 0};
    c[ImGuiCol_PopupBg] = p.popup;
    c[ImGuiCol_Border] = p.line;
    c[ImGuiCol_BorderShadow] = {0, 0, 0, 0};
    c[ImGuiCol_FrameBg] = p.field;
    c[ImGuiCol_FrameBgHovered] = p.field_hovered;
    c[ImGuiCol_FrameBgActive] = p.field_active;
    c[ImGuiCol_TitleBg] = p.bar;
    c[ImGuiCol_TitleBgActive] = p.bar;
    c[ImGuiCol_TitleBgCollapsed] = p.bar;
    c[ImGuiCol_MenuBarBg] = p.bar;
    c[ImGuiCol_ScrollbarBg] = {0, 0, 0, 0};
    c[ImGuiCol_ScrollbarGrab] = p.field_hovered;
    c[ImGuiCol_ScrollbarGrabHovered] = p.field_active;
    c[ImGuiCol_ScrollbarGrabActive] = p.quiet;
    c[ImGuiCol_CheckMark] = p.accent;
    c[ImGuiCol_SliderGrab] = p.accent;
    c[ImGuiCol_SliderGrabActive] = p.accent;
    c[ImGuiCol_Button] = p.field;
    c[ImGuiCol_ButtonHovered] = p.field_hovered;
    c[ImGuiCol_ButtonActive] = p.field_active;
    c[ImGuiCol_Header] = p.selected_row;
    c[ImGuiCol_HeaderHovered] = p.hovered_row;
    c[ImGuiCol_HeaderActive] = p.selected_row;
    c[ImGuiCol_Separator] = p.line;
    c[ImGuiCol_SeparatorHovered] = p.line;
    c[ImGuiCol_SeparatorActive] = p.line;
    c[ImGuiCol_TextSelectedBg] = {p.accent.x, p.accent.y, p.accent.z, 0.35f};
    c[ImGuiCol_DragDropTarget] = p.accent;
    c[ImGuiCol_NavHighlight] = {0, 0, 0, 0};
    c[ImGuiCol_ModalWindowDimBg] = {0, 0, 0, 0.45f};
    ImGui::GetStyle() = style;
}

}  // namespace ivory
