// Input -> Dear ImGui, of every version from 1.86 on.
#pragma once

#include "app/platform/input.h"

namespace ivory {

// Before ImGui::NewFrame: size, time, pointer, keys and text of the frame, all in frame-buffer pixels.
void feed_imgui(const Input& input);

}  // namespace ivory
