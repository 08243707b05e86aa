// The viewer in memory: no window, no display, the same frames.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "app/platform/window_rect.h"

namespace ivory {

struct HeadlessSettings {
    std::optional<std::string> scene;       // opened as if it had been named to the window
    std::optional<std::string> script;      // "-" for standard input; without one: until final
    std::optional<std::string> screenshot;  // of the window, at the end
    WindowSize size{1280, 720};
    int threads = 1;
    std::function<void()> stop;  // asked in every frame and while a file is read; may throw
};

// Throws Error: the scene, the script with its line, or the machine.
void run_headless(const HeadlessSettings& settings);

}  // namespace ivory
