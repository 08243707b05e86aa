#include "app/viewer/window_loop.h"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "app/panels/panels.h"
#include "app/panels/settings.h"
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

// The user's settings on their way between the file and the viewer.
class Keeper {
  public:
    explicit Keeper(const WindowSettings& settings) : file_(settings.user_settings) {
        now_ = file_.read();
        size_ = settings.size.value_or(WindowSize{now_.window_width, now_.window_height});
        maximised_ = !settings.size && now_.window_maximised;
    }

    // The window to begin with.
    [[nodiscard]] WindowSize size() const { return size_; }
    [[nodiscard]] bool maximised() const { return maximised_; }

    // Of a window that has just been opened.
    void begin(ViewerState& state, const WindowContext& window) {
        size_ = window.points();  // which may be less
        state.theme = now_.theme;
        state.panels_hidden = !now_.panels_shown;
        state.skeleton_shown = now_.skeleton_shown;
        state.samples = now_.samples;
        say_complaint(state);
    }

    // After each frame: writes what has been set when the hand rests. Seconds until then; < 0:
    // nothing is to be written.
    double look(ViewerState& state, const WindowContext& window, Clock::time_point now) {
        const UserSettings before = now_;
        now_.theme = state.theme;
        now_.panels_shown = !state.panels_hidden;
        now_.skeleton_shown = state.skeleton_shown;
        now_.samples = state.samples;
        // what the user did to it, not what the command line or a small screen did
        const WindowSize size = window.points();
        const bool resized = size != size_;
        resized_ = resized_ || resized;
        size_ = size;
        if (const bool maximised = window.maximised(); maximised != maximised_)
            now_.window_maximised = maximised_ = maximised;
        if (resized || now_ != before) due_ = now + rest;
        if (!due_) return -1;
        const double left = std::chrono::duration<double>(*due_ - now).count();
        if (left > 0) return left;
        write(state);
        return -1;
    }

    void end(ViewerState& state) {
        if (due_) write(state);
    }

  private:
    static constexpr std::chrono::milliseconds rest{500};

    void write(ViewerState& state) {
        due_.reset();
        // by now it is known whether the window is as large as it is because it was maximised
        if (std::exchange(resized_, false) && !maximised_ && size_.width > 0 && size_.height > 0) {
            now_.window_width = std::clamp(size_.width, least_window_side, largest_window_side);
            now_.window_height = std::clamp(size_.height, least_window_side, largest_window_side);
        }
        file_.keep(now_);
        say_complaint(state);
    }

    void say_complaint(ViewerState& state) {
        const std::string complaint = file_.take_complaint();
        if (complaint.empty()) return;
        std::fprintf(stderr, "ivory: %s\n", complaint.c_str());
        state.say_error(complaint);
    }

    SettingsFile file_;
    UserSettings now_;
    WindowSize size_;  // of the window, as last seen
    bool maximised_ = false, resized_ = false;
    std::optional<Clock::time_point> due_;
};

}  // namespace

void run_window(const WindowSettings& settings) {
    Keeper keeper(settings);
    const std::unique_ptr<WindowContext> window =
        open_window_context(keeper.size(), keeper.maximised(), "Ivory");
    EventQueue events(window->size(), window->scale());
    ViewerSettings viewer_settings;
    viewer_settings.threads = settings.threads;
    viewer_settings.wake = [&] { window->wake(); };
    viewer_settings.renderer_yields = true;
    Viewer viewer(*window, std::move(viewer_settings));
    connect_clipboard(*window);
    keeper.begin(viewer.state(), *window);
    if (settings.scene) {
        const std::string before = viewer.state().message.text;
        request_open(viewer.state(), *settings.scene);
        const Message& message = viewer.state().message;
        if (message.error && message.text != before)
            std::fprintf(stderr, "ivory: %s\n", message.text.c_str());
    }
    const std::shared_ptr<void> listener = settings.listen([&] { window->wake(); });

    std::string title;
    Clock::time_point last = Clock::now();
    double wait = 0;  // seconds until a frame is wanted though nothing happens; < 0: for ever
    while (!viewer.state().quit) {
        if (events.empty()) window->wait_events(events, wait);
        settings.stop();
        const std::chrono::duration<double> too_soon = least_frame - (Clock::now() - last);
        if (too_soon.count() > 0) {
            std::this_thread::sleep_for(too_soon);
            window->wait_events(events, 0);
        }
        const Clock::time_point now = Clock::now();
        const double seconds = std::chrono::duration<double>(now - last).count();
        last = now;
        viewer.frame(events.next_frame(seconds));
        if (const std::string wanted = viewer.title(); wanted != title) {
            title = wanted;
            window->set_title(title);
        }
        window->set_cursor(viewer.cursor());
        wait = viewer.next_frame_wanted();
        if (const double due = keeper.look(viewer.state(), *window, Clock::now()); due >= 0)
            wait = wait < 0 ? due : std::min(wait, due);
    }
    keeper.end(viewer.state());
}

}  // namespace ivory
