// Interval Newton on the natural extensions of f and f': Mitchell, "Robust ray intersection with
// interval arithmetic" (Graphics Interface 1990). Where 0 is outside f([t]) there is no root, where
// it is outside f'([t]) there is at most one, which the Newton operator m - f(m) / f'([t]) closes in
// on; else the interval is halved. All rounding is outward. A certain change of sign between the
// ends makes an answer a hit; where rounding hides it, or f' keeps 0 down to the tolerance, Mitchell
// takes the interval for a root: a claim.
#pragma once

#include "core/trace/methods/method.h"

namespace ivory {

class IntervalNewton final : public Method {
  public:
    [[nodiscard]] std::string_view name() const override { return "newton"; }
    [[nodiscard]] std::string_view proves() const override {
        return "hit: a root in the interval and none before it; miss: no root at all; claimed "
               "where "
               "the slope may be 0 down to the tolerance";
    }
    [[nodiscard]] Isolation isolate(const Field& field, const ElementList& list, const Ray& ray,
                                    const MethodOptions& options, Counts& counts) const override;
};

}  // namespace ivory
