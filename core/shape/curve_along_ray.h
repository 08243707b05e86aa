// s(t) of a short arc of a curve along a ray, enclosed.
#pragma once

#include <span>

#include "core/interval/interval.h"
#include "core/interval/moving_square.h"
#include "core/math/vec3.h"
#include "core/shape/square_range.h"

namespace ivory {

// Of any closed set d^2 - |d|^2 t^2 is concave: s'' <= 2 |d|^2 / w^2, s' jumps downward alone, and s is
// nowhere above the parabola of a place that is nearest at one t. With R = |c'|^2 / |c''|, at the least, and
// d < R the foot is unique and s'' >= -2 |d|^2 / w^2 (d / R) / (1 - d / R).
struct CurveAlongRay {
    Vec3d a, origin, direction;
    double width = 1;
    std::span<const double> numbers;  // core/shape/curve_arc.h
    MovingSquare middle = {};         // of a ball that holds the arc, in widths
    double radius = 0;

    struct At {
        Interval<double> s, ds;
        double bend;  // of the feet (curve_arc::Feet)
    };
    using Over = SquareRange;

    [[nodiscard]] At at(double t) const;
    // Ranges over [t0, t1], t0 < t1, from the values at its ends.
    [[nodiscard]] Over over(double t0, double t1, const At& at0, const At& at1) const;

    // What the ball alone says of s over [t0, t1], for far less.
    [[nodiscard]] Interval<double> rough_square(double t0, double t1) const;
    [[nodiscard]] double rough_least() const;  // over all of the span
};

}  // namespace ivory
