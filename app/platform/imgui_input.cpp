#include "app/platform/imgui_input.h"

#include <imgui.h>

#include <array>
#include <cfloat>
#include <utility>

namespace ivory {

namespace {

struct KeyName {
    Key key;
    ImGuiKey imgui;
};

// The keys that ImGui's text fields and popups know in every version; shortcuts are Ivory's own.
constexpr std::array known_keys = {
    KeyName{Key::tab, ImGuiKey_Tab},
    KeyName{Key::left, ImGuiKey_LeftArrow},
    KeyName{Key::right, ImGuiKey_RightArrow},
    KeyName{Key::up, ImGuiKey_UpArrow},
    KeyName{Key::down, ImGuiKey_DownArrow},
    KeyName{Key::page_up, ImGuiKey_PageUp},
    KeyName{Key::page_down, ImGuiKey_PageDown},
    KeyName{Key::home, ImGuiKey_Home},
    KeyName{Key::end, ImGuiKey_End},
    KeyName{Key::insert, ImGuiKey_Insert},
    KeyName{Key::del, ImGuiKey_Delete},
    KeyName{Key::backspace, ImGuiKey_Backspace},
    KeyName{Key::space, ImGuiKey_Space},
    KeyName{Key::enter, ImGuiKey_Enter},
    KeyName{Key::escape, ImGuiKey_Escape},
    KeyName{Key::a, ImGuiKey_A},
    KeyName{Key::c, ImGuiKey_C},
    KeyName{Key::v, ImGuiKey_V},
    KeyName{Key::x, ImGuiKey_X},
    KeyName{Key::y, ImGuiKey_Y},
    KeyName{Key::z, ImGuiKey_Z},
#if IMGUI_VERSION_NUM >= 18700
    KeyName{Key::keypad_enter, ImGuiKey_KeypadEnter},
#else
    KeyName{Key::keypad_enter, ImGuiKey_KeyPadEnter},
#endif
};

const ImVec2 nowhere{-FLT_MAX, -FLT_MAX};  // ImGui's "no mouse"

}  // namespace

void feed_imgui(const Input& input) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {static_cast<float>(input.size.width), static_cast<float>(input.size.height)};
    io.DisplayFramebufferScale = {1, 1};
    io.DeltaTime = static_cast<float>(input.seconds);

    bool dragging = false;
    for (const bool down : input.mouse_down) dragging = dragging || down;
    const ImVec2 mouse = input.mouse_inside || dragging ? ImVec2{static_cast<float>(input.mouse.x),
                                                                 static_cast<float>(input.mouse.y)}
                                                        : nowhere;
    const Modifiers& modifiers = input.modifiers;
    const auto held = [&](Key key) { return input.key_down[static_cast<std::size_t>(key)]; };

    // ImGui's buttons: 0 left, 1 right, 2 middle, as MouseButton
    static_assert(static_cast<int>(MouseButton::right) == 1 &&
                  static_cast<int>(MouseButton::middle) == 2);
#if IMGUI_VERSION_NUM >= 18700
    io.AddMousePosEvent(mouse.x, mouse.y);
    for (std::size_t b = 0; b < mouse_button_count; ++b)
        io.AddMouseButtonEvent(static_cast<int>(b), input.mouse_down[b]);
    if (input.wheel != 0 || input.wheel_x != 0)
        io.AddMouseWheelEvent(static_cast<float>(input.wheel_x), static_cast<float>(input.wheel));
#if IMGUI_VERSION_NUM >= 18900
    io.AddKeyEvent(ImGuiMod_Shift, modifiers.shift);
    io.AddKeyEvent(ImGuiMod_Ctrl, modifiers.control);
    io.AddKeyEvent(ImGuiMod_Alt, modifiers.alt);
    io.AddKeyEvent(ImGuiMod_Super, modifiers.super);
#else
    io.AddKeyEvent(ImGuiKey_ModShift, modifiers.shift);
    io.AddKeyEvent(ImGuiKey_ModCtrl, modifiers.control);
    io.AddKeyEvent(ImGuiKey_ModAlt, modifiers.alt);
    io.AddKeyEvent(ImGuiKey_ModSuper, modifiers.super);
#endif
    for (const KeyName& name : known_keys) io.AddKeyEvent(name.imgui, held(name.key));
#else
    io.MousePos = mouse;
    for (std::size_t b = 0; b < mouse_button_count; ++b) io.MouseDown[b] = input.mouse_down[b];
    io.MouseWheel += static_cast<float>(input.wheel);
    io.MouseWheelH += static_cast<float>(input.wheel_x);
    io.KeyShift = modifiers.shift;
    io.KeyCtrl = modifiers.control;
    io.KeyAlt = modifiers.alt;
    io.KeySuper = modifiers.super;
    for (const KeyName& name : known_keys) {
        io.KeyMap[name.imgui] = static_cast<int>(name.key);
        io.KeysDown[static_cast<int>(name.key)] = held(name.key);
    }
#endif
    for (const char32_t character : input.text)
        io.AddInputCharacter(static_cast<unsigned int>(character));
}

}  // namespace ivory
