// The viewer in a window.
#pragma once

#include <optional>
#include <string>

#include "app/platform/window_rect.h"

namespace ivory {

struct WindowSettings {
    // A broken one leaves an empty window that says what is wrong.
    std::optional<std::string> scene;
    WindowSize size{1280, 720};  // points of the screen
    int threads = 1;
};

// Until the user closes it. Throws Error where there is no display or no OpenGL 3.3.
void run_window(const WindowSettings& settings);

}  // namespace ivory
