// The two looks of the program: a calm dark one and a light one.
#pragma once

#include <imgui.h>

#include "app/platform/input.h"

namespace ivory {

// sRGB with alpha. Text on `panel` and on `field` has a contrast of 7 or more, `quiet` text of 4.5.
struct Palette {
    ImVec4 bar, panel, popup;  // backgrounds
    ImVec4 field, field_hovered, field_active;
    ImVec4 line;                 // between panels and sections
    ImVec4 text, quiet;          // quiet: labels, hints
    ImVec4 accent, accent_text;  // what is selected or on; text on it
    ImVec4 selected_row, hovered_row;
    ImVec4 error_bar, error_text;
    ImVec4 x, y, z;  // marks of the axes
};

[[nodiscard]] const Palette& palette(Theme theme);

[[nodiscard]] inline ImU32 packed(const ImVec4& color, float alpha = 1) {
    return ImGui::ColorConvertFloat4ToU32({color.x, color.y, color.z, color.w * alpha});
}

}  // namespace ivory
