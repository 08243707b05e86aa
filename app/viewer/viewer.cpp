#include "app/viewer/viewer.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/panels/actions.h"
#include "app/panels/names.h"
#include "app/panels/panels.h"
#include "app/panels/shown_text.h"
#include "app/platform/imgui_input.h"
#include "app/platform/imgui_renderer.h"
#include "app/viewer/frame_texture.h"
#include "app/viewer/handles.h"
#include "app/viewer/overlay.h"
#include "app/viewer/same_picture.h"
#include "core/field/field.h"
#include "core/render/camera.h"
#include "core/render/canvas.h"
#include "core/render/framing.h"
#include "core/render/image_file.h"
#include "core/render/shade.h"
#include "core/scene/error.h"
#include "core/scene/write_file.h"

namespace ivory {

namespace {

using Clock = std::chrono::steady_clock;

// Popups and windows that fit their contents are right after so many frames.
constexpr int settling_frames = 3;
constexpr std::size_t times_kept = 256, records_kept = 2048;
constexpr double fade_interval = 1.0 / 60;  // seconds between the frames of tiles that fade in

struct ImguiContext {
    ImguiContext() { ImGui::CreateContext(); }
    ~ImguiContext() { ImGui::DestroyContext(); }
    ImguiContext(const ImguiContext&) = delete;
    ImguiContext& operator=(const ImguiContext&) = delete;
};

void keep(std::vector<double>& times, double milliseconds) {
    if (times.size() == times_kept) times.erase(times.begin());
    times.push_back(milliseconds);
}

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Since the frame before, beyond a pointer that moves.
bool something_happened(const Input& input) {
    return input.wheel != 0 || input.wheel_x != 0 || !input.pressed.empty() ||
           !input.text.empty() || !input.dropped.empty() || input.theme || input.close_requested;
}

// What the session was last asked for.
struct Asked {
    std::shared_ptr<const Scene> scene;
    Camera camera;
    WindowSize size;
    int samples = 1;
    friend bool operator==(const Asked&, const Asked&) = default;
};

}  // namespace

struct Viewer::Parts {
    Context& context;
    ViewerSettings settings;
    ImguiContext imgui;
    ImguiRenderer imgui_renderer;
    FrameTexture texture;
    RenderSession session;
    ViewerState state;
    ViewportMouse mouse;

    Asked asked;
    std::shared_ptr<const Scene> same_as_asked;  // another scene with the picture of asked.scene
    // What an automatic view was made for; its camera is not looked at.
    std::optional<Asked> framed;
    std::optional<std::pair<Theme, double>> style;  // theme and scale that ImGui stands at
    bool overlay_hidden = false, minimised = false;
    int frames_to_settle = settling_frames;
    std::array<bool, mouse_button_count> mouse_down{};  // in the frame before
    std::optional<Clock::time_point> edited;  // when the picture that is awaited was asked for
    const Clock::time_point began = Clock::now();
    ViewerTimes times;
    std::deque<FrameRecord> frames;
    std::uint64_t frame_count = 0;
    FrameRecord record;             // of the frame that is being made
    bool first_shown = false;       // by that frame: another picture
    std::string fault_said;         // the picture's
    std::size_t glyphs_loaded = 0;  // of state.glyphs

    Parts(Context& the_context, ViewerSettings the_settings)
        : context(the_context),
          settings(std::move(the_settings)),
          imgui_renderer(context.gl()),
          texture(context.gl()),
          session({settings.threads, settings.tolerance, settings.renderer_yields, settings.wake}) {
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.LogFilename = nullptr;
    }

    // What is new of the picture.
    void take_picture() {
        const PictureChange change = session.poll();
        texture.update(session.shown(), change);
        if (change.any()) frames_to_settle = std::max(frames_to_settle, 1);
        state.picture = session.state();
        state.picture.final = state.picture.final && !texture.fading();
        first_shown = first_shown || change.replaced;
        if (fault_said == state.picture.fault) return;
        fault_said = state.picture.fault;
        if (!fault_said.empty()) state.say_error(fault_said);
    }

    [[nodiscard]] bool shows_what_stands() const {
        return asked ==
               Asked{state.picture.scene, state.picture.camera, state.picture.size, asked.samples};
    }

