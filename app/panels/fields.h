// The controls that the panels are made of. Each records itself in state.widgets, changes the scene
// through the document, a drag as one entry of its history, and draws itself in the theme's
// colours.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "app/panels/icons.h"
#include "app/panels/viewer_state.h"

namespace ivory {

struct NumberField {
    std::string id;
    std::string what;  // names the change in the history: "Change radius of circle 1"
    double value = 0;
    double step = 0.01;  // of a drag, per pixel at scale 1; a power of ten
    // Where a drag stops. Typed numbers are held to the rules of the scene instead.
    double least = -std::numeric_limits<double>::infinity();
    double greatest = std::numeric_limits<double>::infinity();
    std::optional<int> axis = std::nullopt;  // marked in its colour
};

// A field to drag sideways (Shift: fine), or to type into after a click, Ctrl+click or Tab: what is
// typed becomes exactly that double. "+=1", "-=", "*=", "/=" change the number that stands. What no
// scene may hold is refused with a message. Escape restores.
void number_field(ViewerState& state, const NumberField& field, float width,
                  const std::function<void(Scene&, double)>& set);

// Three of them, ID.x, ID.y and ID.z, over the rest of the line.
void vector_fields(ViewerState& state, const std::string& id, const std::string& what,
                   const Vec3d& value, double step,
                   const std::function<void(Scene&, const Vec3d&)>& set);

// A swatch; a click opens a picker of sRGB, its digits ID.hex and the linear numbers ID.r, ID.g and
// ID.b.
void color_field(ViewerState& state, const std::string& id, const std::string& what,
                 const Color& value, float width,
                 const std::function<void(Scene&, const Color&)>& set);

// True once, when a new text has been entered; `text` holds it. A click selects what stands there.
// `hint` stands in an empty field.
bool text_field(ViewerState& state, const std::string& id, std::string& text, float width,
                const char* hint = "", bool focus = false);

// A box and its label; true where it was clicked.
bool toggle(ViewerState& state, const std::string& id, const char* label, bool on);

// True where it was clicked. `on`: shown as switched on.
bool icon_button(ViewerState& state, const std::string& id, Icon icon, const char* tooltip,
                 bool enabled = true, bool on = false);
bool text_button(ViewerState& state, const std::string& id, const char* label, float width = 0,
                 bool enabled = true, bool strong = false);

// `text` with every character that no font draws as \u{539F}, and what such a text stands for.
[[nodiscard]] std::string shown_text(const ViewerState& state, const std::string& text);
[[nodiscard]] std::string meant_text(const std::string& shown);
// Fonts that have its characters are wanted from the next frame on.
void want_glyphs(ViewerState& state, const std::string& text);

// `text`, or as much of it as has room beside an ellipsis.
[[nodiscard]] std::string fitted_text(const std::string& text, float width);

// The last item's, shown when the pointer rests on it.
void tooltip(const char* text);

// A dialog in the middle of the window, over everything; where it is drawn, ImGui::EndPopup
// follows. A size of 0 fits the contents.
bool begin_dialog(const ViewerState& state, const char* name, float width = 0, float height = 0);

// A heading with space above it, unless it is the first of its panel.
void section(const ViewerState& state, const char* title);
// Begins a line "label   field"; the field follows, as wide as field_width().
void label(const ViewerState& state, const char* text);
[[nodiscard]] float field_width();

// So many pixels at scale 1.
[[nodiscard]] inline float px(const ViewerState& state, double pixels) {
    return static_cast<float>(pixels * state.scale);
}

// Changes a copy of the scene and makes it an entry of the history, unless it has a fault: then
// that is the message.
void edit_scene(ViewerState& state, const std::string& what,
                const std::function<void(Scene&)>& change);

// A power of ten: near a hundredth of |value|, for a drag that begins there.
[[nodiscard]] double step_for(double value);

// What was typed, as a double; nothing where it is no finite number. `value` is what stands now.
[[nodiscard]] std::optional<double> parse_number(const std::string& text, double value);

// One of ImGui's keys (ImGuiKey_Enter) went down in this frame, and no modifier is held with it.
[[nodiscard]] bool plain_key_pressed(int imgui_key);

// A drag of a control begins, goes on or is left: shared by fields that are not numbers.
void begin_field_drag(ViewerState& state, const std::string& id, const std::string& what);
void drag_field(ViewerState& state, const std::function<void(Scene&)>& change);
void end_field_drag(ViewerState& state);
// At the end of the panels: a control that vanished while it was dragged or typed into leaves
// nothing behind; Escape ends a drag as if it had never begun.
void end_lost_edits(ViewerState& state);

// element_names of the document's scene, kept from frame to frame.
[[nodiscard]] const std::vector<std::string>& names_of(ViewerState& state);
// The element that has that name, by its place in the list.
[[nodiscard]] std::optional<std::size_t> place_of(ViewerState& state, const std::string& name);

}  // namespace ivory
