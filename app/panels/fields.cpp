#include "app/panels/fields.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string_view>
#include <system_error>
#include <utility>

#include "app/document/tidy.h"
#include "app/panels/theme.h"
#include "core/scene/error.h"
#include "core/scene/scene_fault.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

constexpr double drag_slack = 3;         // pixels at scale 1 before a press is a drag
constexpr double fine = 0.1;             // of the way, with Shift
constexpr float tooltip_delay = 0.5f;    // seconds
constexpr double label_width = 84;       // pixels at scale 1
constexpr std::size_t most_shown = 400;  // characters of a text in its tooltip

bool escape_pressed() { return plain_key_pressed(ImGuiKey_Escape); }

bool item_is_disabled() { return (ImGui::GetItemFlags() & ImGuiItemFlags_Disabled) != 0; }

// Text fields for std::string, which grows as is typed.
int grow(ImGuiInputTextCallbackData* data) {
    auto& text = *static_cast<std::string*>(data->UserData);
    text.resize(static_cast<std::size_t>(data->BufTextLen));
    data->Buf = text.data();
    return 0;
}

struct Character {
    char32_t code = 0;
    std::size_t length = 1;  // bytes
};

// That begins at `at` of well-formed UTF-8; anything else is read byte by byte.
Character character_at(std::string_view text, std::size_t at) {
    const auto byte = [&](std::size_t i) {
        return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0u;
    };
    const unsigned first = byte(0);
    const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC0 ? 2 : 1;
    if (length == 1) return {first, 1};
    char32_t code = first & (0x7Fu >> length);
    for (std::size_t i = 1; i < length; ++i) code = (code << 6) | (byte(i) & 0x3Fu);
    return {code, std::min(length, text.size() - at)};
}

void append_utf8(std::string& text, char32_t code) {
    const auto add = [&](char32_t byte) { text += static_cast<char>(byte); };
    if (code < 0x800) {
        add(0xC0 | (code >> 6));
    } else if (code < 0x10000) {
        add(0xE0 | (code >> 12));
        add(0x80 | ((code >> 6) & 0x3F));
    } else {
        add(0xF0 | (code >> 18));
        add(0x80 | ((code >> 12) & 0x3F));
        add(0x80 | ((code >> 6) & 0x3F));
    }
    add(0x80 | (code & 0x3F));
}

bool input_text(const char* name, const char* hint, std::string& text, ImGuiInputTextFlags flags) {
    return ImGui::InputTextWithHint(name, hint, text.data(), text.capacity() + 1,
                                    flags | ImGuiInputTextFlags_CallbackResize, grow, &text);
}

// The shortest decimal that is exactly `value`, or as many of its digits as fit.
std::string fitted_number(double value, float width) {
    std::string text = number_text(value);
    for (int digits = 9; digits >= 2 && ImGui::CalcTextSize(text.c_str()).x > width; --digits) {
        std::array<char, 40> buffer{};
        std::snprintf(buffer.data(), buffer.size(), "%.*g", digits, value);
        text = buffer.data();
    }
    return text;
}

float srgb_of(double linear) {
    const double x = std::clamp(linear, 0.0, 1.0);
    return static_cast<float>(x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055);
}

