// s(t) of a convex part of a polygon along a ray, enclosed.
#pragma once

#include <span>

#include "core/interval/interval.h"
#include "core/math/vec3.h"
#include "core/shape/square_range.h"

namespace ivory {

// d is convex along every line, and so is s = d^2 / w^2: s' rises, and 0 <= s'' <= 2 |d|^2 / w^2.
struct ConvexAlongRay {
    Vec3d a, origin, direction;
    double width = 1, size = 0;       // of the skeleton, from a
    std::span<const double> numbers;  // core/shape/convex_part.h

    struct At {
        Interval<double> s, ds;
    };
    using Over = SquareRange;

    [[nodiscard]] At at(double t) const;
    // Ranges over [t0, t1], t0 < t1, from the values at its ends.
    [[nodiscard]] Over over(double t0, double t1, const At& at0, const At& at1) const;
};

}  // namespace ivory
