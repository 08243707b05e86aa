// The viewer without a renderer and without OpenGL: panels, keys and the mouse in the viewport, fed
// with the same events as the real one, frame by frame.
#pragma once

#include <gtest/gtest.h>
#include <imgui.h>

#include <string>
#include <string_view>
#include <utility>

#include "app/panels/panels.h"
#include "app/platform/imgui_input.h"
#include "app/viewer/handles.h"
#include "app/viewer/overlay.h"

namespace ivory::tests {

class ViewerBench {
  public:
    explicit ViewerBench(Scene scene = {}, WindowSize size = {1280, 720}, double scale = 1)
        : events_(size, scale) {
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.LogFilename = nullptr;
        io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
        state.fonts = load_fonts(scale);
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
        apply_theme(state.theme, scale);
        if (scene.camera) state.view = {*scene.camera, scene.camera};
        if (!scene.elements.empty()) state.document.edit("Open", std::move(scene));
        turns(3);
    }
    ~ViewerBench() { ImGui::DestroyContext(); }
    ViewerBench(const ViewerBench&) = delete;
    ViewerBench& operator=(const ViewerBench&) = delete;

    ViewerState state;
    ViewportMouse mouse;
    Document::SceneValue scene_of_panels;  // that the last frame's panels showed

    [[nodiscard]] const Scene& scene() const { return state.document.scene(); }
    [[nodiscard]] const Element& element(std::size_t i) const { return scene().elements[i]; }

    // Frames until nothing waits.
    void turn() {
        do {
            const Input input = events_.next_frame(1.0 / 60);
            state.window = input.size;
            state.scale = input.scale;
            feed_imgui(input);
            ImGui::NewFrame();
            state.widgets.clear();
            age_message(state, input.elapsed);
            handle_keys(state, input);
            mouse.follow(state, input);
            draw_panels(state);
            scene_of_panels = state.document.scene_value();
            mouse.update(state, input);
            draw_overlay(state, as_it_stands(state), mouse, *ImGui::GetBackgroundDrawList());
            ImGui::Render();
        } while (!events_.empty());
    }
    void turns(int count) {
        for (int i = 0; i < count; ++i) turn();
    }
    void turn(Event event) {
        events_.push(std::move(event));
        turn();
    }

    void move_to(WindowPoint at) { turn(MouseMoved{at}); }
    void press(MouseButton button = MouseButton::left) { turn(MouseButtonChanged{button, true}); }
    void release(MouseButton button = MouseButton::left) {
        turn(MouseButtonChanged{button, false});
    }
    void hold(Key key) { turn(KeyChanged{key, true, false}); }
    void let(Key key) { turn(KeyChanged{key, false, false}); }
    void key(Key key, Modifiers modifiers = {}) {
        if (modifiers.control) hold(Key::control);
        if (modifiers.shift) hold(Key::shift);
        if (modifiers.alt) hold(Key::alt);
        hold(key);
        let(key);
        if (modifiers.alt) let(Key::alt);
        if (modifiers.shift) let(Key::shift);
        if (modifiers.control) let(Key::control);
        turns(2);
    }
    void type(std::string_view text) {
        for (const char c : text) events_.push(TextTyped{static_cast<char32_t>(c)});
        turn();
    }
    void click(WindowPoint at) {
        move_to(at);
        press();
        release();
        turns(3);
    }
    // In steps of whole frames, as a hand would.
    void drag(WindowPoint from, double dx, double dy, int steps = 10) {
        move_to(from);
        press();
        for (int i = 1; i <= steps; ++i)
            move_to({from.x + dx * i / steps, from.y + dy * i / steps});
        release();
        turn();
    }

    // The middle of a control, which has to be on the screen.
    [[nodiscard]] WindowPoint at(const std::string& id) const {
        const Widget* const widget = state.widgets.find(id);
        if (widget == nullptr || !widget->visible_part()) {
            ADD_FAILURE() << id << " is not on the screen";
            return {0, 0};
        }
        const WindowRect rect = *widget->visible_part();
        return {rect.x + rect.width / 2.0, rect.y + rect.height / 2.0};
    }
    void click(const std::string& id) { click(at(id)); }
    // As the headless script does it.
    void enter(const std::string& id, std::string_view text) {
        hold(Key::control);
        click(id);
        let(Key::control);
        key(Key::a, {.control = true});
        type(text);
        key(Key::enter);
        turns(3);
    }

    // A handle of the selected element.
    [[nodiscard]] Handle handle(const std::string& name) const {
        for (Handle& handle : handles_of(state, state.document.selected().value_or(0)))
            if (handle.name == name) return handle;
        ADD_FAILURE() << "there is no handle " << name;
        return {};
    }

  private:
    EventQueue events_;
};

}  // namespace ivory::tests
