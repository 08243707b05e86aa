#include "core/trace/trace.h"

#include <array>

namespace ivory {

Answer trace(const Field& field, const ElementList& list, const Ray& ray, const Method& method,
             const MethodOptions& options, Counts& counts) {
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
