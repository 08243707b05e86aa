#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/document/elements.h"
#include "app/panels/actions.h"
#include "app/panels/buttons.h"
#include "app/panels/choice_field.h"
#include "app/panels/color_field.h"
#include "app/panels/layout.h"
#include "app/panels/names.h"
#include "app/panels/number_field.h"
#include "app/panels/parts.h"
#include "app/panels/scene_edits.h"
#include "app/panels/text_field.h"
#include "app/panels/theme.h"
#include "app/panels/typed_number.h"
#include "app/shape/shapes.h"
#include "app/shape/widths.h"
#include "core/scene/scene_fault.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

// What would leave a skeleton that no file could hold is refused, and changes nothing.
template <class Change>
void change_unless_faulty(Element& element, const Change& change) {
    Element changed = element;
    change(changed);
    if (!find_fault(changed)) element = std::move(changed);
}

// The field of a member of the selected element's skeleton.
template <class S>
void draw_member(ViewerState& state, std::size_t element, const Member<S, Vec3d>& member,
                 const std::string& what, double step) {
    const Vec3d value =
        std::get<S>(state.document.scene().elements[element].skeleton).*member.value;
    vector_fields(state, "element." + std::string(member.key), what, value,
                  member.kind == MemberKind::direction ? 0.01 : step,
                  [=](Scene& scene, const Vec3d& changed) {
                      std::get<S>(scene.elements[element].skeleton).*member.value = changed;
                  });
}
template <class S>
void draw_member(ViewerState& state, std::size_t element, const Member<S, double>& member,
                 const std::string& what, double step) {
    number_field(
        state,
        {.id = "element." + std::string(member.key),
         .what = what,
         .value = std::get<S>(state.document.scene().elements[element].skeleton).*member.value,
         .step = step,
         .least = 0},
        field_width(), [=](Scene& scene, double changed) {
            std::get<S>(scene.elements[element].skeleton).*member.value = changed;
        });
}

// A table: a row for each place, its number first; the row that was clicked is the one that the
// buttons below are about.
template <class S>
void draw_member(ViewerState& state, std::size_t element,
                 const Member<S, std::vector<Vec3d>>& member, const std::string& name,
                 double step) {
    constexpr std::size_t most_rows = 8;  // in sight at once
    const std::vector<Vec3d> places =
        std::get<S>(state.document.scene().elements[element].skeleton).*member.value;
    std::size_t& current = state.panels.place;
    current = std::min(current, places.size() - 1);
    const std::string id = "element." + std::string(member.key);
    const float row = ImGui::GetFrameHeightWithSpacing();
    const float height = row * static_cast<float>(std::min(places.size(), most_rows));
    ImGui::NewLine();
    ImGui::BeginChild(id.c_str(), {0, height}, false,
                      ImGuiWindowFlags_NoNavInputs | ImGuiWindowFlags_NoNavFocus);
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(places.size()), row);
    while (clipper.Step()) {
        for (auto i = static_cast<std::size_t>(clipper.DisplayStart);
             i < static_cast<std::size_t>(clipper.DisplayEnd); ++i) {
            const std::string number = std::to_string(i + 1), row_id = id + "." + number;
            if (text_button(state, row_id, number.c_str(), px(state, 34), true, i == current)) {
                current = i;
            }
            ImGui::SameLine(0, px(state, 4));
            vector_fields(state, row_id, "Move point " + number + " of " + name, places[i], step,
                          [=](Scene& scene, const Vec3d& changed) {
                              change_unless_faulty(scene.elements[element], [&](Element& to) {
                                  (std::get<S>(to.skeleton).*member.value)[i] = changed;
                              });
                          });
        }
    }
    ImGui::EndChild();
    const std::string number = std::to_string(current + 1);
    const float half = std::floor(0.5f * (field_width() - px(state, 4)));
    if (text_button(state, id + ".insert", ("Insert after " + number).c_str(), half,
                    places.size() < member.most)) {
        edit_scene(state, "Insert a point into " + name, [&](Scene& scene) {
            change_unless_faulty(scene.elements[element],
                                 [&](Element& to) { insert_place(to, current); });
        });
        ++current;
    }
    ImGui::SameLine(0, px(state, 4));
    if (text_button(state, id + ".remove", ("Remove " + number).c_str(), half,
                    places.size() > member.least)) {
        edit_scene(state, "Remove point " + number + " of " + name, [&](Scene& scene) {
            change_unless_faulty(scene.elements[element],
                                 [&](Element& to) { remove_place(to, current); });
        });
    }
}

void draw_skeleton(ViewerState& state, std::size_t element, const std::string& name) {
    const double step = step_in_scene(state);
    const Shape shape = shape_of_skeleton(state.document.scene().elements[element].skeleton);
    with_shape(shape, [&]<class S>() {
        for_members<S>([&](const auto& member) {
            label(state, member.label.data());  // a literal: it ends with a 0
            const std::string what =
                member.kind == MemberKind::places
                    ? name
                    : change_name(grip_kind(member.kind), part_name(member), name);
            draw_member(state, element, member, what, step);
        });
    });
}