    void set_style(const Input& input) {
        if (input.theme) state.theme = *input.theme;
        state.scale = input.scale;
        static_cast<void>(names_of(state));  // which wants their glyphs
        if (const auto& path = state.document.path()) want_glyphs(state, path->filename().string());
        if (!style || style->second != input.scale || glyphs_loaded != state.glyphs.size()) {
            glyphs_loaded = state.glyphs.size();
            const std::vector<char16_t> glyphs(state.glyphs.begin(), state.glyphs.end());
            state.fonts = load_fonts(input.scale, glyphs);
            imgui_renderer.upload_fonts();
        }
        if (style != std::pair(state.theme, input.scale)) apply_theme(state.theme, input.scale);
        style = {state.theme, input.scale};
    }

    // A view that nobody has chosen follows the scene as it was opened, and the viewport's shape.
    void frame_automatic_view() {
        const Document& document = state.document;
        if (!state.view.automatic || document.dragging() || !document.undo_name().empty()) return;
        const Asked wanted{document.scene_value(), {}, state.viewport.size(), 1};
        if (framed == wanted) return;
        framed = wanted;
        const double aspect = static_cast<double>(wanted.size.width) / wanted.size.height;
        try {
            state.view.camera = default_camera(compile(*wanted.scene), aspect);
        } catch (const Error& fault) {
            // the view stays; a dropped file must not end what a person is at
            state.say_error(
                camera_fault(*wanted.scene, document.path().value_or("untitled"), fault).what());
        }
    }

    // Whether another one than before is wanted.
    bool ask_for_picture(const Input& input, Clock::time_point start) {
        Asked wanted{state.document.scene_value(), state.view.camera, state.viewport.size(),
                     state.samples};
        // An edit that no picture shows is not waited for: the session goes on with the scene that
        // it has.
        const bool compared = wanted.scene == asked.scene || wanted.scene == same_as_asked;
        if (!compared && asked.scene && same_picture(*asked.scene, *wanted.scene))
            same_as_asked = wanted.scene;
        if (wanted.scene == same_as_asked) wanted.scene = asked.scene;
        if (wanted == asked) {
            session.stays();
            return false;
        }
        asked = wanted;
        same_as_asked = nullptr;
        edited = start;
        session.show({wanted.scene, wanted.camera, wanted.size, focus(input), start, due(start),
                      wanted.samples});
        return true;
    }

    // When the picture of a frame that began then has to be there, so that it can be drawn in time.
    [[nodiscard]] Clock::time_point due(Clock::time_point start) const {
        std::array<double, 5> last{};  // milliseconds
        const std::size_t count = std::min(last.size(), frames.size());
        for (std::size_t i = 0; i < count; ++i) last[i] = frames[frames.size() - 1 - i].drew;
        std::sort(last.begin(), last.begin() + static_cast<std::ptrdiff_t>(count));
        const double drawing = last[count / 2] / 1000;
        const std::chrono::duration<double> left(
            std::max(settings.frame_budget - drawing, settings.frame_budget / 2));
        return start + std::chrono::duration_cast<Clock::duration>(left);
    }

    // Looks now and then whether somebody wants to stop.
    void wait_for_picture(Clock::time_point until) {
        constexpr std::chrono::milliseconds between_looks{50};
        while (!session.wait_until_showable(std::min(until, Clock::now() + between_looks))) {
            if (Clock::now() >= until) return;
            if (state.stop) state.stop();
        }
    }

    // What is drawn over the picture is of its moment; where there is none of what stands, and will be
    // none, of what stands.
    [[nodiscard]] SeenScene seen() const {
        const PictureState& picture = state.picture;
        if (picture.scene == nullptr || !picture.fault.empty() || shows_what_stands())
            return as_it_stands(state);
        return as_shown();
    }

    [[nodiscard]] SeenScene as_shown() const {
        const PictureState& picture = state.picture;
        const WindowRect& viewport = state.viewport;
        const WindowRect rect{viewport.x + (viewport.width - picture.size.width) / 2,
                              viewport.y + (viewport.height - picture.size.height) / 2,
                              picture.size.width, picture.size.height};
        return {*picture.scene, {picture.camera, picture.size}, rect, state.scale, state.arrow,
                false};
    }

