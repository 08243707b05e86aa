// Vectors of intervals, for both kinds of interval, and a function's value with its slope.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math/vec3.h"

namespace ivory::reference {

template <class I>
using Triple = std::array<I, 3>;

template <class I>
Triple<I> triple(const Vec3d& v, long exponent = 0) {
    return {I::of(v.x, exponent), I::of(v.y, exponent), I::of(v.z, exponent)};
}
template <class I>
Triple<I> plus(const Triple<I>& a, const Triple<I>& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class I>
Triple<I> minus(const Triple<I>& a, const Triple<I>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class I>
Triple<I> times(const Triple<I>& a, const I& x) {
    return {a[0] * x, a[1] * x, a[2] * x};
}
template <class I>
Triple<I> divided(const Triple<I>& a, const I& x) {
    return {a[0] / x, a[1] / x, a[2] / x};
}
template <class I>
I inner(const Triple<I>& a, const Triple<I>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class I>
I norm2(const Triple<I>& a) {
    return sqr(a[0]) + sqr(a[1]) + sqr(a[2]);
}
template <class I>
Triple<I> outer(const Triple<I>& a, const Triple<I>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class I>
Triple<I> hull(const Triple<I>& a, const Triple<I>& b) {
    return {hull(a[0], b[0]), hull(a[1], b[1]), hull(a[2], b[2])};
}

// e with the greatest component in [2^(e-1), 2^e).
inline long binary_exponent(const Vec3d& v) {
    int exponent = 0;
    std::frexp(std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}), &exponent);
    return exponent;
}
// N / |N|, scaled by a power of two first so that no square leaves the range of double.
template <class I>
Triple<I> unit(const Vec3d& n) {
    const Triple<I> m = triple<I>(n, -binary_exponent(n));
    return divided(m, sqrt(norm2(m)));
}

// A function and its derivative, at a point or over an interval of its argument.
template <class I>
struct Germ {
    I value, slope;
};

template <class I>
Germ<I> either(const Germ<I>& a, const Germ<I>& b) {
    return {hull(a.value, b.value), hull(a.slope, b.slope)};
}

}  // namespace ivory::reference