double linear_of(float srgb) {
    const double s = std::clamp(static_cast<double>(srgb), 0.0, 1.0);
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
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

// Faults of what a drag in a panel can change; the whole scene would be too much for every frame.
bool has_fault(const Scene& scene, std::optional<std::size_t> selected) {
    if (!(scene.threshold > 0 && std::isfinite(scene.threshold))) return true;
    if (selected && find_fault(scene.elements[*selected])) return true;
    return scene.lights &&
           std::any_of(scene.lights->begin(), scene.lights->end(),
                       [](const Light& light) { return find_fault(light).has_value(); });
}

void open_typing(ViewerState& state, const NumberField& field) {
    const std::string text = number_text(field.value);
    state.panels.number = TypedNumber{field.id, text, text};
}

void take_typed(ViewerState& state, const NumberField& field,
                const std::function<void(Scene&, double)>& set) {
    const TypedNumber typed = *std::exchange(state.panels.number, std::nullopt);
    if (typed.text == typed.before) return;
    const auto value = parse_number(typed.text, field.value);
    if (!value) {
        state.say_error(in_quotes(typed.text) + " is not a number; " + number_text(field.value) +
                        " stays");
        return;
    }
    if (*value == field.value) return;  // in other words
    edit_scene(state, field.what, [&](Scene& scene) { set(scene, *value); });
}

void typed_number(ViewerState& state, const NumberField& field, float width,
                  const std::function<void(Scene&, double)>& set) {
    TypedNumber& typed = *state.panels.number;
    typed.drawn = true;
    if (!typed.focused) ImGui::SetKeyboardFocusHere();
    typed.focused = true;
    ImGui::SetNextItemWidth(width);
    input_text("##typed", "", typed.text, ImGuiInputTextFlags_AutoSelectAll);
    state.widgets.add(field.id, WidgetKind::number);
    const bool active = ImGui::IsItemActive();
    ++typed.frames;
    if (active && plain_key_pressed(ImGuiKey_Tab)) {
        take_typed(state, field, set);
        state.panels.type_next = true;
    } else if (ImGui::IsItemDeactivated() || (!active && typed.frames > 3)) {
        take_typed(state, field, set);
    }
}

void dragged_number(ViewerState& state, const NumberField& field, float width,
                    const std::function<void(Scene&, double)>& set) {
    const Palette& colors = palette(state.theme);
    const ImVec2 size{width, ImGui::GetFrameHeight()};
    ImGui::InvisibleButton("##number", size);
    state.widgets.add(field.id, WidgetKind::number);
    const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    if (hovered || active) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);

    DraggedField& drag = state.panels.dragged;
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsItemActivated()) drag = {field.id, field.value, 0, io.MousePos.x, false, false};
    if (active && drag.id == field.id && !drag.cancelled) {
        const auto slack = static_cast<float>(drag_slack * state.scale);
        if (!drag.begun && ImGui::IsMouseDragging(ImGuiMouseButton_Left, slack)) {
            begin_field_drag(state, field.id, field.what);
            drag.start = field.value;  // an undo since the press has changed it
        }
        if (drag.begun && io.MousePos.x != drag.last_x) {
            drag.way += (io.KeyShift ? fine : 1) * static_cast<double>(io.MousePos.x - drag.last_x);
            const double step = io.KeyShift ? fine * field.step : field.step;
            const double value = tidy(drag.start + drag.way / state.scale * field.step,
                                      exponent_above(step * 0.999));
            const double within = std::clamp(value, field.least, field.greatest);
            drag_field(state, [&](Scene& scene) { set(scene, within); });
        }
        drag.last_x = io.MousePos.x;
    }
    if (ImGui::IsItemDeactivated() && drag.id == field.id) {
        const bool was_click = !drag.begun && !drag.cancelled && hovered;
        end_field_drag(state);
        if (was_click) open_typing(state, field);
    }

    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec4& background = active    ? colors.field_active
                               : hovered ? colors.field_hovered
                                         : colors.field;
    const float alpha = item_is_disabled() ? ImGui::GetStyle().DisabledAlpha : 1;
    const float rounding = ImGui::GetStyle().FrameRounding;
    list.AddRectFilled(lo, hi, packed(background, alpha), rounding);
    if (field.axis) {
        const ImVec4& mark = *field.axis == 0 ? colors.x : *field.axis == 1 ? colors.y : colors.z;
        list.AddRectFilled(lo, {lo.x + px(state, 3), hi.y}, packed(mark, alpha), rounding,
                           ImDrawFlags_RoundCornersLeft);
    }
    const std::string text = fitted_number(field.value, width - px(state, field.axis ? 17 : 14));
    const ImVec2 extent = ImGui::CalcTextSize(text.c_str());
    const float left = field.axis ? px(state, 3) : 0;
    const float x = std::floor(lo.x + left + 0.5f * (hi.x - lo.x - left - extent.x));
    list.PushClipRect(lo, hi, true);
    list.AddText({x, std::floor(0.5f * (lo.y + hi.y - extent.y))}, packed(colors.text, alpha),
                 text.c_str());
    list.PopClipRect();
    if (const std::string whole = number_text(field.value); whole != text) tooltip(whole.c_str());
}

}  // namespace