    void draw_over_picture() {
        const SeenScene scene = seen();
        ImDrawList& list = *ImGui::GetBackgroundDrawList();
        const WindowRect& viewport = state.viewport;
        list.PushClipRect(ImVec2(static_cast<float>(viewport.x), static_cast<float>(viewport.y)),
                          ImVec2(static_cast<float>(viewport.x + viewport.width),
                                 static_cast<float>(viewport.y + viewport.height)));
        draw_overlay(state, scene, mouse, list);
        list.PopClipRect();
        record_handle(scene);
    }

    void record_handle(const SeenScene& scene) {
        if (!mouse.grabbed() || state.picture.scene == nullptr) return;
        const auto drawn = held_handle(scene, *mouse.grabbed());
        const auto there = held_handle(as_shown(), *mouse.grabbed());
        const auto away = [](WindowPoint a, WindowPoint b) {
            return std::hypot(a.x - b.x, a.y - b.y);
        };
        if (drawn && there) record.handle_to_surface = away(drawn->seen, there->seen);
        if (drawn) record.handle_to_hand = away(drawn->seen, mouse.grabbed()->seen);
    }

    // The frame that began then has been drawn.
    void end_frame(Clock::time_point start, Clock::time_point pictured) {
        record.took = milliseconds_since(start);
        record.drew = milliseconds_since(pictured);
        record.at = std::chrono::duration<double, std::milli>(start - began).count();
        if (first_shown) record.age = milliseconds_since(session.shown_since());
        record.resolution = state.picture.resolution;
        record.fine = state.picture.fine;
        keep(times.frames, record.took);
        if (edited && first_shown && shows_what_stands())
            keep(times.edits, milliseconds_since(*std::exchange(edited, std::nullopt)));
        if (frames.size() == records_kept) frames.pop_front();
        frames.push_back(record);
        ++frame_count;
        record = {};
        first_shown = false;
        if (frames_to_settle > 0) --frames_to_settle;
    }

    // Where the eyes are: at the pointer, or else at the selected element.
    std::optional<WindowPoint> focus(const Input& input) const {
        const WindowRect& viewport = state.viewport;
        if (input.mouse_inside && viewport.contains(input.mouse))
            return WindowPoint{input.mouse.x - viewport.x, input.mouse.y - viewport.y};
        const std::optional<std::size_t> selected = state.document.selected();
        if (!selected) return std::nullopt;
        for (const Handle& handle : handles_of(state, *selected))
            return WindowPoint{handle.at.x - viewport.x, handle.at.y - viewport.y};
        return std::nullopt;
    }

    void draw(const Input& input) {
        const Gl& gl = context.gl();
        gl.BindFramebuffer(gl::framebuffer, context.framebuffer());
        const Rgba8 background = to_srgb(state.document.scene().background);
        gl.ClearColor(static_cast<float>(background.r) / 255,
                      static_cast<float>(background.g) / 255,
                      static_cast<float>(background.b) / 255, 1);
        gl.Disable(gl::scissor_test);
        gl.Clear(gl::color_buffer_bit);
        if (!overlay_hidden) texture.draw(state.viewport, input.size, background);
        imgui_renderer.draw(*ImGui::GetDrawData(), input.size);
        // over tooltips and dialogs too
        if (overlay_hidden) texture.draw(state.viewport, input.size, background);
    }

