// The answers of the rays of a bundle, as structure of arrays.
#pragma once

#include <array>
#include <cstddef>

#include "core/trace/ray.h"
#include "core/trace/ray_bundle.h"

namespace ivory {

struct BundleIsolations {
    static constexpr std::size_t capacity = RayBundle::capacity;

    std::array<Status, capacity> status;
    alignas(64) std::array<double, capacity> t_lo, t_hi;  // nothing on a miss and a claimed miss

    [[nodiscard]] Isolation operator[](std::size_t k) const {
        if (!possibly_hit(status[k])) return {status[k], Interval<double>::empty_set()};
        return {status[k], {t_lo[k], t_hi[k]}};
    }
    void set(std::size_t k, const Isolation& isolation) {
        status[k] = isolation.status;
        t_lo[k] = isolation.t.lo;
        t_hi[k] = isolation.t.hi;
    }
};

}  // namespace ivory
