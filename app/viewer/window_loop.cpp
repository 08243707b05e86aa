#include "app/viewer/window_loop.h"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include "app/panels/panels.h"
#include "app/platform/context.h"
#include "app/viewer/viewer.h"

namespace ivory {

namespace {

using Clock = std::chrono::steady_clock;

// Where the display does not hold us back (no vertical sync), more frames than that help nobody.
constexpr std::chrono::duration<double> least_frame{1.0 / 120};

void connect_clipboard(WindowContext& window) {
    ImGuiIO& io = ImGui::GetIO();
    io.ClipboardUserData = &window;
    io.SetClipboardTextFn = [](void* user, const char* text) {
        static_cast<WindowContext*>(user)->set_clipboard(text);
    };
    io.GetClipboardTextFn = [](void* user) {
        static std::string text;  // ImGui reads it before it asks again
        text = static_cast<WindowContext*>(user)->clipboard();
        return text.c_str();
    };
}

}  // namespace

void run_window(const WindowSettings& settings) {
    const std::unique_ptr<WindowContext> window = open_window_context(settings.size, "Ivory");
    EventQueue events(window->size(), window->scale());
    ViewerSettings viewer_settings;
    viewer_settings.threads = settings.threads;
    viewer_settings.wake = [&] { window->wake(); };
    viewer_settings.renderer_yields = true;
    Viewer viewer(*window, std::move(viewer_settings));
    connect_clipboard(*window);
    viewer.state().widgets.whole_lists = false;
    if (settings.scene) request_open(viewer.state(), *settings.scene);

    std::string title;
    Clock::time_point last = Clock::now();
    double wait = 0;  // seconds until a frame is wanted though nothing happens; < 0: for ever
    while (!viewer.state().quit) {
        if (events.empty()) window->wait_events(events, wait);
        const std::chrono::duration<double> too_soon = least_frame - (Clock::now() - last);
        if (too_soon.count() > 0) {
            std::this_thread::sleep_for(too_soon);
            window->wait_events(events, 0);
        }
        const Clock::time_point now = Clock::now();
        // after a sleep animations go on where they were
        const double seconds =
            std::clamp(std::chrono::duration<double>(now - last).count(), 1e-4, 0.1);
        last = now;
        viewer.frame(events.next_frame(seconds));
        if (const std::string wanted = viewer.title(); wanted != title) {
            title = wanted;
            window->set_title(title);
        }
        window->set_cursor(viewer.cursor());
        wait = viewer.next_frame_wanted();
    }
}

}  // namespace ivory
