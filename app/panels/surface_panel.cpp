#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "app/document/tidy.h"
#include "app/panels/fields.h"
#include "app/panels/parts.h"
#include "app/panels/theme.h"
#include "core/field/field.h"
#include "core/field/surface.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

// About the field's greatest value: that on the skeletons, of many elements on some of them. Beyond
// it there is no surface to see. Never more than a millisecond or two.
double greatest_field(const Scene& scene) {
    constexpr std::size_t most_evaluations = 6'000, most_elements = 3'000;
    double greatest = 0;
    for (const Element& element : scene.elements)
        if (element.visible) greatest = std::max(greatest, element.strength);
    if (scene.elements.size() > most_elements) return 2 * greatest;
    const Field field = compile(scene);
    const std::size_t places =
        std::clamp<std::size_t>(most_evaluations / (field.size() + 1), 1, 64);
    const std::size_t stride = field.size() / places + 1;
    for (std::size_t i = 0; i < field.size(); i += stride) {
        const bool long_one = field.shape[i] == Shape::segment;
        const Vec3d place = long_one ? 0.5 * field.a(i) + 0.5 * field.b(i) : field.a(i);
        greatest = std::max(greatest, sample(field, place).value + scene.threshold);
        if (long_one)
            greatest = std::max(greatest, sample(field, field.a(i)).value + scene.threshold);
    }
    return greatest;
}

// The slider's right end: a round number at or beyond the greatest value.
double most_threshold(ViewerState& state) {
    PanelMemory& memory = state.panels;
    const Document& document = state.document;
    if (memory.ranged == document.scene_value() || document.dragging())
        return memory.most_threshold;
    const bool same_elements =
        memory.ranged && memory.ranged->elements == document.scene().elements;
    const bool first = memory.ranged == nullptr;
    memory.ranged = document.scene_value();
    if (same_elements) return memory.most_threshold;
    const double greatest = std::max(greatest_field(*memory.ranged), 1e-3);
    // it stays where it is while it serves: a slider should not change under the hand
    const bool serves =
        greatest <= memory.most_threshold && greatest >= 0.3 * memory.most_threshold;
    if (!first && serves) return memory.most_threshold;
    const double power = std::pow(10.0, std::floor(std::log10(greatest)));
    memory.most_threshold = 10 * power;
    for (const double step : {5.0, 3.0, 2.0, 1.5, 1.2, 1.0})
        if (step * power >= greatest) memory.most_threshold = step * power;
    return memory.most_threshold;
}

// Thresholds along the slider: two decades of logarithm below 0.1, then linear.
//
//   0.001      0.01       0.1                              most
//   |-----------|-----------|--------------------------------|
//   0          0.2         0.4                               1
struct Scale {
    static constexpr double knee = 0.1, knee_at = 0.4, decades = 2;
    double most;

    // All of it is logarithmic where the linear part would be none.
    [[nodiscard]] bool is_log() const { return most < 2 * knee; }
    [[nodiscard]] double value(double share) const {
        if (is_log()) return most * std::pow(10.0, 3 * (share - 1));
        if (share < knee_at) return knee * std::pow(10.0, decades * (share / knee_at - 1));
        return knee + (most - knee) * (share - knee_at) / (1 - knee_at);
    }
    [[nodiscard]] double share(double value) const {
        double share = 0;
        if (is_log()) {
            share = 1 + std::log10(value / most) / 3;
        } else if (value < knee) {
            share = knee_at * (1 + std::log10(value / knee) / decades);
        } else {
            share = knee_at + (1 - knee_at) * (value - knee) / (most - knee);
        }
        return std::clamp(share, 0.0, 1.0);
    }
};

void set_threshold(Scene& scene, double threshold) { scene.threshold = threshold; }

void draw_slider(ViewerState& state) {
    const Palette& colors = palette(state.theme);
    const Scale scale{most_threshold(state)};
    const float width = field_width(), height = px(state, 24);
    ImGui::InvisibleButton("##threshold slider", {width, height});
    state.widgets.add("threshold.slider", WidgetKind::button);
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    const bool active = ImGui::IsItemActive(), hovered = ImGui::IsItemHovered();
    const float knob = px(state, 7);
    const float left = lo.x + knob, room = std::max(hi.x - lo.x - 2 * knob, 1.0f);

    if (ImGui::IsItemActivated()) begin_field_drag(state, "threshold.slider", "Change threshold");
    if (active) {
        const double share =
            std::clamp(static_cast<double>((ImGui::GetIO().MousePos.x - left) / room), 0.0, 1.0);
        const double value = scale.value(share);
        // three digits
        const double round = tidy(value, static_cast<int>(std::floor(std::log10(value))) - 2);
        drag_field(state, [&](Scene& scene) { set_threshold(scene, round); });
    }
    if (ImGui::IsItemDeactivated()) end_field_drag(state);

    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float y = std::floor(lo.y + 0.36f * height), half = px(state, 2);
    const auto at = [&](double share) { return left + static_cast<float>(share) * room; };
    const float knob_x = at(scale.share(state.document.scene().threshold));
    list.AddRectFilled({left, y - half}, {left + room, y + half}, packed(colors.field_active),
                       half);
    list.AddRectFilled({left, y - half}, {knob_x, y + half}, packed(colors.accent), half);

    std::vector<double> ticks{scale.value(0)};
    if (scale.is_log()) {
        for (double tick = scale.most / 100; tick < 1.5 * scale.most; tick *= 10)
            ticks.push_back(tick);
    } else {
        ticks.insert(ticks.end(), {0.01, 0.1, scale.most});
    }
    for (const double tick : ticks) {
        const float x = std::floor(at(scale.share(tick)));
        list.AddLine({x, y + px(state, 7)}, {x, y + px(state, 10)}, packed(colors.quiet),
                     px(state, 1));
        const std::string text = number_text(tidy(tick, -6));
        const ImVec2 size = ImGui::CalcTextSize(text.c_str());
        const float text_x = std::clamp(x - 0.5f * size.x, lo.x, hi.x - size.x);
        list.AddText({std::floor(text_x), y + px(state, 11)}, packed(colors.quiet), text.c_str());
    }
    list.AddCircleFilled({knob_x, y}, knob, packed(colors.panel));
    list.AddCircleFilled({knob_x, y}, active || hovered ? knob : knob - px(state, 1.2),
                         packed(colors.accent));
    ImGui::Dummy({0, px(state, 6)});
}

