// The viewer in a window.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app/platform/window_rect.h"

namespace ivory {

struct WindowSettings {
    // A broken one leaves an empty window that says what is wrong, as the terminal does.
    std::optional<std::string> scene;
    std::optional<WindowSize> size;  // points of the screen; without one: as it was left
    int threads = 1;
    std::optional<std::filesystem::path> user_settings;  // none: neither read nor written
    std::function<void()> stop;                          // asked in every frame; may throw
    // Called with what ends the loop's sleep, so that `stop` is asked; what it returns is kept for
    // as long as that may be called, from any thread.
    std::function<std::shared_ptr<void>(std::function<void()> wake)> listen;
};

// Until the user closes it. Throws Error where there is no display or no OpenGL 3.3.
void run_window(const WindowSettings& settings);

}  // namespace ivory
