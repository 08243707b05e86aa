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

bool finite(const Vec3d& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

Vec3d through_window(const View& view, double u, double v) {
    return view.forward + u * view.right + v * view.top;
}

Vec3d origin_on_plane(const View& view, double u, double v) {
    return view.origin + u * view.right + v * view.top;
}

// Its three roundings a component, and the plane's own axes.
double origin_error(const View& view, double reach) {
    const Vec3d& o = view.origin;
    return 0x1p-48 * (std::abs(o.x) + std::abs(o.y) + std::abs(o.z) + reach);
}

double height_of(const Camera& camera) {
    if (camera.height) return *camera.height;
    return 2 * length_of(camera.target - camera.position) *
           std::tan(camera.fov / 2 * radians_per_degree);
}

Camera with_height(const Camera& camera) {
    Camera written = camera;
    if (camera.is_orthographic()) written.height = height_of(camera);
    return written;
}

double usual_eye_distance(const Camera& camera) {
    return length_of(camera.target - camera.position) / 30;
}

View eye_of(const View& view, Eye eye, double apart) {
    if (view.is_orthographic()) {
        throw Error("camera: an orthographic camera has no two eyes; make it a perspective one");
    }
    View of_eye = view;
    const double to_right = eye == Eye::right ? apart / 2 : -apart / 2;
    of_eye.origin = view.camera.position + to_right * view.right;
    of_eye.shift = -to_right / length_of(view.camera.target - view.camera.position);
    if (!(apart > 0) || !finite(of_eye.origin) || !std::isfinite(of_eye.shift) ||
        of_eye.origin == view.camera.position) {
        throw Error("camera: its eyes are lost to rounding; move them farther apart");
    }
    return of_eye;
}

View make_view(const Camera& camera) {
    if (const auto fault = find_fault(camera)) {
        throw Error("camera: " + fault->pointer + ": " + fault->message);
    }
    View view;
    view.camera = camera;
    view.forward = unit(camera.target - camera.position);
    view.right = unit(cross(view.forward, unit(camera.up)));
    view.top = cross(view.right, view.forward);
    view.origin = camera.position;
    view.s = view.is_orthographic() ? height_of(camera) / 2
                                    : std::tan(camera.fov / 2 * radians_per_degree);
    if (!finite(view.forward) || !finite(view.right) || !(view.s > 0 && std::isfinite(view.s))) {
        throw Error("camera: its frame is lost to rounding; move the numbers nearer to 1");
    }
    return view;
}

double plane_u(const View& view, int width, int height, int i) {
    return (2 * (i + 0.5) / width - 1) * view.s * width / height + view.shift;
}

double plane_v(const View& view, int height, int j) {
    return (1 - 2 * (j + 0.5) / height) * view.s;
}

Ray primary_ray(const View& view, int width, int height, int i, int j) {
    const double u = plane_u(view, width, height, i), v = plane_v(view, height, j);
    if (view.is_orthographic()) return {origin_on_plane(view, u, v), view.forward};
    const Vec3d d = through_window(view, u, v);
    const double norm = std::sqrt(dot(d, d));
    return {view.origin, {d.x / norm, d.y / norm, d.z / norm}};
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
//
// An orthographic camera's origins lie in the parallelogram of the corners' exact places, but for
// `origin_error`.
Cone cone_around(const View& view, int width, int height, const PixelRect& rect) {
    if (view.is_orthographic()) {
        const Bundle bundle = bundle_around(view, width, height, rect);
        return {bundle.origin, bundle.axis, bundle.spread, bundle.radius};
    }
    constexpr double margin = 128 * 0x1p-53;
    constexpr double every_direction = 2;
    const double u[2] = {plane_u(view, width, height, rect.x0),
                         plane_u(view, width, height, rect.x1 - 1)};
    const double v[2] = {plane_v(view, height, rect.y0), plane_v(view, height, rect.y1 - 1)};

    Cone cone;
    cone.apex = view.origin;
    cone.axis = through_window(view, 0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1]));
    cone.sine = 0;
    const double axis_length = length_of(cone.axis);
    for (const double corner_u : u) {
        for (const double corner_v : v) {
            const Vec3d corner = through_window(view, corner_u, corner_v);
            // 1e-6 of the product of the lengths is more than rounding could feign.
            const double lengths = axis_length * length_of(corner);
            const bool acute = dot(cone.axis, corner) > 1e-6 * lengths;
            const double sine = length_of(cross(cone.axis, corner)) / lengths;
            cone.sine = std::max(cone.sine, acute ? sine + margin : every_direction);
        }
    }
    const bool skewed = !(std::abs(dot(view.forward, view.right)) <= 0.5);
    if (skewed || !std::isfinite(cone.sine)) cone.sine = every_direction;
    return cone;
}

Bundle orthographic_bundle(const View& view, double u0, double u1, double v0, double v1) {
    Bundle bundle;
    const double u = 0.5 * (u0 + u1), v = 0.5 * (v0 + v1);
    bundle.origin = origin_on_plane(view, u, v);
    bundle.axis = view.forward;
    for (const double corner_u : {u0, u1}) {
        for (const double corner_v : {v0, v1}) {
            const Vec3d off = (corner_u - u) * view.right + (corner_v - v) * view.top;
            bundle.radius = std::max(bundle.radius, length_of(off));
        }
    }
    const double error = origin_error(
        view, std::max(std::abs(u0), std::abs(u1)) + std::max(std::abs(v0), std::abs(v1)));
    bundle.radius = bundle.radius * (1 + 0x1p-40) + error + std::numeric_limits<double>::min();
    // Where `up` is nearly along the view forward and right are not quite orthogonal.
    bundle.spread = 0x1p-48 + 2 * std::abs(dot(view.forward, view.right)) + error / bundle.radius;
    return bundle;
}

Bundle bundle_around(const View& view, int width, int height, const PixelRect& rect) {
    if (view.is_orthographic()) {
        return orthographic_bundle(
            view, plane_u(view, width, height, rect.x0), plane_u(view, width, height, rect.x1 - 1),
            plane_v(view, height, rect.y0), plane_v(view, height, rect.y1 - 1));
    }
    const Cone cone = cone_around(view, width, height, rect);
    return {cone.apex, unit(cone.axis), spread_of(cone)};
}

}  // namespace ivory
