// An axis-parallel box, closed; empty where some lo exceeds its hi.
#pragma once

#include <algorithm>
#include <limits>

#include "core/math/vec3.h"

namespace ivory {

struct Box3 {
    static constexpr double infinity = std::numeric_limits<double>::infinity();

    Vec3d lo{infinity, infinity, infinity};
    Vec3d hi{-infinity, -infinity, -infinity};

    friend constexpr bool operator==(const Box3&, const Box3&) = default;

    constexpr bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }

    constexpr void include(const Box3& other) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            lo[axis] = std::min(lo[axis], other.lo[axis]);
            hi[axis] = std::max(hi[axis], other.hi[axis]);
        }
    }
};

}  // namespace ivory
