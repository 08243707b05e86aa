#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <unordered_map>
#include <vector>

#include "app/document/tidy.h"
#include "app/panels/buttons.h"
#include "app/panels/color_field.h"
#include "app/panels/layout.h"
#include "app/panels/number_field.h"
#include "app/panels/parts.h"
#include "app/panels/scene_edits.h"
#include "app/panels/theme.h"
#include "app/panels/typed_number.h"
#include "core/field/field.h"
#include "core/field/surface.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

// Places where much strength comes together: the skeletons of the fullest cells of a grid, about as
// wide as an element.
std::vector<std::size_t> fullest_places(const Field& field, std::size_t count) {
    double width = 0;
    for (std::size_t i = 0; i < field.size(); ++i) width = std::max(width, field.width[i]);
    struct Cell {
        double strength = 0;
        std::size_t first = 0;
    };
    std::unordered_map<std::uint64_t, Cell> cells;
    for (std::size_t i = 0; i < field.size(); ++i) {
        std::uint64_t key = 0;
        const Vec3d place = field.a(i);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double step = std::clamp(std::floor(place[axis] / width), -9e15, 9e15);
            key = (key ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(step))) *
                  0x9E3779B97F4A7C15u;
            key ^= key >> 29;
        }
        Cell& cell = cells.try_emplace(key, Cell{0, i}).first->second;
        cell.strength += std::max(0.0, field.strength[i]);
    }
    std::vector<Cell> order;
    for (const auto& [key, cell] : cells) order.push_back(cell);
    count = std::min(count, order.size());
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count),
                      order.end(), [](const Cell& a, const Cell& b) {
                          return a.strength != b.strength ? a.strength > b.strength
                                                          : a.first < b.first;
                      });
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < count; ++i) places.push_back(order[i].first);
    return places;
}

// About the field's greatest value: that on the skeletons, of all of them or of those where it is
// likely to be. Beyond it there is no surface to see.
double greatest_field(const Scene& scene) {
    constexpr std::size_t most_evaluations = 200'000, most_places = 64;
    double greatest = 0;
    if (scene.elements.empty()) return 1;
    for (const Element& element : scene.elements)
        if (element.visible) greatest = std::max(greatest, element.strength);
    const Field field = compile(scene);
    const std::size_t count =
        std::clamp<std::size_t>(most_evaluations / (field.size() + 1), 4, most_places);
    const auto look_at = [&](const Vec3d& place) {
        greatest = std::max(greatest, sample(field, place).value + scene.threshold);
    };
    for (const std::size_t i : fullest_places(field, count)) {
        look_at(field.a(i));
        const Vec3d middle = with_field_shape(
            field.shape[i], [&]<class S>() { return S::ball(field.columns(i)).center; });
        if (middle != field.a(i)) look_at(middle);
    }
    return greatest;
}

// A round number at or beyond `value`.
double round_up(double value) {
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    for (const double step : {1.0, 1.2, 1.5, 2.0, 3.0, 5.0})
        if (step * power >= value) return step * power;
    return 10 * power;
}

// The slider's ends: what the field takes in the scene, and the threshold that stands.
ThresholdRange threshold_range(ViewerState& state) {
    PanelMemory& memory = state.panels;
    const Document& document = state.document;
    // a slider does not change under the hand
    if (memory.ranged == document.scene_value() || document.dragging()) return memory.thresholds;
    const double threshold = document.scene().threshold;
    const bool first = memory.ranged == nullptr;
    const bool same_elements =
        memory.ranged && memory.ranged->elements == document.scene().elements;
    memory.ranged = document.scene_value();
    ThresholdRange& range = memory.thresholds;
    const auto holds_threshold = [&] {
        return range.least <= threshold && threshold <= range.most;
    };
    if (same_elements && holds_threshold()) return range;
    const double greatest = std::max(greatest_field(*memory.ranged), 1e-3);
    const bool serves = greatest <= range.most && greatest >= 0.3 * range.most;
    if (!first && serves && holds_threshold()) return range;
    range.most = round_up(std::max(greatest, threshold));
    range.least = std::min(greatest < 0.2 ? range.most / 1000 : 1e-3,
                           std::pow(10.0, std::floor(std::log10(threshold))));
    return range;
}

