#include "core/trace/methods/method.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/field/surface.h"
#include "core/trace/methods/affine.h"
#include "core/trace/methods/bisection.h"
#include "core/trace/methods/march.h"
#include "core/trace/methods/newton.h"
#include "core/trace/methods/proved.h"
#include "core/trace/methods/segment.h"
#include "core/trace/methods/sphere.h"

namespace ivory {

SurfacePoint Method::surface(const Field& field, const ElementList& list, const Ray& ray, double m,
                             const MethodOptions&) const {
    const FieldSample at = sample(field, list, ray.origin, ray.direction, m);
    return {outward_normal(at.gradient), at.color};
}

void Method::trace_bundle(const Field& field, const ElementList& list, const RayBundle& rays,
                          const MethodOptions& options, BundleIsolations& isolations,
                          BundleSurfaces* surfaces, Counts& counts) const {
    if (!list.clusters.empty()) {
        const ElementList elements = elements_for(rays, field, list);
        return Method::trace_bundle(field, elements, rays, options, isolations, surfaces, counts);
    }
    if (surfaces != nullptr) surfaces->clear(rays.size());
    for (std::size_t k = 0; k < rays.size(); ++k) {
        if (counts.stop.requested()) {
            isolations.set(k, {Status::unresolved, {0.0, infinity<double>}});
            continue;
        }
        const Isolation isolation = isolate(field, list, rays.ray(k), options, counts);
        isolations.set(k, isolation);
        if (surfaces == nullptr || !possibly_hit(isolation.status)) continue;
        surfaces->set(k, surface(field, list, rays.ray(k), midpoint(isolation.t), options));
        counts.stop.after(list.elements.size());
    }
}

void Method::surface_bundle(const Field& field, const ElementList& list, const RayBundle& rays,
                            const MethodOptions& options, std::span<const double> m,
                            BundleSurfaces& surfaces, Cancellation& stop) const {
    if (!list.clusters.empty()) {
        return Method::surface_bundle(field, elements_for(rays, field, list), rays, options, m,
                                      surfaces, stop);
    }
    for (std::size_t k = 0; k < rays.size() && !stop.requested(); ++k) {
        if (!std::isfinite(m[k])) continue;
        surfaces.set(k, surface(field, list, rays.ray(k), m[k], options));
        stop.after(list.elements.size());
    }
}

void Method::certify_bundle(const Field&, const ElementList&, const RayBundle& rays,
                            const Footprint&, const MethodOptions&, BundleIsolations& isolations,
                            BundleSurfaces&, Counts&) const {
    std::fill_n(isolations.status.begin(), rays.size(), Status::unresolved);
}

ElementList elements_for(const RayBundle& rays, const Field& field, const ElementList& list) {
    return reaching_elements(
        field, list,
        {rays.bundle.origin, rays.bundle.axis, rays.bundle.spread, rays.bundle.radius});
}

Vec3d outward_normal(const Vec3d& gradient) {
    // Scaled first, so that no square over- or underflows.
    const double largest =
        std::fmax(std::abs(gradient.x), std::fmax(std::abs(gradient.y), std::abs(gradient.z)));
    const bool finite =
        std::isfinite(gradient.x) && std::isfinite(gradient.y) && std::isfinite(gradient.z);
    if (!finite || largest == 0) return {};
    const Vec3d g{gradient.x / largest, gradient.y / largest, gradient.z / largest};
    const double length = std::sqrt(dot(g, g));
    return {-g.x / length, -g.y / length, -g.z / length};
}

std::span<const Method* const> methods() {
    static const Proved proved;
    static const Bisection bisection;
    static const AffineBisection affine;
    static const IntervalNewton newton;
    static const SphereTracing sphere;
    static const SegmentTracing segment;
    static const Marching march;
    static const std::array<const Method*, 7> all{&proved, &bisection, &affine, &newton,
                                                  &sphere, &segment,   &march};
    return all;
}

const Method* find_method(std::string_view name) {
    for (const Method* method : methods()) {
        if (method->name() == name) return method;
    }
    return nullptr;
}

}  // namespace ivory
