#include "app/panels/color_field.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <string_view>
#include <system_error>

#include "app/panels/layout.h"
#include "app/panels/number_field.h"
#include "app/panels/scene_edits.h"
#include "app/panels/text_field.h"
#include "app/panels/theme.h"
#include "core/render/srgb.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

float srgb_of(double linear) {
    const double x = std::clamp(linear, 0.0, 1.0);
    return static_cast<float>(x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055);
}

std::array<float, 3> srgb_of(const Color& linear) {
    return {srgb_of(linear.x), srgb_of(linear.y), srgb_of(linear.z)};
}

double linear_of(float srgb) {
    return linear_of_srgb(std::clamp(static_cast<double>(srgb), 0.0, 1.0));
}

// "#FCDAB3", in sRGB.
std::string hex_of(const Color& linear) {
    const auto byte = [](double x) {
        return static_cast<unsigned>(std::lround(255 * static_cast<double>(srgb_of(x))));
    };
    std::array<char, 8> text{};
    std::snprintf(text.data(), text.size(), "#%02X%02X%02X", byte(linear.x) & 255u,
                  byte(linear.y) & 255u, byte(linear.z) & 255u);
    return text.data();
}

// Three or six hexadecimal digits, with or without '#'.
std::optional<Color> parse_hex(std::string_view text) {
    const auto trimmed = [](char c) { return c == ' ' || c == '\t'; };
    while (!text.empty() && trimmed(text.front())) text.remove_prefix(1);
    while (!text.empty() && trimmed(text.back())) text.remove_suffix(1);
    if (text.starts_with('#')) text.remove_prefix(1);
    if (text.size() != 3 && text.size() != 6) return std::nullopt;
    const std::size_t digits = text.size() / 3;
    Color color;
    for (std::size_t part = 0; part < 3; ++part) {
        unsigned number = 0;
        const char* const begin = text.data() + part * digits;
        const auto [rest, error] = std::from_chars(begin, begin + digits, number, 16);
        if (error != std::errc() || rest != begin + digits) return std::nullopt;
        if (digits == 1) number *= 17;
        color[part] = linear_of(static_cast<float>(number) / 255);
    }
    return color;
}

// An unchanged text changes no colour, however little of it the text tells.
void hex_field(ViewerState& state, const std::string& id, const std::string& what,
               const Color& value, float width,
               const std::function<void(Scene&, const Color&)>& set) {
    const std::string before = hex_of(value);
    std::string text = before;
    if (!text_field(state, id, text, width)) return;
    const auto chosen = parse_hex(text);
    if (!chosen) {
        state.say_error(in_quotes(text) + " is not a colour; write it as in #3366CC; " + before +
                        " stays");
        return;
    }
    if (hex_of(*chosen) == before) return;
    edit_scene(state, what, [&](Scene& scene) { set(scene, *chosen); });
}

void draw_swatch(const ViewerState& state, const Color& value) {
    const Palette& colors = palette(state.theme);
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    const std::array<float, 3> srgb = srgb_of(value);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float rounding = ImGui::GetStyle().FrameRounding;
    list.AddRectFilled(lo, hi, packed({srgb[0], srgb[1], srgb[2], 1}), rounding);
    list.AddRect(lo, hi, packed(ImGui::IsItemHovered() ? colors.text : colors.line), rounding, 0,
                 px(state, 1));
}

void picker(ViewerState& state, const std::string& id, const std::string& what, const Color& value,
            float width, const std::function<void(Scene&, const Color&)>& set) {
    std::array<float, 3> srgb = srgb_of(value);
    ImGui::SetNextItemWidth(width);
    const bool changed =
        ImGui::ColorPicker3("##picker", srgb.data(),
                            ImGuiColorEditFlags_NoSidePreview | ImGuiColorEditFlags_NoLabel |
                                ImGuiColorEditFlags_NoOptions | ImGuiColorEditFlags_NoInputs |
                                ImGuiColorEditFlags_PickerHueBar);
    if (ImGui::IsItemActivated()) begin_field_drag(state, id, what);
    if (changed) {
        const Color chosen{linear_of(srgb[0]), linear_of(srgb[1]), linear_of(srgb[2])};
        drag_field(state, [&](Scene& scene) { set(scene, chosen); });
    }
    if (ImGui::IsItemDeactivated()) end_field_drag(state);
}

// The same colour in digits.
void digits(ViewerState& state, const std::string& id, const std::string& what, const Color& value,
            float width, const std::function<void(Scene&, const Color&)>& set) {
    const float spacing = px(state, 4), left = px(state, 52);
    const auto row = [&](const char* name) {
        ImGui::PushStyleColor(ImGuiCol_Text, palette(state.theme).quiet);
        ImGui::AlignTextToFramePadding();
        ImGui::TextUnformatted(name);
        ImGui::PopStyleColor();
    };
    row("sRGB");
    ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + left);
    hex_field(state, id + ".hex", what, value, width - left, set);
    row("linear");
    const float number_width = std::floor((width - left - 2 * spacing) / 3);
    for (int part = 0; part < 3; ++part) {
        const auto k = static_cast<std::size_t>(part);
        if (part == 0) {
            ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + left);
        } else {
            ImGui::SameLine(0, spacing);
        }
        const NumberField field{.id = id + "." + "rgb"[k],
                                .what = what,
                                .value = value[k],
                                .step = 0.001,
                                .least = 0,
                                .greatest = 1,
                                .axis = part};
        number_field(state, field, number_width, [&](Scene& scene, double number) {
            Color chosen = value;
            chosen[k] = number;
            set(scene, chosen);
        });
    }
}

}  // namespace

void color_field(ViewerState& state, const std::string& id, const std::string& what,
                 const Color& value, float width,
                 const std::function<void(Scene&, const Color&)>& set) {
    ImGui::PushID(id.c_str());
    const bool clicked = ImGui::InvisibleButton("##swatch", {width, ImGui::GetFrameHeight()});
    state.widgets.add(id, WidgetKind::color);
    draw_swatch(state, value);
    tooltip("Colour: click to choose");
    if (clicked) ImGui::OpenPopup("picker");

    if (ImGui::BeginPopup("picker")) {
        const float picker_width = px(state, 230);
        picker(state, id, what, value, picker_width, set);
        digits(state, id, what, value, picker_width, set);
        if (plain_key_pressed(ImGuiKey_Escape) && !state.panels.number &&
            !state.panels.dragged.begun)
            ImGui::CloseCurrentPopup();
        ImGui::EndPopup();
    }
    ImGui::PopID();
}

}  // namespace ivory
