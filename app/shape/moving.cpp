#include "app/shape/moving.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "app/document/tidy.h"
#include "core/math/direction.h"

namespace ivory {

namespace {

constexpr double shortest_arrow = 56, longest_arrow = 170;  // pixels at scale 1
constexpr double rounding_pixels = 6;  // at least, from one round number to the next

bool in_picture(const Projection& view, const Vec3d& place) {
    const auto seen = view.project(place);
    return seen && WindowRect{0, 0, view.size().width, view.size().height}.contains(*seen);
}

// Unit, in the plane across the normal and parallel to the screen; to the right, or to the left where
// only that end is in the picture.
Vec3d radius_direction(const Projection& view, const Vec3d& center, const Vec3d& normal,
                       double radius) {
    const Vec3d across = cross(unit(normal), view.back());
    // seen along the normal, all directions run across the line of sight
    Vec3d direction = length_of(across) < 1e-6 ? view.right() : unit(across);
    const double rightward = dot(direction, view.right());
    if (std::abs(rightward) > 1e-9 ? rightward < 0 : dot(direction, view.top()) < 0)
        direction = -direction;
    const Vec3d end = radius * direction;
    const bool turn = !in_picture(view, center + end) && in_picture(view, center - end);
    return turn ? -direction : direction;
}

// The exponent of the round numbers that a hand can tell apart there.
int rounding_exponent(const HandView& view, const Vec3d& place) {
    return exponent_above(rounding_pixels * view.scale * view.projection.length_of_pixel(place));
}

bool moves_along(const HandleMotion& motion, std::size_t axis) {
    return !motion.axis || static_cast<std::size_t>(*motion.axis) == axis;
}

}  // namespace

std::optional<double> distance_along(const Projection& view, const Vec3d& place,
                                     const Vec3d& direction, double dx, double dy) {
    const double towards = dot(view.back(), direction);
    const Vec3d facing = view.back() - towards * direction;
    // seen from its end, a line is shorter than the hand is steady: down is nearer instead
    constexpr double end_on = 0.05;
    if (length_of(facing) < end_on)
        return std::copysign(dy * view.length_of_pixel(place), towards * dy);
    const auto seen = view.project(place);
    if (!seen) return std::nullopt;
    const Ray sight = view.line_of_sight({seen->x + dx, seen->y + dy});
    const Vec3d from_origin = place - sight.origin;
    const double t = dot(from_origin, facing) / dot(sight.direction, facing);
    // near the line's vanishing point the smallest move would lead out of the world
    constexpr double farthest = 20;  // times as far away as it was
    if (!view.is_orthographic() && !(t > 0 && t <= farthest * length_of(from_origin)))
        return std::nullopt;
    return dot(t * sight.direction - from_origin, direction);
}

std::optional<Vec3d> moved_place(const HandView& view, const Vec3d& place,
                                 const HandleMotion& motion) {
    Vec3d moved = place;
    if (motion.axis) {
        const auto axis = static_cast<std::size_t>(*motion.axis);
        Vec3d direction;
        direction[axis] = 1;
        const auto far = distance_along(view.projection, place, direction, motion.dx, motion.dy);
        if (!far) return std::nullopt;
        moved[axis] = place[axis] + *far;
    } else if (motion.dx != 0 || motion.dy != 0) {
        moved = view.projection.moved(place, motion.dx, motion.dy);
    }
    if (motion.round) {
        const int exponent = rounding_exponent(view, place);
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (moves_along(motion, axis)) moved[axis] = tidy(moved[axis], exponent);
    }
    return moved;
}

Vec3d shifted(Vec3d place, const Vec3d& by) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (by[axis] != 0) place[axis] += by[axis];
    return place;
}

double arrow_factor(const HandView& view, const Vec3d& center, const Vec3d& normal) {
    const double arrow = view.arrow.value_or(length_of(normal));
    const double pixel = view.projection.length_of_pixel(center);
    return std::clamp(arrow, shortest_arrow * view.scale * pixel,
                      longest_arrow * view.scale * pixel) /
           arrow;
}

Grip normal_grip(const HandView& view, const Vec3d& center, const Vec3d& normal,
                 std::string_view arm) {
    const double factor = arrow_factor(view, center, normal);
    return {.name = "normal",
            .kind = GripKind::direction,
            .part = "normal",
            .place = center + factor * normal,
            .value = normal,
            .arm = std::string(arm)};
}

bool move_normal(Vec3d& normal, const Vec3d& center, const HandView& view,
                 const HandleMotion& motion) {
    const double factor = arrow_factor(view, center, normal);
    const Vec3d tip = center + factor * normal;
    HandleMotion unrounded = motion;
    unrounded.round = false;
    const auto to = moved_place(view, tip, unrounded);
    if (!to) return false;
    normal = shifted(normal, (1 / factor) * (*to - tip));
    if (motion.round) {
        // to a tenth or so of its length
        const int exponent = exponent_above(length_of(normal) / 20);
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (moves_along(motion, axis)) normal[axis] = tidy(normal[axis], exponent);
    }
    return true;
}

Grip radius_grip(const HandView& view, const Vec3d& center, const Vec3d& normal, double radius,
                 std::string_view arm) {
    return {.name = "radius",
            .kind = GripKind::length,
            .part = "radius",
            .place = center + radius * radius_direction(view.projection, center, normal, radius),
            .value = radius,
            .arm = std::string(arm)};
}

bool move_radius(double& radius, const Vec3d& center, const Vec3d& normal, const HandView& view,
                 const HandleMotion& motion) {
    const Vec3d outward = radius_direction(view.projection, center, normal, radius);
    const Vec3d place = center + radius * outward;
    const auto far = distance_along(view.projection, place, outward, motion.dx, motion.dy);
    if (!far) return false;
    radius = std::max(0.0, radius + *far);
    if (motion.round) radius = tidy(radius, rounding_exponent(view, place));
    return true;
}

}  // namespace ivory
