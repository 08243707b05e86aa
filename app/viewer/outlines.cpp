#include "app/viewer/outlines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>

#include "core/kernel/kernels.h"
#include "core/math/direction.h"

namespace ivory {

namespace {

using Line = std::vector<WindowPoint>;

constexpr int circle_steps = 64, outline_steps = 96;

double length(const Vec3d& v) { return std::hypot(v.x, v.y, v.z); }

// Two unit vectors across the unit vector n and each other.
std::pair<Vec3d, Vec3d> across(const Vec3d& n) {
    const Vec3d helper = std::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d e = unit(cross(n, helper));
    return {e, cross(n, e)};
}

Vec3d on_circle(const CircleSkeleton& circle, const std::pair<Vec3d, Vec3d>& axes, int step,
                int steps) {
    const double angle = 2 * std::numbers::pi * step / steps;
    return circle.center +
           circle.radius * (std::cos(angle) * axes.first + std::sin(angle) * axes.second);
}

// A sphere of radius r at distance D is seen as the circle of radius r sqrt(1 - r^2/D^2) that lies
// r^2/D nearer than its centre, across the line of sight to it.
std::optional<Line> sphere_outline(const Projection& view, const Vec3d& center, double radius) {
    const Vec3d to_camera = view.camera().position - center;
    const double away = length(to_camera);
    if (away <= radius * 1.0001) return std::nullopt;
    const Vec3d n = unit(to_camera);
    const auto [e1, e2] = across(n);
    const double share = radius / away;
    const Vec3d middle = center + (radius * share) * n;
    const double seen_radius = radius * std::sqrt(1 - share * share);
    Line line;
    for (int step = 0; step < outline_steps; ++step) {
        const double angle = 2 * std::numbers::pi * step / outline_steps;
        const auto seen =
            view.project(middle + seen_radius * (std::cos(angle) * e1 + std::sin(angle) * e2));
        if (!seen) return std::nullopt;
        line.push_back(*seen);
    }
    return line;
}

// Andrew's monotone chain.
Line convex_hull(Line points) {
    std::sort(points.begin(), points.end(),
              [](WindowPoint a, WindowPoint b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    const auto turn = [](WindowPoint o, WindowPoint a, WindowPoint b) {
        return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
    };
    Line hull;
    for (int side = 0; side < 2; ++side) {
        const std::size_t least = hull.size() + 1;
        for (const WindowPoint& p : points) {
            while (hull.size() > least && turn(hull[hull.size() - 2], hull.back(), p) <= 0)
                hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

// The outline of a tube around a curve: where its normal n, across the tangent, is also across the
// line of sight. With v the curve's place seen from the camera, n . v = -radius; among the unit
// vectors across the tangent that fixes two, one for each edge.
std::vector<Line> circle_tube_outline(const Projection& view, const CircleSkeleton& circle,
                                      double radius) {
    const Vec3d n = unit(circle.normal);
    const auto axes = across(n);
    std::vector<Line> edges(2);
    for (int step = 0; step < outline_steps; ++step) {
        const Vec3d place = on_circle(circle, axes, step, outline_steps);
        const Vec3d outward = circle.radius > 0 ? unit(place - circle.center) : axes.first;
        const Vec3d from_camera = place - view.camera().position;
        const double u = dot(from_camera, outward), v = dot(from_camera, n);
        const double size = std::hypot(u, v);
        if (size <= radius * 1.0001) return {};  // the line of sight runs along the tube
        const double toward = std::atan2(v, u), half = std::acos(-radius / size);
        for (std::size_t edge = 0; edge < 2; ++edge) {
            const double angle = edge == 0 ? toward + half : toward - half;
            const auto seen =
                view.project(place + radius * (std::cos(angle) * outward + std::sin(angle) * n));
            if (!seen) return {};
            edges[edge].push_back(*seen);
        }
    }
    return edges;
}

}  // namespace

std::vector<Vec3d> skeleton_line(const Skeleton& skeleton) {
    if (const auto* point = std::get_if<PointSkeleton>(&skeleton)) return {point->position};
    if (const auto* segment = std::get_if<SegmentSkeleton>(&skeleton))
        return {segment->a, segment->b};
    const auto& circle = std::get<CircleSkeleton>(skeleton);
    const auto axes = across(unit(circle.normal));
    std::vector<Vec3d> line;
    for (int step = 0; step <= circle_steps; ++step)
        line.push_back(on_circle(circle, axes, step % circle_steps, circle_steps));
    return line;
}

double iso_distance(const Element& element, double threshold) {
    const auto field = [&](double q) {
        return element.strength * kernel_at(element.kernel, q * q).lo;
    };
    if (!(field(0) >= threshold)) return -1;
    double inside = 0, outside = 1;
    while (outside < 64 && field(outside) >= threshold) outside *= 2;
    for (int step = 0; step < 50; ++step) {
        const double middle = 0.5 * (inside + outside);
        (field(middle) >= threshold ? inside : outside) = middle;
    }
    return inside * element.width;
}

std::vector<Line> tube_outline(const Projection& view, const Skeleton& skeleton, double distance) {
    if (const auto* point = std::get_if<PointSkeleton>(&skeleton)) {
        auto ring = sphere_outline(view, point->position, distance);
        return ring ? std::vector<Line>{*ring} : std::vector<Line>{};
    }
    if (const auto* segment = std::get_if<SegmentSkeleton>(&skeleton)) {
        // the convex hull of two spheres is seen as that of what they are seen as
        auto ring = sphere_outline(view, segment->a, distance);
        const auto other = sphere_outline(view, segment->b, distance);
        if (!ring || !other) return {};
        ring->insert(ring->end(), other->begin(), other->end());
        return {convex_hull(std::move(*ring))};
    }
    return circle_tube_outline(view, std::get<CircleSkeleton>(skeleton), distance);
}

}  // namespace ivory