    void fulfil_wishes(const Viewer& viewer) {
        if (!state.screenshot_wanted) return;
        std::filesystem::path path = *std::exchange(state.screenshot_wanted, std::nullopt);
        try {
            const std::string bytes = png_bytes(viewer.read_back());
            // another program may have taken the name since
            while (!write_new_file(path, bytes)) path = free_screenshot_path(state);
            state.say("Screenshot: " + path.string());
        } catch (const Error& error) {
            state.say_error(error.what());
        }
        frames_to_settle = settling_frames;
    }
};

Viewer::Viewer(Context& context, ViewerSettings settings)
    : parts_(std::make_unique<Parts>(context, std::move(settings))) {}

Viewer::~Viewer() = default;

void Viewer::frame(const Input& input) {
    Parts& parts = *parts_;
    ViewerState& state = parts.state;
    const Clock::time_point start = Clock::now();
    parts.minimised = input.size.width < 1 || input.size.height < 1;
    if (parts.minimised) return;

    age_message(state, input.elapsed);
    parts.texture.fade(input.elapsed);
    parts.take_picture();
    if (something_happened(input) || state.window != input.size || state.scale != input.scale ||
        parts.mouse_down != input.mouse_down)
        parts.frames_to_settle = settling_frames;
    parts.mouse_down = input.mouse_down;
    parts.set_style(input);
    state.window = input.size;
    for (const std::string& file : input.dropped) request_open(state, file);
    if (input.close_requested) request_quit(state);

    feed_imgui(input);
    ImGui::NewFrame();
    state.widgets.clear();
    handle_keys(state, input);
    parts.mouse.follow(state, input);
    draw_panels(state);
    parts.frame_automatic_view();
    parts.mouse.update(state, input);
    parts.record.asked = parts.ask_for_picture(input, start);
    if (parts.record.asked) {
        parts.wait_for_picture(parts.due(start));
    }
    const Clock::time_point pictured = Clock::now();
    if (parts.record.asked) parts.take_picture();
    if (!parts.overlay_hidden && state.skeleton_shown) parts.draw_over_picture();
    ImGui::Render();
    parts.draw(input);
    parts.fulfil_wishes(*this);
    parts.context.present();
    parts.end_frame(start, pictured);
}

void Viewer::set_frame_budget(double seconds) { parts_->settings.frame_budget = seconds; }

void Viewer::hide_overlay(bool hidden) { parts_->overlay_hidden = hidden; }

double Viewer::next_frame_wanted() const {
    if (parts_->minimised) return -1;
    if (parts_->frames_to_settle > 0) return 0;
    const double wanted = ivory::next_frame_wanted(parts_->state);
    if (!parts_->texture.fading()) return wanted;
    return wanted < 0 ? fade_interval : std::min(wanted, fade_interval);
}

bool Viewer::final() const { return parts_->state.picture.final; }

ViewerState& Viewer::state() { return parts_->state; }

const ViewportMouse& Viewer::mouse() const { return parts_->mouse; }

SessionTotals Viewer::totals() const { return parts_->session.totals(); }

const ViewerTimes& Viewer::times() const { return parts_->times; }

const std::deque<FrameRecord>& Viewer::frames() const { return parts_->frames; }

std::uint64_t Viewer::frame_count() const { return parts_->frame_count; }

std::string Viewer::title() const {
    const Document& document = parts_->state.document;
    const std::string file = document.path() ? document.path()->filename().string() : "untitled";
    return "Ivory - " + file + (document.dirty() ? " *" : "");
}

Cursor Viewer::cursor() const {
    switch (ImGui::GetMouseCursor()) {
        case ImGuiMouseCursor_TextInput:
            return Cursor::text;
        case ImGuiMouseCursor_ResizeEW:
            return Cursor::resize_x;
        case ImGuiMouseCursor_ResizeNS:
            return Cursor::resize_y;
        case ImGuiMouseCursor_ResizeAll:
            return Cursor::move;
        case ImGuiMouseCursor_Hand:
            return Cursor::hand;
        default:
            return Cursor::arrow;
    }
}

Frame Viewer::read_back() const {
    const Gl& gl = parts_->context.gl();
    const WindowSize size = parts_->state.window;
    Frame frame(size.width, size.height, false);
    gl.BindFramebuffer(gl::framebuffer, parts_->context.framebuffer());
    gl.PixelStorei(gl::pack_alignment, 1);
    gl.ReadPixels(0, 0, size.width, size.height, gl::rgba, gl::unsigned_byte, &frame.color[0]);
    // OpenGL counts rows from below
    for (int j = 0; j < size.height / 2; ++j)
        std::swap_ranges(&frame.color[frame.at(0, j)], &frame.color[frame.at(0, j)] + size.width,
                         &frame.color[frame.at(0, size.height - 1 - j)]);
    for (std::size_t p = 0; p < frame.size(); ++p) frame.color[p].a = 255;
    return frame;
}

}  // namespace ivory
