// What a hand does with a skeleton: what the file of a shape in this folder says, and what it says it
// in. Pure functions of elements, views and pixels; nothing here draws.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/document/orbit.h"
#include "app/platform/window_rect.h"
#include "core/math/vec3.h"
#include "core/shape/shapes.h"

namespace ivory {

// Specialised by the file of a shape; what it has to say: the concept ShapeForHands, shapes.h.
template <class Skeleton>
struct ShapeInHand;

// How the scene is looked at while a handle is moved.
struct HandView {
    Projection projection;
    double scale = 1;  // of the window
    // The length that a normal's arrow goes by: its own, or that which it had when it was grabbed
    // first, so that its tip does not leap.
    std::optional<double> arrow = std::nullopt;
};

struct HandleMotion {
    double dx = 0, dy = 0;    // pixels since the handle was grabbed
    std::optional<int> axis;  // 0 x, 1 y, 2 z: only along it
    bool round = false;       // to round coordinates, about ten pixels from one to the next
};

// What a handle changes; it is drawn and named accordingly.
enum class GripKind : std::uint8_t {
    place,      // one place of several, or the only one
    whole,      // the element as it is, to another place
    direction,  // at the tip of an arrow
    length,
};

// One degree of freedom at its place in the scene.
struct Grip {
    std::string name;  // of the element's handles each has another
    GripKind kind = GripKind::place;
    std::string part;  // what it is of the element, "end a"; empty: it moves all there is
    Vec3d place;
    std::variant<Vec3d, double> value;  // what it changes, as the element has it
    std::string arm = {};               // the handle that it stands out from; empty: none
};

// How the history calls what a grip or a field of that kind does: "Move end a of segment 1".
[[nodiscard]] inline std::string change_name(GripKind kind, std::string_view part,
                                             const std::string& element) {
    if (kind == GripKind::direction) return "Tilt " + element;
    const std::string does = kind == GripKind::length ? "Change " : "Move ";
    return part.empty() ? does + element : does + std::string(part) + " of " + element;
}

// A line of one place is a dot.
using SkeletonLine = std::vector<Vec3d>;

struct SkeletonLines {
    std::vector<SkeletonLine> lines;
    std::vector<Vec3d> dots = {};  // on them, as long as no handles stand there
};

// In the picture.
using PictureLine = std::vector<WindowPoint>;

// One stroke of a sign: coordinates from -1 to 1, x to the right and y down.
struct Stroke {
    enum class Kind : std::uint8_t { line, circle, disc };
    Kind kind;
    float x0, y0;      // where it begins, or its middle
    float x1, y1;      // where a line ends
    float radius = 0;  // of the others
};

namespace stroke {
constexpr Stroke line(float x0, float y0, float x1, float y1) {
    return {Stroke::Kind::line, x0, y0, x1, y1};
}
constexpr Stroke circle(float x, float y, float radius) {
    return {Stroke::Kind::circle, x, y, x, y, radius};
}
constexpr Stroke disc(float x, float y, float radius) {
    return {Stroke::Kind::disc, x, y, x, y, radius};
}
}  // namespace stroke

// The kind of handle, or of field, of a member.
constexpr GripKind grip_kind(MemberKind kind) {
    switch (kind) {
        case MemberKind::place:
        case MemberKind::places:
            return GripKind::place;
        case MemberKind::direction:
            return GripKind::direction;
        case MemberKind::length:
            break;
    }
    return GripKind::length;
}

// Whether a member of that kind is the only place of S: then it is where S is.
template <class S>
constexpr bool is_only_place(MemberKind kind) {
    int places = 0;
    for_members<S>([&](const auto& member) { places += member.kind == MemberKind::place; });
    return kind == MemberKind::place && places == 1;
}

// What a member is of its element, as it stands in a sentence: "end a", "radius"; empty for its only
// place.
template <class S, class Value>
[[nodiscard]] std::string part_name(const Member<S, Value>& member) {
    if (is_only_place<S>(member.kind)) return {};
    std::string part(member.label);
    if (part[0] >= 'A' && part[0] <= 'Z') part[0] = static_cast<char>(part[0] - 'A' + 'a');
    return part;
}

}  // namespace ivory
