// What the shapes' handles share: where they stand, and what dragging one does to a place, to a
// skeleton as a whole, to a centre with its normal and radius.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "app/shape/shape_in_hand.h"
#include "core/math/vec3.h"

namespace ivory {

// Free, a place moves in the plane parallel to the screen and is then seen exactly (dx, dy) further;
// along an axis, as near to that as the axis allows and with the other coordinates kept bit for bit.
// Nothing where the pointer's line of sight does not meet the axis' plane.
[[nodiscard]] std::optional<Vec3d> moved_place(const HandView& view, const Vec3d& place,
                                               const HandleMotion& motion);

// How far along the unit `direction` from `place` the pointer leads that is (dx, dy) from where
// `place` is seen. Its line of sight is cut with the plane through the line that faces the viewer
// most: a pointer that stays on the line as it is seen is met exactly.
[[nodiscard]] std::optional<double> distance_along(const Projection& view, const Vec3d& place,
                                                   const Vec3d& direction, double dx, double dy);

// A difference of places, added so that a coordinate which did not move keeps its bits.
[[nodiscard]] Vec3d shifted(Vec3d place, const Vec3d& by);

// The k of a normal's handle at center + k normal: 1 unless an arrow of that length, in the scene,
// would be too short to grab or too long to reach on the screen.
[[nodiscard]] double arrow_factor(const HandView& view, const Vec3d& center, const Vec3d& normal);

// Of the following the `move_` change what they are given, unless the pointer meets nothing: then
// they are false.

[[nodiscard]] inline bool move_place(Vec3d& place, const HandView& view,
                                     const HandleMotion& motion) {
    const auto to = moved_place(view, place, motion);
    if (to) place = *to;
    return to.has_value();
}

// All of `places` by as much as a handle at `from`.
template <class Places>
[[nodiscard]] bool move_all(Places&& places, const Vec3d& from, const HandView& view,
                            const HandleMotion& motion) {
    const auto to = moved_place(view, from, motion);
    if (!to) return false;
    for (Vec3d& place : places) place = shifted(place, *to - from);
    return true;
}

// The handles of the members that are places, called by their keys.
template <class S>
[[nodiscard]] std::vector<Grip> place_grips(const S& skeleton) {
    std::vector<Grip> grips;
    for_members<S>([&]<class Value>(const Member<S, Value>& member) {
        if (member.kind != MemberKind::place) return;
        if constexpr (std::is_same_v<Value, Vec3d>) {
            const Vec3d& place = skeleton.*member.value;
            grips.push_back({.name = std::string(member.key),
                             .kind = GripKind::place,
                             .part = part_name(member),
                             .place = place,
                             .value = place});
        }
    });
    return grips;
}

// That of them which `handle` names; null: none.
template <class S>
[[nodiscard]] Vec3d* place_named(S& skeleton, std::string_view handle) {
    Vec3d* named = nullptr;
    for_members<S>([&]<class Value>(const Member<S, Value>& member) {
        if (member.kind != MemberKind::place || member.key != handle) return;
        if constexpr (std::is_same_v<Value, Vec3d>) named = &(skeleton.*member.value);
    });
    return named;
}

// The handle of the element as a whole.
[[nodiscard]] inline Grip whole_grip(std::string_view name, const Vec3d& place) {
    return {.name = std::string(name),
            .kind = GripKind::whole,
            .part = {},
            .place = place,
            .value = place};
}

// A normal's arrow, out of the handle that stands at the centre.
[[nodiscard]] Grip normal_grip(const HandView& view, const Vec3d& center, const Vec3d& normal,
                               std::string_view arm);
[[nodiscard]] bool move_normal(Vec3d& normal, const Vec3d& center, const HandView& view,
                               const HandleMotion& motion);

// The radius about that normal, out of the handle that stands at the centre. It stands where it runs
// across the line of sight, so that it is seen at full length; it has no direction to lock and ends
// at 0.
[[nodiscard]] Grip radius_grip(const HandView& view, const Vec3d& center, const Vec3d& normal,
                               double radius, std::string_view arm);
[[nodiscard]] bool move_radius(double& radius, const Vec3d& center, const Vec3d& normal,
                               const HandView& view, const HandleMotion& motion);

// `center`, `normal` and `radius` of what has these members.
template <class S>
[[nodiscard]] std::vector<Grip> round_grips(const S& round, const HandView& view) {
    return {whole_grip("center", round.center),
            normal_grip(view, round.center, round.normal, "center"),
            radius_grip(view, round.center, round.normal, round.radius, "center")};
}
template <class S>
[[nodiscard]] bool move_round(S& round, std::string_view handle, const HandView& view,
                              const HandleMotion& motion) {
    if (handle == "center") return move_place(round.center, view, motion);
    if (handle == "normal") return move_normal(round.normal, round.center, view, motion);
    return move_radius(round.radius, round.center, round.normal, view, motion);
}

}  // namespace ivory
