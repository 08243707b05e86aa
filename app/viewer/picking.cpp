#include "app/viewer/picking.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/shape/shapes.h"
#include "core/field/field.h"
#include "core/field/support.h"
#include "core/field/surface.h"
#include "core/trace/methods/method.h"
#include "core/trace/ray.h"

namespace ivory {

namespace {

double distance_to_line(WindowPoint p, WindowPoint a, WindowPoint b) {
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double length2 = dx * dx + dy * dy;
    const double foot =
        length2 > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0;
    return std::hypot(p.x - a.x - foot * dx, p.y - a.y - foot * dy);
}

}  // namespace

std::optional<Picked> pick_surface(const Scene& scene, const Projection& view, WindowPoint at) {
    const WindowPoint middle{std::floor(at.x) + 0.5, std::floor(at.y) + 0.5};
    const Ray ray = view.line_of_sight(middle);
    const Field field = compile(scene);
    // far wider than the ray's rounding, far narrower than a pixel
    const ElementList list =
        reaching_elements(field, all_elements(field), {ray.origin, ray.direction, 1e-9});
    Counts counts;
    const MethodOptions options{.tolerance = 1e-6};
    const Isolation hit = methods().front()->isolate(field, list, ray, options, counts);
    if (hit.status == Status::miss) return std::nullopt;
    const double t = 0.5 * hit.t.lo + 0.5 * hit.t.hi;
    const FieldSample at_hit = sample(field, all_elements(field), ray.origin, ray.direction, t);
    return Picked{field.source[at_hit.strongest], ray.origin + t * ray.direction};
}

std::optional<Picked> pick_skeleton(const Scene& scene, const Projection& view, WindowPoint at,
                                    double radius) {
    std::optional<Picked> nearest;
    double least = radius;
    for (std::size_t i = 0; i < scene.elements.size(); ++i) {
        if (!scene.elements[i].visible) continue;
        for (const SkeletonLine& line : skeleton_lines(scene.elements[i]).lines) {
            std::optional<WindowPoint> before;
            for (const Vec3d& place : line) {
                const auto seen = view.project(place);
                if (seen) {
                    const double distance = distance_to_line(at, before.value_or(*seen), *seen);
                    if (distance <= least) {
                        least = distance;
                        nearest = Picked{i, std::nullopt};
                    }
                }
                before = seen;
            }
        }
    }
    return nearest;
}

}  // namespace ivory