bool plain_key_pressed(int imgui_key) {
    const ImGuiIO& io = ImGui::GetIO();
    return !io.KeyCtrl && !io.KeyShift && !io.KeyAlt && !io.KeySuper &&
           ImGui::IsKeyPressed(ImGui::GetKeyIndex(static_cast<ImGuiKey>(imgui_key)), false);
}

std::optional<double> parse_number(const std::string& typed, double value) {
    std::string text = typed;
    const auto is_space = [](char c) { return c == ' ' || c == '\t'; };
    while (!text.empty() && is_space(text.back())) text.pop_back();
    while (!text.empty() && is_space(text.front())) text.erase(0, 1);
    char change = 0;
    if (text.size() > 2 && text[1] == '=' &&
        std::string_view("+-*/").find(text[0]) != std::string_view::npos) {
        change = text[0];
        text.erase(0, 2);
        while (!text.empty() && is_space(text.front())) text.erase(0, 1);
    }
    if (text.starts_with('+')) text.erase(0, 1);
    // a decimal comma, where it cannot be anything else
    if (std::count(text.begin(), text.end(), ',') == 1 && text.find('.') == std::string::npos)
        std::replace(text.begin(), text.end(), ',', '.');
    double number = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    if (text.empty() || error != std::errc() || rest != end) return std::nullopt;
    switch (change) {
        case '+':
            number = value + number;
            break;
        case '-':
            number = value - number;
            break;
        case '*':
            number = value * number;
            break;
        case '/':
            number = value / number;
            break;
        default:
            break;
    }
    if (!std::isfinite(number)) return std::nullopt;
    return number;
}

double step_for(double value) {
    if (value == 0 || !std::isfinite(value)) return 0.01;
    const double exponent = std::round(std::log10(std::abs(value))) - 2;
    return std::pow(10.0, std::clamp(exponent, -300.0, 300.0));
}

void edit_scene(ViewerState& state, const std::string& what,
                const std::function<void(Scene&)>& change) {
    Scene scene = state.document.scene();
    try {
        change(scene);
    } catch (const Error& error) {
        state.say_error(error.what());
        return;
    }
    if (const auto fault = find_fault(scene)) {
        state.say_error(fault->message);
        return;
    }
    if (state.message.error) state.message = {};  // what was wrong has been put right
    state.document.edit(what, std::move(scene));
}

void begin_field_drag(ViewerState& state, const std::string& id, const std::string& what) {
    state.panels.dragged.id = id;
    state.panels.dragged.begun = true;
    state.panels.dragged.cancelled = false;
    state.document.begin_drag(what);
}

void drag_field(ViewerState& state, const std::function<void(Scene&)>& change) {
    if (!state.document.dragging() || state.panels.dragged.cancelled) return;
    Scene scene = state.document.scene();
    change(scene);
    if (!has_fault(scene, state.document.selected())) state.document.drag_to(std::move(scene));
}

void end_field_drag(ViewerState& state) {
    if (!state.panels.dragged.begun) return;
    state.panels.dragged.begun = false;
    state.document.end_drag();
}

void end_lost_edits(ViewerState& state) {
    DraggedField& drag = state.panels.dragged;
    if (drag.begun && escape_pressed()) {
        state.document.cancel_drag();
        drag.begun = false;
        drag.cancelled = true;
    }
    if (drag.begun && !ImGui::IsAnyItemActive()) end_field_drag(state);

    PanelMemory& memory = state.panels;
    if (memory.number && !std::exchange(memory.number->drawn, false)) memory.number.reset();
    memory.type_next = false;
}

void number_field(ViewerState& state, const NumberField& field, float width,
                  const std::function<void(Scene&, double)>& set) {
    PanelMemory& memory = state.panels;
    ImGui::PushID(field.id.c_str());
    const bool enabled = !item_is_disabled();
    const bool typing = memory.number && memory.number->id == field.id;
    const ImVec2 lo = ImGui::GetCursorScreenPos();
    const ImVec2 hi{lo.x + width, lo.y + ImGui::GetFrameHeight()};
    const bool ctrl_clicked =
        ImGui::IsMouseClicked(ImGuiMouseButton_Left) && ImGui::GetIO().KeyCtrl &&
        ImGui::IsMouseHoveringRect(lo, hi) &&
        ImGui::IsWindowHovered(ImGuiHoveredFlags_AllowWhenBlockedByActiveItem);
    if (!typing && enabled && (ctrl_clicked || memory.type_next)) {
        open_typing(state, field);
        memory.type_next = false;
    }
    if (memory.number && memory.number->id == field.id) {
        typed_number(state, field, width, set);
    } else {
        dragged_number(state, field, width, set);
    }
    ImGui::PopID();
}