// Thresholds along the slider: two decades of logarithm below 0.1, then linear; logarithmic all the
// way where that would be too coarse somewhere.
//
//   0.001      0.01       0.1                              most
//   |-----------|-----------|--------------------------------|
//   0          0.2         0.4                               1
struct Scale {
    static constexpr double knee = 0.1, knee_at = 0.4;
    double least, most;

    [[nodiscard]] bool is_log() const { return most < 2 * knee || most > 5 || least < 1e-3; }
    [[nodiscard]] double value(double share) const {
        if (is_log()) return std::pow(most, share) * std::pow(least, 1 - share);
        if (share < knee_at) return least * std::pow(knee / least, share / knee_at);
        return knee + (most - knee) * (share - knee_at) / (1 - knee_at);
    }
    [[nodiscard]] double share(double value) const {
        double share = 0;
        if (is_log()) {
            share = (std::log10(value) - std::log10(least)) / decades();
        } else if (value < knee) {
            share = knee_at * std::log10(value / least) / std::log10(knee / least);
        } else {
            share = knee_at + (1 - knee_at) * (value - knee) / (most - knee);
        }
        return std::clamp(share, 0.0, 1.0);
    }
    [[nodiscard]] double decades() const { return std::log10(most) - std::log10(least); }
};

void set_threshold(Scene& scene, double threshold) { scene.threshold = threshold; }

// Two digits: ticks are round.
std::string tick_text(double tick) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.2g", tick);
    const double round = std::strtod(text.data(), nullptr);
    const bool plain = round >= 1e-4 && round < 1e5;
    return plain ? number_text(round) : text.data();
}

void draw_slider(ViewerState& state) {
    const Palette& colors = palette(state.theme);
    const ThresholdRange range = threshold_range(state);
    const Scale scale{range.least, range.most};
    const float width = field_width(), height = px(state, 24);
    ImGui::InvisibleButton("##threshold slider", {width, height});
    state.widgets.add("threshold.slider", WidgetKind::button);
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    const bool active = ImGui::IsItemActive(), hovered = ImGui::IsItemHovered();
    const float knob = px(state, 7);
    const float left = lo.x + knob, room = std::max(hi.x - lo.x - 2 * knob, 1.0f);

    const double mouse = static_cast<double>((ImGui::GetIO().MousePos.x - left) / room);
    DraggedField& drag = state.panels.dragged;
    if (ImGui::IsItemActivated()) {
        begin_field_drag(state, "threshold.slider", "Change threshold");
        // the knob is held where it was pressed, and moves with the pointer from there
        const double knob_at = scale.share(state.document.scene().threshold);
        const bool on_knob = std::abs(mouse - knob_at) * static_cast<double>(room) <= 1.3 * knob;
        drag.way = on_knob ? knob_at - mouse : 0;
        drag.start = on_knob ? mouse : std::numeric_limits<double>::quiet_NaN();
    }
    if (active && mouse != drag.start) {
        drag.start = std::numeric_limits<double>::quiet_NaN();  // it has moved
        const double value = scale.value(std::clamp(mouse + drag.way, 0.0, 1.0));
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

    std::vector<double> ticks{range.least};
    if (scale.is_log()) {
        // whole decades, a few of them
        const double stride = std::max(1.0, std::ceil(scale.decades() / 4));
        const double lowest = std::ceil(std::log10(range.least) + 0.7 * stride);
        for (double power = lowest; power < std::log10(range.most) - 0.7 * stride; power += stride)
            ticks.push_back(std::pow(10.0, power));
    } else {
        ticks.insert(ticks.end(), {0.01, 0.1});
    }
    ticks.push_back(range.most);
    for (const double tick : ticks) {
        const float x = std::floor(at(scale.share(tick)));
        list.AddLine({x, y + px(state, 7)}, {x, y + px(state, 10)}, packed(colors.quiet),
                     px(state, 1));
        const std::string text = tick_text(tick);
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
    color_field(state, id + ".color", "Change colour of " + name, light.color, swatch,
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
