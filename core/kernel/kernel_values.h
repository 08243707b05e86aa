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