void vector_fields(ViewerState& state, const std::string& id, const std::string& what,
                   const Vec3d& value, double step,
                   const std::function<void(Scene&, const Vec3d&)>& set) {
    const float spacing = px(state, 4);
    const float third = std::floor((field_width() - 2 * spacing) / 3);
    // far from the origin a third of the line has no room for what a drag changes
    bool one_line = true;
    for (int axis = 0; axis < 3; ++axis) {
        const double seen =
            tidy(value[static_cast<std::size_t>(axis)], exponent_above(step * 0.999));
        const float text = ImGui::CalcTextSize(number_text(seen).c_str()).x;
        one_line = one_line && (text <= third - px(state, 17) || std::abs(seen) < 1e4);
    }
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        if (axis > 0 && one_line) ImGui::SameLine(0, spacing);
        if (axis > 0 && !one_line) label(state, "");
        // the last takes what rounding left
        const float width = axis < 2 && one_line ? third : field_width();
        const NumberField field{
            .id = id + "." + "xyz"[k], .what = what, .value = value[k], .step = step, .axis = axis};
        number_field(state, field, width, [&](Scene& scene, double number) {
            Vec3d changed = value;
            changed[k] = number;
            set(scene, changed);
        });
    }
}

namespace {

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

}  // namespace

void color_field(ViewerState& state, const std::string& id, const std::string& what,
                 const Color& value, float width,
                 const std::function<void(Scene&, const Color&)>& set) {
    const Palette& colors = palette(state.theme);
    ImGui::PushID(id.c_str());
    const bool clicked = ImGui::InvisibleButton("##swatch", {width, ImGui::GetFrameHeight()});
    state.widgets.add(id, WidgetKind::color);
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    std::array<float, 3> srgb{srgb_of(value.x), srgb_of(value.y), srgb_of(value.z)};
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float rounding = ImGui::GetStyle().FrameRounding;
    list.AddRectFilled(lo, hi, packed({srgb[0], srgb[1], srgb[2], 1}), rounding);
    list.AddRect(lo, hi, packed(ImGui::IsItemHovered() ? colors.text : colors.line), rounding, 0,
                 px(state, 1));
    tooltip("Colour: click to choose");
    if (clicked) ImGui::OpenPopup("picker");

    if (ImGui::BeginPopup("picker")) {
        const float picker_width = px(state, 230);
        ImGui::SetNextItemWidth(picker_width);
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

        const float spacing = px(state, 4), left = px(state, 52);
        const auto row = [&](const char* name) {
            ImGui::PushStyleColor(ImGuiCol_Text, colors.quiet);
            ImGui::AlignTextToFramePadding();
            ImGui::TextUnformatted(name);
            ImGui::PopStyleColor();
        };
        row("sRGB");
        ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + left);
        hex_field(state, id + ".hex", what, value, picker_width - left, set);
        row("linear");
        const float number_width = std::floor((picker_width - left - 2 * spacing) / 3);
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
        if (escape_pressed() && !state.panels.number && !state.panels.dragged.begun)
            ImGui::CloseCurrentPopup();
        ImGui::EndPopup();
    }
    ImGui::PopID();
}

