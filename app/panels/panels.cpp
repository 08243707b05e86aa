#include "app/panels/panels.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>

#include "app/panels/camera_moves.h"
#include "app/panels/files.h"
#include "app/panels/parts.h"
#include "app/panels/scene_edits.h"
#include "app/panels/theme.h"

namespace ivory {

namespace {

constexpr int scene_panel_width = 236, inspector_width = 300;  // pixels at scale 1
constexpr int least_height = 120;                              // of a panel
// In a narrow window the picture keeps that share of it: first the panels become narrower, then the
// one on the left gives way, then the other.
constexpr double least_picture = 0.34, narrowest_panel = 0.85;

struct Layout {
    WindowRect scene, inspector, status, viewport;
};

//   +-----------------------------+
//   | top bar                     |
//   +-------+-----------+---------+
//   | scene | viewport  | element |
//   |       |           | surface |
//   +-------+-----------+---------+
//   | status bar                  |
//   +-----------------------------+
Layout lay_out(const ViewerState& state) {
    const WindowSize window = state.window;
    const int top = std::min(top_bar_height(state), window.height);
    const int bottom = std::min(status_bar_height(state), window.height - top);
    const int height = std::max(window.height - top - bottom, 0);
    const double room =
        height < least_height * state.scale ? 0 : (1 - least_picture) * window.width;
    const auto share_of = [&](int width) { return std::min(1.0, room / (width * state.scale)); };
    int left = 0, right = 0;
    if (const double share = share_of(scene_panel_width + inspector_width);
        share >= narrowest_panel) {
        left = static_cast<int>(scene_panel_width * state.scale * share);
        right = static_cast<int>(inspector_width * state.scale * share);
    } else if (const double alone = share_of(inspector_width); alone >= narrowest_panel) {
        right = static_cast<int>(inspector_width * state.scale * alone);
    }
    Layout layout;
    layout.scene = {0, top, left, height};
    layout.inspector = {window.width - right, top, right, height};
    layout.status = {0, window.height - bottom, window.width, bottom};
    layout.viewport = {left, top, window.width - left - right, height};
    return layout;
}

WindowRect at_least_one_pixel(WindowRect rect) {
    rect.width = std::max(rect.width, 1);
    rect.height = std::max(rect.height, 1);
    return rect;
}

}  // namespace

void begin_panel(const char* name, const WindowRect& rect, int more_flags) {
    const auto number = [](int i) { return static_cast<float>(i); };
    ImGui::SetNextWindowPos({number(rect.x), number(rect.y)});
    ImGui::SetNextWindowSize({number(rect.width), number(rect.height)});
    ImGui::Begin(name, nullptr,
                 more_flags | ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                     ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                     ImGuiWindowFlags_NoNavInputs | ImGuiWindowFlags_NoNavFocus);
}

void age_message(ViewerState& state, double seconds) {
    Message& message = state.message;
    if (message.text.empty()) return;
    message.seconds_left -= seconds;
    if (message.seconds_left <= 0) message = {};
}

void draw_panels(ViewerState& state) {
    if (state.panels_hidden) {
        state.viewport = at_least_one_pixel({0, 0, state.window.width, state.window.height});
        draw_message(state);
    } else {
        const Layout layout = lay_out(state);
        state.viewport = at_least_one_pixel(layout.viewport);
        draw_top_bar(state);
        if (layout.scene.width > 0) draw_scene_panel(state, layout.scene);
        if (layout.inspector.width > 0) draw_inspector_panel(state, layout.inspector);
        draw_status_bar(state, layout.status);
    }
    draw_help(state);
    draw_dialogs(state);
    end_lost_edits(state);
    keep_plane_before_surface(state);
}

double next_frame_wanted(const ViewerState& state) {
    constexpr double caret = 0.2, rest = 0.1;  // seconds
    const ImGuiIO& io = ImGui::GetIO();
    double wanted = -1;
    const auto within = [&](double seconds) {
        wanted = wanted < 0 ? seconds : std::min(wanted, seconds);
    };
    if (!state.message.text.empty()) within(std::max(state.message.seconds_left, rest));
    if (io.WantTextInput) within(caret);
    // a tooltip is about to come
    if (ImGui::IsAnyItemHovered() && GImGui->HoveredIdTimer < 1) within(rest);
    return wanted;
}

}  // namespace ivory
