// Segment tracing: Galin, Guerin, Paris, Peytavie, "Segment tracing using local Lipschitz bounds"
// (Computer Graphics Forum 39(2), 2020). As sphere tracing, with a bound of |f'| along the ray over
// the next segment alone: the step is |f| / that bound, or the whole segment where that is shorter,
// and the next segment is twice the step (their growth factor). Values and slopes are enclosed and
// steps rounded down, so a miss is proved; the steps end short of the root, so a hit is a claim.
#pragma once

#include "core/trace/methods/method.h"

namespace ivory {

class SegmentTracing final : public Method {
  public:
    [[nodiscard]] std::string_view name() const override { return "segment"; }
    [[nodiscard]] std::string_view proves() const override {
        return "miss: no root at all; a hit is claimed: no root before it, and a distance bound "
               "below the tolerance";
    }
    [[nodiscard]] Isolation isolate(const Field& field, const ElementList& list, const Ray& ray,
                                    const MethodOptions& options, Counts& counts) const override;
};

}  // namespace ivory