bool text_field(ViewerState& state, const std::string& id, std::string& text, float width,
                const char* hint, bool focus) {
    TypedText& typed = state.panels.text;
    ImGui::PushID(id.c_str());
    if (focus) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(width);
    const std::string before = shown_text(state, text);
    std::string shown = typed.id == id ? typed.text : before;
    input_text("##text", hint, shown, ImGuiInputTextFlags_AutoSelectAll);
    state.widgets.add(id, WidgetKind::text);
    const float inside = width - 2 * ImGui::GetStyle().FramePadding.x;
    if (!ImGui::IsItemActive() && ImGui::CalcTextSize(shown.c_str()).x > inside)
        tooltip(printable(shown, most_shown).c_str());
    bool entered = false;
    if (ImGui::IsItemActive()) {
        typed = {id, shown};
    } else if (typed.id == id) {
        entered = ImGui::IsItemDeactivated() && shown != before;
        if (entered) text = meant_text(shown);
        typed = {};
    }
    ImGui::PopID();
    return entered;
}

std::string shown_text(const ViewerState& state, const std::string& text) {
    std::string shown;
    for (std::size_t at = 0; at < text.size();) {
        const auto [character, length] = character_at(text, at);
        if (character < 0x80 || state.fonts.have(character)) {
            shown.append(text, at, length);
        } else {
            std::array<char, 16> escaped{};
            std::snprintf(escaped.data(), escaped.size(), "\\u{%04X}",
                          static_cast<unsigned>(character));
            shown += escaped.data();
        }
        at += length;
    }
    return shown;
}

std::string meant_text(const std::string& shown) {
    constexpr std::string_view opening = "\\u{";
    std::string text;
    for (std::size_t at = 0; at < shown.size();) {
        const std::size_t end = shown.find('}', at);
        unsigned number = 0;
        if (shown.compare(at, opening.size(), opening) == 0 && end != std::string::npos) {
            const char* const begin = shown.data() + at + opening.size();
            const auto [rest, error] = std::from_chars(begin, shown.data() + end, number, 16);
            const bool surrogate = number >= 0xD800 && number < 0xE000;
            if (error == std::errc() && rest == shown.data() + end && number >= 0x80 &&
                number <= 0x10FFFF && !surrogate) {
                append_utf8(text, number);
                at = end + 1;
                continue;
            }
        }
        text += shown[at++];
    }
    return text;
}

void want_glyphs(ViewerState& state, const std::string& text) {
    constexpr std::size_t most_glyphs = 3'000;
    for (std::size_t at = 0; at < text.size();) {
        const auto [character, length] = character_at(text, at);
        if (character >= 0x80 && character <= 0xFFFF && state.glyphs.size() < most_glyphs)
            state.glyphs.insert(static_cast<char16_t>(character));
        at += length;
    }
}

std::string fitted_text(const std::string& text, float width) {
    if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
    const std::string ellipsis = "\xE2\x80\xA6";
    const float room = width - ImGui::CalcTextSize(ellipsis.c_str()).x;
    const char* end = text.c_str();
    ImGui::GetFont()->CalcTextSizeA(ImGui::GetFontSize(), std::max(room, 0.0f), 0, text.c_str(),
                                    text.c_str() + text.size(), &end);
    return std::string(text.c_str(), end) + ellipsis;
}

bool toggle(ViewerState& state, const std::string& id, const char* text, bool on) {
    ImGui::PushID(id.c_str());
    const bool clicked = ImGui::Checkbox(text, &on);
    state.widgets.add(id, WidgetKind::toggle, clicked ? !on : on);
    ImGui::PopID();
    return clicked;
}

bool icon_button(ViewerState& state, const std::string& id, Icon icon, const char* hint,
                 bool enabled, bool on) {
    const Palette& colors = palette(state.theme);
    ImGui::BeginDisabled(!enabled);
    ImGui::PushID(id.c_str());
    const float side = ImGui::GetFrameHeight();
    const bool clicked = ImGui::InvisibleButton("##icon", {side, side});
    state.widgets.add(id, WidgetKind::button);
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float rounding = ImGui::GetStyle().FrameRounding;
    if (ImGui::IsItemActive()) {
        list.AddRectFilled(lo, hi, packed(colors.field_active), rounding);
    } else if (ImGui::IsItemHovered()) {
        list.AddRectFilled(lo, hi, packed(colors.field_hovered), rounding);
    }
    const float alpha = enabled ? 1 : ImGui::GetStyle().DisabledAlpha;
    draw_icon(list, icon, {0.5f * (lo.x + hi.x), 0.5f * (lo.y + hi.y)}, 0.52f * side,
              packed(on ? colors.accent : colors.text, alpha));
    ImGui::PopID();
    ImGui::EndDisabled();
    tooltip(hint);
    return clicked;
}