void draw_kernel(ViewerState& state, std::size_t element, const std::string& name) {
    const auto choices = []<class... K>(TypeList<K...>) {
        return std::array{Choice{kernel_word(kind_of<K>), K::label.data()}...};
    }(Kernels{});
    label(state, "Kernel");
    const KernelKind now = state.document.scene().elements[element].kernel;
    if (const auto clicked =
            choice_field(state, "element.kernel", choices, static_cast<std::size_t>(now)))
        edit_scene(state, "Change kernel of " + name, [&](Scene& scene) {
            scene.elements[element].kernel = static_cast<KernelKind>(*clicked);
        });
}

// One for all of it, or one for each end or point; what can taper has a switch beside it.
void draw_widths(ViewerState& state, std::size_t element, const std::string& name) {
    const Element now = state.document.scene().elements[element];
    const double step = step_for(now.width);
    const bool tapers = !now.widths.empty();
    const auto draw_switch = [&] {
        if (toggle(state, "element.tapers", "Tapers", tapers)) {
            edit_scene(state, (tapers ? "One width for " : "Taper ") + name,
                       [&](Scene& scene) { set_tapers(scene.elements[element], !tapers); });
        }
    };
    if (!tapers) {
        label(state, "Width");
        const float room = ImGui::GetFrameHeight() + px(state, 6) +
                           ImGui::CalcTextSize("Tapers").x + px(state, 12);
        number_field(state,
                     {.id = "element.width",
                      .what = "Change width of " + name,
                      .value = now.width,
                      .step = step,
                      .least = step},
                     can_taper(now) ? field_width() - room : field_width(),
                     [=](Scene& scene, double width) { scene.elements[element].width = width; });
        if (!can_taper(now)) return;
        ImGui::SameLine(0, px(state, 12));
        draw_switch();
        return;
    }
    label(state, "Widths");
    draw_switch();
    for (std::size_t i = 0; i < now.widths.size(); ++i) {
        const std::string number = std::to_string(i + 1), text = "Width " + number;
        label(state, text.c_str());
        number_field(state,
                     {.id = "element.width." + number,
                      .what = "Change width " + number + " of " + name,
                      .value = now.widths[i],
                      .step = step,
                      .least = step},
                     field_width(), [=](Scene& scene, double width) {
                         Element& changed = scene.elements[element];
                         changed.widths[i] = width;
                         changed.width =
                             *std::min_element(changed.widths.begin(), changed.widths.end());
                     });
    }
}

void draw_element(ViewerState& state, std::size_t element) {
    const Element now = state.document.scene().elements[element];
    const std::string name = names_of(state)[element];

    label(state, "Name");
    std::string text = name;
    const bool wanted = std::exchange(state.panels.name_wanted, false);
    ImGui::PushID(static_cast<int>(element));
    if (text_field(state, "element.name", text, field_width(), "", wanted))
        edit_scene(state, "Rename " + name,
                   [&](Scene& scene) { scene = with_name(std::move(scene), element, text); });
    ImGui::PopID();

    label(state, "Colour");
    const float toggle_width =
        ImGui::GetFrameHeight() + px(state, 6) + ImGui::CalcTextSize("Visible").x;
    color_field(state, "element.color", "Change colour of " + name, now.color,
                field_width() - toggle_width - px(state, 12),
                [=](Scene& scene, const Color& color) { scene.elements[element].color = color; });
    ImGui::SameLine(0, px(state, 12));
    if (toggle(state, "element.visible", "Visible", now.visible))
        set_visible(state, element, !now.visible);

    draw_kernel(state, element, name);
    label(state, "Strength");
    number_field(state,
                 {.id = "element.strength",
                  .what = "Change strength of " + name,
                  .value = now.strength,
                  .step = 0.01},
                 field_width(), [=](Scene& scene, double strength) {
                     scene.elements[element].strength = strength;
                 });
    draw_widths(state, element, name);
    draw_skeleton(state, element, name);
}

}  // namespace

void draw_inspector(ViewerState& state) {
    const auto selected = state.document.selected();
    if (!selected) {
        section(state, "Element");
        ImGui::PushStyleColor(ImGuiCol_Text, palette(state.theme).quiet);
        ImGui::TextWrapped("Nothing selected. Click the surface, or an element in the list.");
        ImGui::PopStyleColor();
        return;
    }
    const Element& element = state.document.scene().elements[*selected];
    section(state, with_shape(shape_of_skeleton(element.skeleton), []<class S>() {
                return S::label.data();  // a literal, too
            }));
    draw_element(state, *selected);
}

void draw_inspector_panel(ViewerState& state, const WindowRect& rect) {
    begin_panel("inspector", rect);
    draw_inspector(state);
    draw_surface(state);
    draw_lights(state);
    draw_camera(state);
    draw_views(state);
    ImGui::End();
}

}  // namespace ivory
