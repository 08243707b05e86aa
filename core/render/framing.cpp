#include "core/render/framing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/math/direction.h"
#include "core/render/cell_bounds.h"
#include "core/render/extent.h"
#include "core/scene/error.h"
#include "core/scene/scene_fault.h"

namespace ivory {
namespace {

constexpr double slack = framing_slack;

// Aimed at; what is left to `framed_share` is for the rounding of the picture's rays.
constexpr double aimed_share = 0.958;

bool finite(const Vec3d& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Where a perspective camera sees so much from top to bottom.
double distance_seeing(double height, double fov) {
    return height / 2 / std::tan(fov / 2 * std::numbers::pi / 180);
}

// All that is to be framed is within the middle of the picture of this very camera, whose numbers
// were rounded. With n the normal that `extent` was found for, m the one of the camera's own frame,
// e the eye, and p within `radius` of the middle c:
//   m . (p - e) <= n . (p - c) + |m - n| radius - m . (e - c),
// which has to be below 0; of an orthographic camera below half the window's width or height, and
// below 0 of its plane.
bool is_framed(const Extent& extent, const Frustum& wanted, const Camera& camera, double aspect) {
    if (find_fault(camera)) return false;
    const Vec3d away = camera.position - extent.middle;
    Frustum frustum;
    double half_height = 0;
    try {
        const View view = make_view(camera);
        half_height = view.s;
        frustum = frustum_of(view, aspect, aimed_share);
    } catch (const Error&) {
        return false;  // the frame is lost to rounding: farther away it is not
    }
    for (std::size_t side = 0; side < sides; ++side) {
        if (side == to_far || (side == to_near && !frustum.is_parallel)) continue;
        const double half = side < to_top ? frustum.half_width : frustum.half_height;
        const double limit = frustum.is_parallel && side < to_far ? half * half_height : 0;
        const Vec3d &m = frustum.normal[side], &n = wanted.normal[side];
        const double rounding = 64 * slack * (length_of(away) + extent.radius) * length_of(m);
        const double beyond =
            extent.reach[side] + length_of(m - n) * extent.radius - dot(m, away) + rounding;
        if (!(beyond < limit)) return false;
    }
    return true;
}

// The eye is so far back that both pairs of opposite planes leave room, and half way between the
// planes of each. An orthographic camera's window is so large, and stands as far before the target as
// another camera's eye would, but before all that is seen.
Camera camera_for(const Extent& extent, const Frustum& frustum, const Camera& seen_as,
                  double aspect) {
    const Reach& reach = extent.reach;
    const double needed = std::max((reach[to_right] + reach[to_left]) / (2 * frustum.half_width),
                                   (reach[to_top] + reach[to_bottom]) / (2 * frustum.half_height));
    const Vec3d across = 0.5 * (reach[to_right] - reach[to_left]) * frustum.right +
                         0.5 * (reach[to_top] - reach[to_bottom]) * frustum.top;
    const double depth = 0.5 * (reach[to_far] - reach[to_near]);
    Camera camera = seen_as;
    camera.target = extent.middle + (across + depth * frustum.forward);

    // Beside large coordinates a double is a coarse step; the direction has to survive it.
    constexpr double least_step = 0x1p-40;
    const Vec3d& at = camera.target;
    const double size = std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)});
    const double least = size > 0 ? least_step * size : needed + depth > 0 ? 0.0 : 1.0;
    for (double more = 0x1p-12; more < 0x1p60; more *= 2) {
        double away = std::max(needed * (1 + more) + depth, least * (1 + more));
        if (frustum.is_parallel) {
            const double height = std::max(2 * needed * (1 + more), least);
            const double behind_plane = 0.5 * (reach[to_far] + reach[to_near]);
            camera.height = height;
            away = std::max({distance_seeing(height, seen_as.fov), behind_plane + height / 2,
                             least * (1 + more)});
        }
        camera.position = extent.middle + (across + (depth - away) * frustum.forward);
        if (!finite(camera.position) || !finite(camera.target)) break;
        if (is_framed(extent, frustum, camera, aspect)) return camera;
    }
    throw Error("the scene is too large to be framed; give it a camera or move it nearer to 0");
}

}  // namespace

Framing frame_surface(const Field& field, const Camera& seen_as, double aspect) {
    const Frustum frustum = frustum_of(make_view(seen_as), aspect, aimed_share);
    Framing framing;
    ExtentWork work;
    const std::optional<Extent> solid = extent_of_solid(field, frustum, work);
    framing.empty = !solid;
    framing.cells = work.cells;
    framing.element_evaluations = work.evaluations;
    const Extent extent = solid ? *solid : extent_of({{-1, -1, -1}, {1, 1, 1}}, frustum);
    framing.camera = camera_for(extent, frustum, seen_as, aspect);
    return framing;
}

Camera default_camera(const Field& field, double aspect) {
    Camera from_there;
    from_there.position = unit(Vec3d{0.4, 0.3, 1});
    return frame_surface(field, from_there, aspect).camera;
}

Camera camera_of(const Scene& scene, const Field& field, int width, int height) {
    if (scene.camera) return *scene.camera;
    return default_camera(field, static_cast<double>(width) / height);
}

}  // namespace ivory
