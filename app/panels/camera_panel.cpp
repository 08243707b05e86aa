#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/panels/actions.h"
#include "app/panels/buttons.h"
#include "app/panels/camera_moves.h"
#include "app/panels/choice_field.h"
#include "app/panels/layout.h"
#include "app/panels/number_field.h"
#include "app/panels/parts.h"
#include "app/panels/saved_views.h"
#include "app/panels/scene_edits.h"
#include "app/panels/settings.h"
#include "app/panels/shown_text.h"
#include "app/panels/text_field.h"
#include "app/panels/theme.h"
#include "app/panels/typed_number.h"
#include "core/render/camera.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

constexpr double row_height = 28;  // pixels at scale 1

void tool(ViewerState& state, const char* id, Icon icon, Action action) {
    const std::string hint = label_of(state, action) + "   " + info(action).keys;
    if (icon_button(state, id, icon, hint.c_str(), is_possible(state, action))) run(state, action);
    ImGui::SameLine(0, px(state, 2));
}

void draw_tools(ViewerState& state) {
    constexpr int count = 4;
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - count * ImGui::GetFrameHeight() -
                    (count - 1) * px(state, 2));
    tool(state, "camera.undo", Icon::undo, Action::undo_move);
    tool(state, "camera.redo", Icon::redo, Action::redo_move);
    tool(state, "camera.copy", Icon::copy, Action::copy_camera);
    tool(state, "camera.paste", Icon::paste, Action::paste_camera);
    ImGui::NewLine();
}

void draw_projection(ViewerState& state) {
    const std::array choices = {
        Choice{std::string(projection_words[0]), "Perspective"},
        Choice{std::string(projection_words[1]), "Orthographic"},
    };
    label(state, "Projection");
    const auto clicked = choice_field(state, "camera.projection", choices,
                                      static_cast<std::size_t>(state.view.camera.projection));
    if (clicked) set_projection(state, static_cast<Camera::Projection>(*clicked));
}

// Both are always there; the one that the projection does not use is greyed, and the height is then
// what is seen at the target.
void draw_size(ViewerState& state) {
    const Camera camera = state.view.camera;
    const bool parallel = camera.is_orthographic();
    ImGui::BeginDisabled(parallel);
    label(state, "View angle");
    number_field(
        state,
        {.id = "camera.fov", .value = camera.fov, .step = 0.1, .least = 0.1, .greatest = 179.9},
        field_width(), [](Camera& changed, double fov) { changed.fov = fov; });
    ImGui::EndDisabled();
    if (parallel) tooltip("An orthographic camera has none.");
    ImGui::BeginDisabled(!parallel);
    label(state, "Height");
    const double height = seen_height(camera), step = step_for(height);
    number_field(state,
                 {.id = "camera.height", .value = height, .step = step, .least = step, .digits = 6},
                 field_width(), [](Camera& changed, double given) { changed.height = given; });
    ImGui::EndDisabled();
    if (!parallel) tooltip("What is seen from top to bottom at the target.");
}

void draw_samples(ViewerState& state) {
    const std::array choices = {Choice{"1", "1"}, Choice{"4", "4"}, Choice{"16", "16"}};
    label(state, "Samples");
    const auto now = std::find(samples_to_choose.begin(), samples_to_choose.end(), state.samples);
    const auto clicked = choice_field(state, "view.samples", choices,
                                      static_cast<std::size_t>(now - samples_to_choose.begin()));
    if (clicked) state.samples = samples_to_choose[*clicked];
}

void keep_view_and_name_it(ViewerState& state) {
    run(state, Action::keep_view);
    state.panels.view_name_wanted = true;
}

void draw_view_row(ViewerState& state, const SavedView& view) {
    const Palette& colors = palette(state.theme);
    const bool chosen = state.panels.view == view.name;
    const float width = field_width(), height = px(state, row_height);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    ImGui::PushID(view.name.c_str());
    const bool clicked = ImGui::InvisibleButton("##view", {width, height});
    state.widgets.add("views.row." + view.name, WidgetKind::row);
    const bool hovered = ImGui::IsItemHovered();
    if (hovered && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left))
        state.panels.view_name_wanted = true;
    if (chosen || hovered)
        list.AddRectFilled(at, {at.x + width, at.y + height},
                           packed(chosen ? colors.selected_row : colors.hovered_row), px(state, 4));
    // of the one that was chosen, whether the view is still there
    const bool left = chosen && view.camera != state.view.camera;
    const char* const mark = left ? "moved" : "";
    const float mark_width = ImGui::CalcTextSize(mark).x;
    const float y = std::floor(at.y + 0.5f * (height - ImGui::GetFontSize()));
    const float inside = px(state, 10);
    list.AddText({at.x + width - inside - mark_width, y}, packed(colors.quiet), mark);
    const std::string whole = shown_text(state, printable(view.name, 200));
    const std::string shown = fitted_text(whole, width - 3 * inside - mark_width);
    list.AddText({at.x + inside, y}, packed(colors.text), shown.c_str());
    if (shown != whole) tooltip(whole.c_str());
    ImGui::PopID();
    if (clicked) choose_view(state, view.name);
}

// What is done with the one that was chosen.
void draw_chosen_view(ViewerState& state, const SavedView& view) {
    label(state, "Name");
    std::string name = view.name;
    const bool wanted = std::exchange(state.panels.view_name_wanted, false);
    ImGui::PushID(view.name.c_str());
    const bool entered = text_field(state, "views.name", name, field_width(), "", wanted);
    ImGui::PopID();
    if (entered) rename_view(state, view.name, name);
    label(state, "");
    const float half = std::floor(0.5f * (field_width() - px(state, 4)));
    if (text_button(state, "views.replace", "Replace", half, view.camera != state.view.camera))
        replace_view(state, view.name);
    tooltip("Makes it the view that is seen now.");
    ImGui::SameLine(0, px(state, 4));
    if (text_button(state, "views.delete", "Delete", field_width())) delete_view(state, view.name);
}

}  // namespace

void draw_camera(ViewerState& state) {
    section(state, "Camera");
    draw_tools(state);
    draw_projection(state);
    const Camera camera = state.view.camera;
    const double step = step_in_scene(state);
    label(state, "Position");
    vector_fields(state, "camera.position", "", camera.position, step,
                  [](Camera& changed, const Vec3d& position) { changed.position = position; });
    label(state, "Target");
    vector_fields(state, "camera.target", "", camera.target, step,
                  [](Camera& changed, const Vec3d& target) { changed.target = target; });
    label(state, "Up");
    vector_fields(state, "camera.up", "", camera.up, 0.01,
                  [](Camera& changed, const Vec3d& up) { changed.up = up; });
    draw_size(state);
    draw_samples(state);
}

void draw_views(ViewerState& state) {
    section(state, "Views");
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::GetFrameHeight());
    if (icon_button(state, "views.add", Icon::plus, "Keep the view that is seen now"))
        keep_view_and_name_it(state);
    // by value: a click may change the scene
    const std::vector<SavedView> views = state.document.scene().views;
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {ImGui::GetStyle().ItemSpacing.x, 0});
    for (const SavedView& view : views) {
        want_glyphs(state, view.name);
        draw_view_row(state, view);
    }
    ImGui::PopStyleVar();
    if (views.empty()) ImGui::TextDisabled("None is kept yet.");
    const std::optional<std::string>& name = state.panels.view;
    const auto chosen = name ? find_view(views, *name) : std::nullopt;
    if (!chosen) return;
    ImGui::Dummy({0, px(state, 2)});
    draw_chosen_view(state, views[*chosen]);
}

}  // namespace ivory
