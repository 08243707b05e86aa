// The answers of the rays of a bundle, as structure of arrays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/trace/ray.h"
#include "core/trace/ray_bundle.h"

namespace ivory {

struct BundleIsolations {
    static constexpr std::size_t room = RayBundle::room;

    alignas(64) std::array<Status, room> status;
    alignas(64) std::array<double, room> t_lo, t_hi;  // nothing on a miss and a claimed miss

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

// What is in a bundle's answers, for statistics.
struct BundleTally {
    std::array<std::uint32_t, 5> rays{};       // that have each Status
    double widest = 0, widest_unresolved = 0;  // t_hi - t_lo, to nearest

    [[nodiscard]] std::uint32_t operator[](Status status) const {
        return rays[static_cast<std::size_t>(status)];
    }
};

// Of the first `count` rays.
[[nodiscard]] BundleTally tally_of(const BundleIsolations& isolations, std::size_t count);

}  // namespace ivory
