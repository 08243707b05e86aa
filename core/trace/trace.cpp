#include "core/trace/trace.h"

#include <array>
#include <cstddef>
#include <optional>

#include "core/field/middle_scale.h"

namespace ivory {
namespace {

// The ray's points at the same t, where the field's middle has them. Empty: there is none, or they would
// not be exact.
std::optional<Ray> in_middle(const Field& field, const Ray& ray) {
    if (field.middle == nullptr) return std::nullopt;
    Ray middle = ray;
    for (Vec3d* const v : {&middle.origin, &middle.direction}) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::optional<double> x = scaled_exactly((*v)[axis], field.exponent_to_middle);
            if (!x) return std::nullopt;
            (*v)[axis] = *x;
        }
    }
    return middle;
}

// One ray after the other: such scenes are rare.
void trace_in_middle(const Field& field, const ElementList& list, const RayBundle& rays,
                     const Method& method, const MethodOptions& options,
                     BundleIsolations& isolations, BundleSurfaces* surfaces, Counts& counts) {
    if (surfaces != nullptr) surfaces->clear(rays.size());
    for (std::size_t k = 0; k < rays.size(); ++k) {
        if (counts.stop.requested()) {
            isolations.set(k, {Status::unresolved, {0.0, infinity<double>}});
            continue;
        }
        ++counts.skipping.rays_alone;
        const Answer answer = trace(field, list, rays.ray(k), method, options, counts);
        isolations.set(k, answer.isolation);
        if (surfaces != nullptr && possibly_hit(answer.isolation.status)) {
            surfaces->set(k, answer.surface);
        }
    }
}

}  // namespace

Answer trace(const Field& field, const ElementList& list, const Ray& ray, const Method& method,
             const MethodOptions& options, Counts& counts) {
    if (const std::optional<Ray> middle = in_middle(field, ray)) {
        return trace(*field.middle, all_elements(*field.middle), *middle, method, options, counts);
    }
    Answer answer;
    answer.isolation = method.isolate(field, list, ray, options, counts);
    const Status status = answer.isolation.status;
    if (status != Status::miss && status != Status::claimed_miss) {
        answer.surface = method.surface(field, list, ray, midpoint(answer.isolation.t), options);
    }
    return answer;
}

void trace_bundle(const Field& field, const ElementList& list, const ElementList& all,
                  const RayBundle& rays, const Method& method, const MethodOptions& options,
                  BundleIsolations& isolations, BundleSurfaces* surfaces, Counts& counts) {
    if (field.middle != nullptr) {
        trace_in_middle(field, all, rays, method, options, isolations, surfaces, counts);
        return;
    }
    method.trace_bundle(field, list, rays, options, isolations, surfaces, counts);
    if (list.left_out.lo == 0 && list.left_out.hi == 0) return;  // all were there
    std::array<double, RayBundle::capacity> again;
    bool any = false;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        again[k] = infinity<double>;
        if (isolations.status[k] != Status::unresolved || counts.stop.requested()) continue;
        ++counts.skipping.rays_alone;
        ++counts.climbers[Rung::alone_all];
        isolations.set(k, method.isolate(field, all, rays.ray(k), options, counts));
        if (surfaces == nullptr) continue;
        surfaces->forget(k);
        if (!possibly_hit(isolations.status[k])) continue;
        again[k] = midpoint(isolations[k].t);
        any = true;
    }
    if (any) {
        method.surface_bundle(field, list, rays, options, {again.data(), rays.size()}, *surfaces,
                              counts.stop);
    }
}

}  // namespace ivory
