// Ivory's own method: safe steps on tight inclusion functions, a proved sign change at the end.
// Claims are of exact arithmetic on the doubles of scene and ray. One ray: core/trace/isolate.h.
// Bundles of them: packets in SIMD (core/trace/packet.h), and what these leave undecided ray by
// ray.
#pragma once

#include "core/trace/methods/method.h"

namespace ivory {

class Proved final : public Method {
  public:
    [[nodiscard]] std::string_view name() const override { return "proved"; }
    [[nodiscard]] std::string_view proves() const override {
        return "hit: a root in the interval and none before it; miss: no root at all";
    }
    [[nodiscard]] Isolation isolate(const Field& field, const ElementList& list, const Ray& ray,
                                    const MethodOptions& options, Counts& counts) const override;
    void trace_bundle(const Field& field, const ElementList& list, const RayBundle& rays,
                      const MethodOptions& options, BundleIsolations& isolations,
                      BundleSurfaces* surfaces, Counts& counts) const override;
    void certify_bundle(const Field& field, const ElementList& list, const RayBundle& rays,
                        const Footprint& footprint, const MethodOptions& options,
                        BundleIsolations& isolations, BundleSurfaces& surfaces,
                        Counts& counts) const override;
    void surface_bundle(const Field& field, const ElementList& list, const RayBundle& rays,
                        const MethodOptions& options, std::span<const double> m,
                        BundleSurfaces& surfaces, Cancellation& stop) const override;
};

}  // namespace ivory
