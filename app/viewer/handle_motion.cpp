#include "app/viewer/handle_motion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>

#include "app/document/tidy.h"
#include "core/math/direction.h"

namespace ivory {

namespace {

constexpr double shortest_arrow = 56, longest_arrow = 170;  // pixels at scale 1
constexpr double rounding_pixels = 6;  // at least, from one round number to the next

double length(const Vec3d& v) { return std::hypot(v.x, v.y, v.z); }

bool in_picture(const Projection& view, const Vec3d& place) {
    const auto seen = view.project(place);
    return seen && WindowRect{0, 0, view.size().width, view.size().height}.contains(*seen);
}

// Unit, in the circle's plane and parallel to the screen; to the right, or to the left where only
// that end is in the picture.
Vec3d radius_direction(const Projection& view, const CircleSkeleton& circle) {
    const Vec3d across = cross(unit(circle.normal), view.back());
    // seen along the normal, all directions run across the line of sight
    Vec3d direction = length(across) < 1e-6 ? view.right() : unit(across);
    const double rightward = dot(direction, view.right());
    if (std::abs(rightward) > 1e-9 ? rightward < 0 : dot(direction, view.top()) < 0)
        direction = -direction;
    const Vec3d end = circle.radius * direction;
    const bool turn =
        !in_picture(view, circle.center + end) && in_picture(view, circle.center - end);
    return turn ? -direction : direction;
}

// How far along the unit `direction` from `place` the pointer leads that is (dx, dy) from where
// `place` is seen. Its line of sight is cut with the plane through the line that faces the viewer
// most: a pointer that stays on the line as it is seen is met exactly.
std::optional<double> distance_along(const Projection& view, const Vec3d& place,
                                     const Vec3d& direction, double dx, double dy) {
    const double towards = dot(view.back(), direction);
    const Vec3d facing = view.back() - towards * direction;
    // seen from its end, a line is shorter than the hand is steady: down is nearer instead
    constexpr double end_on = 0.05;
    if (length(facing) < end_on)
        return std::copysign(dy * view.length_of_pixel(place), towards * dy);
    const auto seen = view.project(place);
    if (!seen) return std::nullopt;
    const Vec3d sight = view.direction({seen->x + dx, seen->y + dy});
    const Vec3d from_camera = place - view.camera().position;
    const double t = dot(from_camera, facing) / dot(sight, facing);
    // near the line's vanishing point the smallest move would lead out of the world
    constexpr double farthest = 20;  // times as far away as it was
    if (!(t > 0 && t <= farthest * length(from_camera))) return std::nullopt;
    return dot(t * sight - from_camera, direction);
}

std::optional<Vec3d> moved_place(const Projection& view, const Vec3d& place,
                                 const HandleMotion& motion, double scale) {
    Vec3d moved = place;
    if (motion.axis) {
        const auto axis = static_cast<std::size_t>(*motion.axis);
        Vec3d direction;
        direction[axis] = 1;
        const auto far = distance_along(view, place, direction, motion.dx, motion.dy);
        if (!far) return std::nullopt;
        moved[axis] = place[axis] + *far;
    } else if (motion.dx != 0 || motion.dy != 0) {
        moved = view.moved(place, motion.dx, motion.dy);
    }
    if (motion.round) {
        const int exponent = exponent_above(rounding_pixels * scale * view.length_of_pixel(place));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!motion.axis || static_cast<std::size_t>(*motion.axis) == axis)
                moved[axis] = tidy(moved[axis], exponent);
        }
    }
    return moved;
}

// A difference of places, added so that a coordinate which did not move keeps its bits.
Vec3d shifted(Vec3d place, const Vec3d& by) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (by[axis] != 0) place[axis] += by[axis];
    return place;
}

Vec3d middle_of(const SegmentSkeleton& segment) { return 0.5 * segment.a + 0.5 * segment.b; }

