// The signs on buttons and rows, drawn as lines: sharp at every scale, in the colour of the text.
#pragma once

#include <imgui.h>

#include <cstdint>

#include "core/shape/shapes.h"

namespace ivory {

enum class Icon : std::uint8_t {
    eye,
    eye_closed,
    trash,
    copy,
    up,
    down,
    undo,
    redo,
    frame,
    orthographic,
    paste,
    skeleton,
    theme,
    cross,
    plus,
    folder,
    file,
};

// Within the square of that side around the middle.
void draw_icon(ImDrawList& list, Icon icon, ImVec2 middle, float side, ImU32 color);
void draw_icon(ImDrawList& list, Shape shape, ImVec2 middle, float side, ImU32 color);

}  // namespace ivory
