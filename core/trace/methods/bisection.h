// The method of Chung, Noh and Kim ("Ray Tracing Implicit Surface Using Interval Method"), sections
// 4 to 6, as the baseline of every comparison: bounding box, natural interval extension of the
// distance formulas, bisection down to a given width, the midpoint taken for the root, the normal
// by central differences and the colour as sum C_i F_i / T. Their Table 1 is used corrected
// (products and squares), and our interval arithmetic rounds outward, which theirs did not: so a
// miss is proved. That a root exists is not shown: a hit is only claimed.
#pragma once

#include "core/trace/methods/method.h"

namespace ivory {

class Bisection final : public Method {
  public:
    [[nodiscard]] std::string_view name() const override { return "bisection"; }
    [[nodiscard]] std::string_view proves() const override {
        return "miss: no root at all; a hit is claimed: an interval of the tolerance's width that "
               "may "
               "hold the first root";
    }
    [[nodiscard]] Isolation isolate(const Field& field, const ElementList& list, const Ray& ray,
                                    const MethodOptions& options, Counts& counts) const override;
    [[nodiscard]] SurfacePoint surface(const Field& field, const ElementList& list, const Ray& ray,
                                       double m, const MethodOptions& options) const override;
};

}  // namespace ivory