std::optional<Skeleton> moved_circle(const Projection& view, CircleSkeleton circle,
                                     const std::string& handle, const HandleMotion& motion,
                                     double scale, double arrow) {
    if (handle == "center") {
        const auto to = moved_place(view, circle.center, motion, scale);
        if (!to) return std::nullopt;
        circle.center = *to;
    } else if (handle == "normal") {
        const double factor = arrow_factor(view, circle.center, arrow, scale);
        const Vec3d tip = circle.center + factor * circle.normal;
        HandleMotion unrounded = motion;
        unrounded.round = false;
        const auto to = moved_place(view, tip, unrounded, scale);
        if (!to) return std::nullopt;
        circle.normal = shifted(circle.normal, (1 / factor) * (*to - tip));
        if (motion.round) {
            // to a tenth or so of its length
            const int exponent = exponent_above(length(circle.normal) / 20);
            for (std::size_t axis = 0; axis < 3; ++axis)
                if (!motion.axis || static_cast<std::size_t>(*motion.axis) == axis)
                    circle.normal[axis] = tidy(circle.normal[axis], exponent);
        }
    } else {
        const Vec3d outward = radius_direction(view, circle);
        const Vec3d place = circle.center + circle.radius * outward;
        const auto far = distance_along(view, place, outward, motion.dx, motion.dy);
        if (!far) return std::nullopt;
        circle.radius = std::max(0.0, circle.radius + *far);
        if (motion.round)
            circle.radius = tidy(circle.radius, exponent_above(rounding_pixels * scale *
                                                               view.length_of_pixel(place)));
    }
    return circle;
}

}  // namespace

double arrow_factor(const Projection& view, const Vec3d& center, double arrow, double scale) {
    const double pixel = view.length_of_pixel(center);
    return std::clamp(arrow, shortest_arrow * scale * pixel, longest_arrow * scale * pixel) / arrow;
}

std::vector<Grip> grips_of(const Projection& view, const Skeleton& skeleton, double scale,
                           std::optional<double> arrow) {
    if (const auto* point = std::get_if<PointSkeleton>(&skeleton))
        return {{"position", point->position}};
    if (const auto* segment = std::get_if<SegmentSkeleton>(&skeleton))
        return {{"a", segment->a}, {"b", segment->b}, {"middle", middle_of(*segment)}};
    const auto& circle = std::get<CircleSkeleton>(skeleton);
    const double factor =
        arrow_factor(view, circle.center, arrow.value_or(length(circle.normal)), scale);
    return {{"center", circle.center},
            {"normal", circle.center + factor * circle.normal},
            {"radius", circle.center + circle.radius * radius_direction(view, circle)}};
}

std::optional<Skeleton> moved_by(const Projection& view, const Skeleton& start,
                                 const std::string& handle, const HandleMotion& motion,
                                 double scale, std::optional<double> arrow) {
    if (motion.dx == 0 && motion.dy == 0 && !motion.round) return start;
    if (const auto* point = std::get_if<PointSkeleton>(&start)) {
        const auto to = moved_place(view, point->position, motion, scale);
        if (!to) return std::nullopt;
        return PointSkeleton{*to};
    }
    if (const auto* segment = std::get_if<SegmentSkeleton>(&start)) {
        const Vec3d from = handle == "a"   ? segment->a
                           : handle == "b" ? segment->b
                                           : middle_of(*segment);
        const auto to = moved_place(view, from, motion, scale);
        if (!to) return std::nullopt;
        if (handle == "a") return SegmentSkeleton{*to, segment->b};
        if (handle == "b") return SegmentSkeleton{segment->a, *to};
        const Vec3d by = *to - from;
        return SegmentSkeleton{shifted(segment->a, by), shifted(segment->b, by)};
    }
    const auto& circle = std::get<CircleSkeleton>(start);
    return moved_circle(view, circle, handle, motion, scale,
                        arrow.value_or(length(circle.normal)));
}

}  // namespace ivory
