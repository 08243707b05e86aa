// What the files of the shapes need to write their distance along a ray for any number type in the
// place of t: core/trace/methods/natural.h.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "core/interval/interval.h"
#include "core/interval/quick.h"
#include "core/math/vec3.h"
#include "core/shape/curve_along_ray.h"

namespace ivory::natural {

using Span = Interval<double>;

// start + t rate; the intervals hold the exact numbers and are as wide as rounding made them.
struct Linear {
    Span start, rate;
};

struct LinearVector {
    Linear x, y, z;
};

// A skeleton seen from one ray, in units of the element's width: linear in t are the vectors from its
// places, the foot of the perpendicular on a segment and the height above a circle's plane.
struct RaySkeleton {
    bool bounded = true;     // false: numbers too small to divide by; s >= 0 is all that is known
    bool collapsed = false;  // to the first place
    LinearVector from;       // its first place
    LinearVector from_b;     // the end b of a segment
    LinearVector across;     // from a segment's line, from a circle's or a disc's axis
    Linear along;            // lambda of a segment, h of a circle or a disc
    Vec3<Span> axis;         // M of a segment
    Span radius;             // of a circle, of a disc
    Span taper_rate;         // of a taper: w_b - w_a in least widths
    // Of what has numbers: those, what brings them into widths, and the skeleton's size, not in widths.
    std::span<const double> numbers;
    Span per_width;
    double size = 0;
    CurveAlongRay curve;  // of an arc; its ray and width are known of any skeleton
};

template <class Number>
[[nodiscard]] Number square(const LinearVector& v, const Number& t) {
    return sqr(linear(v.x, t)) + sqr(linear(v.y, t)) + sqr(linear(v.z, t));
}

using Vector = Vec3<Span>;

// s of a taper, and its derivative by t, over an interval of t: the foot of core/shape/taper.h (1)
// kept between the ends, and where it may pass one, or may not be one, the cases hulled.
struct SquareAndSlope {
    Span square, slope;
};
[[nodiscard]] SquareAndSlope taper_over(const RaySkeleton& e, const Span& t);
// s of a convex part of a polygon (core/shape/convex_part.h): the height above the plane, and beside it the
// least of its edges' squares, or 0 where it may be above the inside.
[[nodiscard]] SquareAndSlope convex_part_over(const RaySkeleton& e, const Span& t);
// s of an arc of a curve, which has no formula: its feet at both ends, and how far s and s' can be from
// there (core/shape/curve_along_ray.h).
[[nodiscard]] SquareAndSlope curve_arc_over(const RaySkeleton& e, const Span& t);

// As each number type has it: from the values and slopes over t or, where it is a line and what is left,
// from the value in the middle and the slopes, if that says more.
template <class Number, class Over>
[[nodiscard]] Number as_number(const Number& t, const Over& over) {
    const SquareAndSlope s = over(range(t));
    if constexpr (requires { along_slope(t, s.square, s.slope); }) {
        const Number line = along_slope(t, over(Span(t.mid)).square, s.slope);
        if (width(range(line)) <= width(s.square)) return line;
    }
    return enclosed(t, s.square, s.slope);
}

inline Vector minus(const Vector& a, const Vector& b) {
    return {quick::sub(a.x, b.x), quick::sub(a.y, b.y), quick::sub(a.z, b.z)};
}

inline Vector times(const Span& s, const Vector& v) {
    return {quick::mul(s, v.x), quick::mul(s, v.y), quick::mul(s, v.z)};
}

inline Span inner(const Vector& a, const Vector& b) {
    return quick::add(quick::add(quick::mul(a.x, b.x), quick::mul(a.y, b.y)), quick::mul(a.z, b.z));
}

inline Vector vector(const Vec3d& p) { return {Span(p.x), Span(p.y), Span(p.z)}; }

inline LinearVector moving(const Vector& start, const Vector& rate) {
    return {{start.x, rate.x}, {start.y, rate.y}, {start.z, rate.z}};
}

// N / |N|; the power of two takes care of numbers whose squares over- or underflow.
inline Vector unit(const Vec3d& n) {
    const double largest = std::fmax(std::abs(n.x), std::fmax(std::abs(n.y), std::abs(n.z)));
    int exponent = 0;
    std::frexp(largest, &exponent);
    Vector m;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double x = std::ldexp(n[axis], -exponent);
        m[axis] = std::ldexp(x, exponent) == n[axis] ? Span(x) : Span(next_down(x), next_up(x));
    }
    return times(quick::div(Span(1.0), quick::sqrt(inner(m, m))), m);
}

}  // namespace ivory::natural
