// The part of a ray in a box. Kay, Kajiya 1986 (slabs).
#pragma once

#include <cmath>

#include "core/interval/interval.h"
#include "core/math/box3.h"
#include "core/math/vec3.h"

namespace ivory {

// Encloses the t >= 0 with origin + t direction in the box; empty: there are none. Components of
// the direction that are not greater than `least` bound nothing, unless they are 0.
[[nodiscard]] inline Interval<double> within_slabs(const Box3& box, const Vec3d& origin,
                                                   const Vec3d& direction, double least) {
    Interval<double> span{0.0, infinity<double>};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double o = origin[axis], d = direction[axis];
        if (std::abs(d) > least) {
            const Interval<double> slab(box.lo[axis], box.hi[axis]);
            span = intersection(span, (slab - Interval<double>(o)) / Interval<double>(d));
        } else if (d == 0 && (o < box.lo[axis] || o > box.hi[axis])) {
            return Interval<double>::empty_set();
        }
    }
    return span;
}

}  // namespace ivory