bool text_button(ViewerState& state, const std::string& id, const char* text, float width,
                 bool enabled, bool strong) {
    const Palette& colors = palette(state.theme);
    ImGui::BeginDisabled(!enabled);
    if (strong) {
        ImGui::PushStyleColor(ImGuiCol_Button, colors.accent);
        ImGui::PushStyleColor(ImGuiCol_ButtonHovered, colors.accent);
        ImGui::PushStyleColor(ImGuiCol_ButtonActive, colors.accent);
        ImGui::PushStyleColor(ImGuiCol_Text, colors.accent_text);
    }
    ImGui::PushID(id.c_str());
    const bool clicked = ImGui::Button(text, {width, 0});
    state.widgets.add(id, WidgetKind::button);
    ImGui::PopID();
    if (strong) ImGui::PopStyleColor(4);
    ImGui::EndDisabled();
    return clicked;
}

void tooltip(const char* text) {
    if (*text == '\0' || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
    if (GImGui->HoveredIdTimer < tooltip_delay || ImGui::IsMouseDown(ImGuiMouseButton_Left)) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 30);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

bool begin_dialog(const ViewerState& state, const char* name, float width, float height) {
    const auto window_width = static_cast<float>(state.window.width);
    const auto window_height = static_cast<float>(state.window.height);
    ImGui::SetNextWindowPos({std::floor(0.5f * window_width), std::floor(0.5f * window_height)},
                            ImGuiCond_Always, {0.5f, 0.5f});
    ImGuiWindowFlags flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                             ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                             ImGuiWindowFlags_NoNavInputs;
    if (width > 0) {
        ImGui::SetNextWindowSize(
            {std::min(width, 0.96f * window_width), std::min(height, 0.96f * window_height)});
    } else {
        flags |= ImGuiWindowFlags_AlwaysAutoResize;
    }
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(state, 24), px(state, 20)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, px(state, 8));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, px(state, 1));
    const bool drawn = ImGui::BeginPopupModal(name, nullptr, flags);
    ImGui::PopStyleVar(3);
    return drawn;
}

void section(const ViewerState& state, const char* title) {
    const Palette& colors = palette(state.theme);
    if (ImGui::GetCursorPosY() > ImGui::GetStyle().WindowPadding.y + 1) {
        const ImVec2 at = ImGui::GetCursorScreenPos();
        const float y = std::floor(at.y + px(state, 7));
        const float left = ImGui::GetWindowPos().x;
        ImGui::GetWindowDrawList()->AddLine({left, y}, {left + ImGui::GetWindowWidth(), y},
                                            packed(colors.line), px(state, 1));
        ImGui::Dummy({0, px(state, 10)});
    }
    ImGui::PushFont(state.fonts.strong);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(title);
    ImGui::PopFont();
}

void label(const ViewerState& state, const char* text) {
    ImGui::PushStyleColor(ImGuiCol_Text, palette(state.theme).quiet);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(text);
    ImGui::PopStyleColor();
    ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + px(state, label_width));
}

float field_width() { return std::max(1.0f, std::floor(ImGui::GetContentRegionAvail().x)); }

std::optional<std::size_t> place_of(ViewerState& state, const std::string& name) {
    const std::vector<std::string>& names = names_of(state);
    auto& places = state.panels.places;
    if (places.empty())
        for (std::size_t i = 0; i < names.size(); ++i) places.emplace(names[i], i);
    const auto found = places.find(name);
    if (found == places.end()) return std::nullopt;
    return found->second;
}

const std::vector<std::string>& names_of(ViewerState& state) {
    PanelMemory& memory = state.panels;
    if (memory.named == state.document.scene_value()) return memory.names;
    // a drag renames nothing; when it has ended, the scene is looked at once
    const bool same = memory.named && state.document.dragging() &&
                      memory.names.size() == state.document.scene().elements.size();
    if (same) return memory.names;
    memory.named = state.document.scene_value();
    memory.names = element_names(*memory.named);
    memory.places.clear();
    for (const std::string& name : memory.names) want_glyphs(state, name);
    return memory.names;
}

}  // namespace ivory
