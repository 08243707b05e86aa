// Bisection on affine arithmetic: de Cusatis, de Figueiredo, Gattass, "Interval methods for
// raycasting implicit surfaces with affine arithmetic" (SIBGRAPI 1999), with the reduced and revised
// forms of core/trace/methods/affine_form.h. As an affine form bounds f by two parallel lines over
// the interval, what lies outside of their zeros is cut off before the rest is halved. Our rounding
// is outward, so a miss is proved; that a root exists is not shown, so a hit is a claim.
#pragma once

#include "core/trace/methods/method.h"

namespace ivory {

class AffineBisection final : public Method {
  public:
    [[nodiscard]] std::string_view name() const override { return "affine"; }
    [[nodiscard]] std::string_view proves() const override {
        return "miss: no root at all; a hit is claimed: an interval of the tolerance's width that "
               "may hold the first root";
    }
    [[nodiscard]] Isolation isolate(const Field& field, const ElementList& list, const Ray& ray,
                                    const MethodOptions& options, Counts& counts) const override;
};

}  // namespace ivory
