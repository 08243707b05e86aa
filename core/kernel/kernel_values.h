// What the files of the kernels share: rounding of short chains of operations, exp(-s) enclosed,
// and what is known of a kernel over a range of s and along a ray.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/interval/exp.h"
#include "core/interval/interval.h"

namespace ivory {

struct KernelRange {
    Interval<double> k, dk, ddk;  // of k, k', k'' over a range of s
};

// k(s(t)) over [t0, t1]: at its ends and over all of it; k(s(t))' at t0 and over all of it;
// k(s(t))'' over all of it.
struct KernelAlong {
    Interval<double> left, right, value;
    Interval<double> left_slope, slope, curvature;
};

namespace kernel_detail {

// A chain of fewer than ten roundings, each of relative error u, ends within 12 u of the exact
// value.
inline constexpr double slack = 12 * unit_roundoff;

// Bounds below and above from a value that carries at most `slack` of relative error. The absolute
// term covers products that underflow.
inline double below(double x) { return x - std::abs(x) * slack - 0x1p-1070; }
inline double above(double x) { return x + std::abs(x) * slack + 0x1p-1070; }

}  // namespace kernel_detail

// What a kernel has in common that is a polynomial in s up to s = 1, and 0 beyond: K::plain and
// K::plain_slope are k and k', 0 <= k <= 1 and k' <= 0, to fewer than ten roundings.
template <class K>
struct PolynomialKernel {
    static constexpr bool ends = true;

    static Interval<double> at(double s) {
        if (s >= 1) return {0.0, 0.0};
        const double k = K::plain(s);
        return {std::max(kernel_detail::below(k), 0.0), std::min(kernel_detail::above(k), 1.0)};
    }

    static Interval<double> slope_at(double s) {
        if (s >= 1) return {0.0, 0.0};
        const double dk = K::plain_slope(s);
        return {kernel_detail::below(dk), std::min(kernel_detail::above(dk), 0.0)};
    }
};

// exp(-s) for the s >= 0 within `radius` of a double: 1 - r <= exp(-+r) <= 1 + r + r^2 for
// r <= 1/4.
inline Interval<double> exp_minus(double s, double radius) {
    if (!(radius <= 0.25) || s > 600) {
        return exp(Interval<double>(sub_down(-s, radius), std::min(0.0, add_up(-s, radius))));
    }
    const double e = exp_nearest(-s);
    constexpr double rounding = exp_relative_error<double> + 8 * unit_roundoff;
    return {e * (1 - radius - rounding), std::min(e * (1 + radius * (1 + radius) + rounding), 1.0)};
}

}  // namespace ivory
