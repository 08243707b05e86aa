#include "app/shape/outlines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

#include "core/math/direction.h"

namespace ivory {

namespace {

constexpr int ring_steps = 64, outline_steps = 96, most_balls = 24;

Vec3d at_step(const Ring& ring, int step, int steps) {
    return ring.at(2 * std::numbers::pi * step / steps);
}

// A sphere of radius r at distance D is seen as the circle of radius r sqrt(1 - r^2/D^2) that lies
// r^2/D nearer than its centre, across the line of sight to it; from infinitely far away as the one
// across the view.
std::optional<PictureLine> sphere_outline(const Projection& view, const Vec3d& center,
                                          double radius) {
    const Vec3d towards = view.towards_eye(center);
    double share = 0;
    if (!view.is_orthographic()) {
        const double away = view.distance_to(center);
        if (away <= radius * 1.0001) return std::nullopt;
        share = radius / away;
    }
    const Ring ring(center + (radius * share) * towards, towards,
                    radius * std::sqrt(1 - share * share));
    PictureLine line;
    for (int step = 0; step < outline_steps; ++step) {
        const auto seen = view.project(at_step(ring, step, outline_steps));
        if (!seen) return std::nullopt;
        line.push_back(*seen);
    }
    return line;
}

// Andrew's monotone chain.
PictureLine convex_hull(PictureLine points) {
    std::sort(points.begin(), points.end(),
              [](WindowPoint a, WindowPoint b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    const auto turn = [](WindowPoint o, WindowPoint a, WindowPoint b) {
        return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
    };
    PictureLine hull;
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

}  // namespace

Ring::Ring(const Vec3d& center, const Vec3d& normal, double radius)
    : center_(center), n_(unit(normal)), radius_(radius) {
    const Vec3d helper = std::abs(n_.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    e1_ = unit(cross(n_, helper));
    e2_ = cross(n_, e1_);
}

Vec3d Ring::at(double angle) const {
    return center_ + radius_ * (std::cos(angle) * e1_ + std::sin(angle) * e2_);
}

SkeletonLine ring_line(const Ring& ring) {
    SkeletonLine line;
    for (int step = 0; step <= ring_steps; ++step)
        line.push_back(at_step(ring, step % ring_steps, ring_steps));
    return line;
}

std::vector<PictureLine> hull_outline(const Projection& view, std::span<const Ball> balls) {
    PictureLine all;
    for (const Ball& ball : balls) {
        const auto ring = sphere_outline(view, ball.center, ball.radius);
        if (!ring) return {};
        all.insert(all.end(), ring->begin(), ring->end());
    }
    // the convex hull of balls is seen as that of what they are seen as
    if (balls.size() > 1) all = convex_hull(std::move(all));
    return {std::move(all)};
}

std::vector<PictureLine> disc_outline(const Projection& view, const Ring& rim, double distance) {
    std::vector<Ball> balls;
    for (int step = 0; step < ring_steps; ++step)
        balls.push_back({at_step(rim, step, ring_steps), distance});
    return hull_outline(view, balls);
}

namespace {

// From infinitely far away a ring of radius r is seen as an ellipse with the half axes r and r c, c the
// cosine of its tilt, and the tube around it as all that is within the distance of that: its edges are
// the ellipse's parallel curves. Where the ellipse's normal has the direction (cos a, sin a),
//   x = r cos a / k,  y = r c^2 sin a / k,  k^2 = cos^2 a + c^2 sin^2 a.
// Equal steps of the normal serve the ends of a narrow ellipse, equal steps of the ring its sides; one
// that is seen edge on has ends alone, and the sides are straight between them.
std::vector<PictureLine> parallel_ring_outline(const Projection& view, const Ring& ring,
                                               double distance) {
    const Vec3d across = cross(ring.normal(), view.back());
    const double sine = std::sqrt(dot(across, across));
    const double c = std::abs(dot(ring.normal(), view.back()));
    const Vec3d major = sine > 1e-9 ? (1 / sine) * across : view.right();
    const Vec3d minor = cross(view.back(), major);
    constexpr double edge_on = 1e-9;
    std::vector<double> angles;
    for (int step = 0; step < outline_steps; ++step) {
        const double angle = 2 * std::numbers::pi * (step + 0.5) / outline_steps - std::numbers::pi;
        angles.push_back(angle);
        if (c > edge_on) angles.push_back(std::atan2(std::sin(angle), c * std::cos(angle)));
    }
    std::sort(angles.begin(), angles.end());
    std::vector<PictureLine> edges;
    for (const double side : {1.0, -1.0}) {
        // the hole is closed
        if (side < 0 && distance >= c * ring.radius()) break;
        PictureLine line;
        for (const double angle : angles) {
            const double x = std::cos(angle), y = std::sin(angle);
            const double share = ring.radius() / std::max(std::hypot(x, c * y), 1e-300);
            const auto seen =
                view.project(ring.center() + (share * x + side * distance * x) * major +
                             (share * c * c * y + side * distance * y) * minor);
            if (!seen) return {};
            line.push_back(*seen);
        }
        edges.push_back(std::move(line));
    }
    return edges;
}

}  // namespace

// The outline of a tube around a curve: where its normal n, across the tangent, is also across the
// line of sight. With v the curve's place seen from the camera, n . v = -radius; among the unit
// vectors across the tangent that fixes two, one for each edge.
std::vector<PictureLine> ring_outline(const Projection& view, const Ring& ring, double distance) {
    if (view.is_orthographic()) return parallel_ring_outline(view, ring, distance);
    std::vector<PictureLine> edges(2);
    for (int step = 0; step < outline_steps; ++step) {
        const Vec3d place = at_step(ring, step, outline_steps);
        const Vec3d outward = ring.radius() > 0 ? unit(place - ring.center()) : ring.first_axis();
        const Vec3d from_camera = place - view.camera().position;
        const double u = dot(from_camera, outward), v = dot(from_camera, ring.normal());
        const double size = std::hypot(u, v);
        if (size <= distance * 1.0001) return {};  // the line of sight runs along the tube
        const double toward = std::atan2(v, u), half = std::acos(-distance / size);
        for (std::size_t edge = 0; edge < 2; ++edge) {
            const double angle = edge == 0 ? toward + half : toward - half;
            const auto seen = view.project(
                place + distance * (std::cos(angle) * outward + std::sin(angle) * ring.normal()));
            if (!seen) return {};
            edges[edge].push_back(*seen);
        }
    }
    return edges;
}

// A ball about the middle of each square of a grid reaches its corners; those that the disc does not
// reach are left out.
void cover_disc(const Ring& rim, double distance, std::vector<Ball>& balls) {
    const double r = rim.radius();
    const int rows = std::clamp(pieces_to_cover(2 * r, distance), 1, 5);
    const double half = r / rows, reach = (rows > 1 ? std::numbers::sqrt2 : 1) * half * (1 + 1e-9);
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < rows; ++j) {
            const double x = (2 * i + 1) * half - r, y = (2 * j + 1) * half - r;
            if (std::hypot(x, y) > r + reach) continue;
            balls.push_back(
                {rim.center() + x * rim.first_axis() + y * rim.second_axis(), distance + reach});
        }
    }
}

int pieces_to_cover(double curve_length, double distance) {
    const double wanted = distance > 0 ? std::ceil(curve_length / distance) : most_balls;
    return static_cast<int>(std::clamp(wanted, 1.0, static_cast<double>(most_balls)));
}

}  // namespace ivory
