#include "core/render/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/math/direction.h"
#include "core/scene/error.h"
#include "core/scene/scene_fault.h"

namespace ivory {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180;

double length(const Vec3d& v) { return std::hypot(v.x, v.y, v.z); }

bool finite(const Vec3d& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Vec3d through_plane(const View& view, double u, double v) {
    return view.forward + u * view.right + v * view.top;
}

}  // namespace

View make_view(const Camera& camera) {
    if (const auto fault = find_fault(camera)) {
        throw Error("camera: " + fault->pointer + ": " + fault->message);
    }
    View view;
    view.camera = camera;
    view.forward = unit(camera.target - camera.position);
    view.right = unit(cross(view.forward, unit(camera.up)));
    view.top = cross(view.right, view.forward);
    view.s = std::tan(camera.fov / 2 * radians_per_degree);
    if (!finite(view.forward) || !finite(view.right) || !(view.s > 0 && std::isfinite(view.s))) {
        throw Error("camera: its frame is lost to rounding; move the numbers nearer to 1");
    }
    return view;
}

double plane_u(const View& view, int width, int height, int i) {
    return (2 * (i + 0.5) / width - 1) * view.s * width / height;
}

double plane_v(const View& view, int height, int j) {
    return (1 - 2 * (j + 0.5) / height) * view.s;
}

Ray primary_ray(const View& view, int width, int height, int i, int j) {
    const Vec3d d = through_plane(view, plane_u(view, width, height, i), plane_v(view, height, j));
    const double norm = std::sqrt(dot(d, d));
    return {view.camera.position, {d.x / norm, d.y / norm, d.z / norm}};
}

// Each rounded step of plane_u and plane_v is monotonic, so the (u, v) of every pixel, as the
// doubles they are, lie in the rectangle between those of the corner pixels. The directions within
// an angle a < 90 degrees of an axis form a convex cone; so if the four corners of that rectangle
// lie in it, then all of the rectangle does, in exact arithmetic on forward, right and top.
//
// What rounding adds, with e = 2^-53: forward and right have length 1 within 4 e, and top is
// orthogonal to both within 4 e. Where |forward . right| <= 1/2, forward + u right + v top is
// therefore at least 0.7 sqrt(1 + u^2 + v^2) long, and the sum 1 + |u| + |v| of its terms at most
// 1.74 / 0.7 < 2.5 times as long as it is. Its three roundings per component put the computed
// vector off by 3 e of that sum, 8 e of its length; dividing by the norm turns it by another e at
// most. This counts for the pixel and for the corner, and the cross product and quotient below are
// off by less than 12 e. Together that is below 32 e; the margin is 128 e, and sin(a + b) <= sin a
// + b.
Cone cone_around(const View& view, int width, int height, const PixelRect& rect) {
    constexpr double margin = 128 * 0x1p-53;
    constexpr double every_direction = 2;
    const double u[2] = {plane_u(view, width, height, rect.x0),
                         plane_u(view, width, height, rect.x1 - 1)};
    const double v[2] = {plane_v(view, height, rect.y0), plane_v(view, height, rect.y1 - 1)};

    Cone cone;
    cone.apex = view.camera.position;
    cone.axis = through_plane(view, 0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1]));
    cone.sine = 0;
    const double axis_length = length(cone.axis);
    for (const double corner_u : u) {
        for (const double corner_v : v) {
            const Vec3d corner = through_plane(view, corner_u, corner_v);
            // 1e-6 of the product of the lengths is more than rounding could feign.
            const double lengths = axis_length * length(corner);
            const bool acute = dot(cone.axis, corner) > 1e-6 * lengths;
            const double sine = length(cross(cone.axis, corner)) / lengths;
            cone.sine = std::max(cone.sine, acute ? sine + margin : every_direction);
        }
    }
    const bool skewed = !(std::abs(dot(view.forward, view.right)) <= 0.5);
    if (skewed || !std::isfinite(cone.sine)) cone.sine = every_direction;
    return cone;
}

Bundle bundle_around(const View& view, int width, int height, const PixelRect& rect) {
    const Cone cone = cone_around(view, width, height, rect);
    return {cone.apex, unit(cone.axis), spread_of(cone)};
}

}  // namespace ivory