void draw_threshold(ViewerState& state) {
    const Palette& colors = palette(state.theme);
    const double threshold = state.document.scene().threshold;
    const double step = step_for(threshold);
    label(state, "Threshold");
    number_field(state,
                 {.id = "threshold",
                  .what = "Change threshold",
                  .value = threshold,
                  .step = std::min(step, 0.01),
                  .least = std::min(step, 0.01)},
                 field_width(), set_threshold);
    draw_slider(state);
    const Scene& scene = state.document.scene();
    const bool none_visible = std::none_of(scene.elements.begin(), scene.elements.end(),
                                           [](const Element& element) { return element.visible; });
    if (state.picture.surface_certainly_empty || none_visible) {
        ImGui::PushStyleColor(ImGuiCol_Text, colors.accent);
        ImGui::TextWrapped("%s", none_visible
                                     ? "The surface is empty: no element is visible."
                                     : "The surface is empty: the field stays below T everywhere.");
        ImGui::PopStyleColor();
    }
}

// The lights as they are, the default ones written out as soon as one is changed.
std::vector<Light>& lights_of(Scene& scene) {
    if (!scene.lights) scene.lights = default_lights();
    return *scene.lights;
}

// False where it was deleted.
bool draw_light(ViewerState& state, const Light& light, std::size_t i) {
    const std::string id = "light." + std::to_string(i), name = "light " + std::to_string(i + 1);
    ImGui::PushID(static_cast<int>(i));
    label(state, ("Light " + std::to_string(i + 1)).c_str());
    const float button = ImGui::GetFrameHeight(), spacing = px(state, 4);
    const float rest = field_width() - button - 2 * spacing;
    const float swatch = std::floor(0.4f * rest);
    color_field(state, id + ".color", "Change color of " + name, light.color, swatch,
                [=](Scene& scene, const Color& color) { lights_of(scene)[i].color = color; });
    ImGui::SameLine(0, spacing);
    number_field(state,
                 {.id = id + ".intensity",
                  .what = "Change intensity of " + name,
                  .value = light.intensity,
                  .step = 0.01,
                  .least = 0},
                 rest - swatch, [=](Scene& scene, double intensity) {
                     lights_of(scene)[i].intensity = intensity;
                 });
    tooltip("Intensity");
    ImGui::SameLine(0, spacing);
    const bool deleted = icon_button(state, id + ".delete", Icon::trash, "Delete this light");

    label(state, "Direction");
    vector_fields(
        state, id + ".direction", "Turn " + name, light.direction, 0.01,
        [=](Scene& scene, const Vec3d& direction) { lights_of(scene)[i].direction = direction; });
    label(state, "");
    if (toggle(state, id + ".attached", "Moves with the camera", light.attached_to_camera))
        edit_scene(state, "Attach " + name, [=](Scene& scene) {
            Light& changed = lights_of(scene)[i];
            changed.attached_to_camera = !changed.attached_to_camera;
        });
    ImGui::PopID();
    ImGui::Dummy({0, px(state, 3)});
    if (deleted)
        edit_scene(state, "Delete " + name, [=](Scene& scene) {
            std::vector<Light>& lights = lights_of(scene);
            lights.erase(lights.begin() + static_cast<std::ptrdiff_t>(i));
        });
    return !deleted;
}

}  // namespace

void draw_surface(ViewerState& state) {
    section(state, "Surface");
    draw_threshold(state);
    label(state, "Background");
    color_field(state, "background", "Change background", state.document.scene().background,
                field_width(), [](Scene& scene, const Color& color) { scene.background = color; });
}

void draw_lights(ViewerState& state) {
    section(state, "Lights");
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::GetFrameHeight());
    if (icon_button(state, "lights.add", Icon::plus, "Add a light"))
        edit_scene(state, "Add light", [](Scene& scene) {
            lights_of(scene).push_back({{0.5, 1, 0.5}, {1, 1, 1}, 0.5, false});
        });
    const std::vector<Light> lights = state.document.scene().lights.value_or(default_lights());
    for (std::size_t i = 0; i < lights.size(); ++i)
        if (!draw_light(state, lights[i], i)) break;
    if (lights.empty()) ImGui::TextDisabled("No lights: only what shines from all around.");
}

}  // namespace ivory
