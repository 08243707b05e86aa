// Fixed steps and bisection: what most people write. f in plain doubles at steps of a tenth of the
// least width through the bounding box; where its sign changes between two of them, bisection down
// to the tolerance. A sheet that is thinner than a step, or a bump that rises between two steps, is
// missed. Only a ray past the bounding box is a proved miss.
#pragma once

#include "core/trace/methods/method.h"

namespace ivory {

class Marching final : public Method {
  public:
    static constexpr double step = 0.1;  // of the least width

    [[nodiscard]] std::string_view name() const override { return "march"; }
    [[nodiscard]] std::string_view proves() const override {
        return "miss: the ray passes by the bounding box; all else is claimed, and what is thinner "
               "than a step may be missed";
    }
    [[nodiscard]] Isolation isolate(const Field& field, const ElementList& list, const Ray& ray,
                                    const MethodOptions& options, Counts& counts) const override;
};

}  // namespace ivory
