// Sphere tracing: Hart, "Sphere tracing: a geometric method for the antialiased ray tracing of
// implicit surfaces" (The Visual Computer 12, 1996). With a Lipschitz constant L of f no root is
// nearer than |f| / L, and that far the ray steps; the constant is that of the field along the ray
// (core/trace/methods/lipschitz.h). f is enclosed and every step rounded down, so a miss is proved;
// the steps end short of the root, where the distance bound is below the tolerance, so a hit is a
// claim.
#pragma once

#include "core/trace/methods/method.h"

namespace ivory {

class SphereTracing final : public Method {
  public:
    [[nodiscard]] std::string_view name() const override { return "sphere"; }
    [[nodiscard]] std::string_view proves() const override {
        return "miss: no root at all; a hit is claimed: no root before it, and a distance bound "
               "below the tolerance";
    }
    [[nodiscard]] Isolation isolate(const Field& field, const ElementList& list, const Ray& ray,
                                    const MethodOptions& options, Counts& counts) const override;
};

}  // namespace ivory
