// Numbers to drag or to type into. Each control records itself in state.widgets and changes the scene,
// or the camera of the view, as scene_edits.h says.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <variant>

#include "app/panels/viewer_state.h"

namespace ivory {

template <class Value>
using SetInScene = std::function<void(Scene&, const Value&)>;
template <class Value>
using SetInCamera = std::function<void(Camera&, const Value&)>;
using SetNumber = std::variant<SetInScene<double>, SetInCamera<double>>;
using SetVector = std::variant<SetInScene<Vec3d>, SetInCamera<Vec3d>>;

struct NumberField {
    std::string id;
    std::string what{};  // names the change in the scene's history: "Change radius of circle 1"
    double value = 0;
    double step = 0.01;  // of a drag, per pixel at scale 1; a power of ten
    // Where a drag stops. Typed numbers are held to the rules of the scene instead.
    double least = -std::numeric_limits<double>::infinity();
    double greatest = std::numeric_limits<double>::infinity();
    std::optional<int> axis = std::nullopt;  // marked in its colour
    // Shown at most, where the value follows from others and has all that a double can have.
    std::optional<int> digits = std::nullopt;
};

// The step of places: one pixel of a field's drag is about one pixel of the picture at the target.
[[nodiscard]] double step_in_scene(const ViewerState& state);

// A field to drag sideways (Shift: fine), or to type into after a click, Ctrl+click or Tab: what is
// typed becomes exactly that double. "+=1", "-=", "*=", "/=" change the number that stands. What no
// scene may hold is refused with a message. Escape restores.
void number_field(ViewerState& state, const NumberField& field, float width, const SetNumber& set);

// Three of them, ID.x, ID.y and ID.z, over the rest of the line.
void vector_fields(ViewerState& state, const std::string& id, const std::string& what,
                   const Vec3d& value, double step, const SetVector& set);

}  // namespace ivory
