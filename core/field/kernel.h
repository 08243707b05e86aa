// The kernels k(s) as functions of s = q^2, q = distance / width, with their first two derivatives
// by s. F = b k(s). Blinn 1982; Nishimura et al. 1985 (metaballs); Wyvill, McPheeters, Wyvill 1986
// (soft objects).
//
//              k(s)                                   k'(s)                    k''(s)
//   blinn      exp(-s)                                -exp(-s)                 exp(-s)
//   nishimura  1 - 3 s                 s <= 1/9       -3                       0
//              3/2 (1 - q)^2           1/9 <= s <= 1  -3/2 (1 - q) / q         3/4 / q^3
//   wyvill     (1 - s)^2 (9 - 4 s) / 9      s <= 1    -2/9 (1 - s)(11 - 6 s)   (34 - 24 s) / 9
// and 0 beyond s = 1 for the last two. The factored form of Wyvill's polynomial keeps its relative
// accuracy near s = 1, where the expanded one cancels.
//
// All three fall, and all three k' rise (each k is convex in s), so that ranges over [s] need only
// the ends. k'' falls on each piece; where it jumps (s = 1/9, s = 1) a range holds both one-sided
// values.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/interval/exp.h"
#include "core/interval/interval.h"
#include "core/scene/scene.h"

namespace ivory {

// Half a unit in the last place of 1: the relative error of one rounding to nearest.
inline constexpr double unit_roundoff = 0x1p-53;

struct KernelRange {
    Interval<double> k, dk, ddk;  // of k, k', k'' over a range of s
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

// exp(-s) for the s >= 0 within `radius` of a double: 1 - r <= exp(-+r) <= 1 + r + r^2 for r <=
// 1/4.
inline Interval<double> exp_minus(double s, double radius) {
    if (!(radius <= 0.25) || s > 600) {
        return exp(Interval<double>(sub_down(-s, radius), std::min(0.0, add_up(-s, radius))));
    }
    const double e = exp_nearest(-s);
    constexpr double rounding = exp_relative_error<double> + 8 * unit_roundoff;
    return {e * (1 - radius - rounding), std::min(e * (1 + radius * (1 + radius) + rounding), 1.0)};
}

// k at one double s >= 0, enclosed; 0 <= result <= 1.
inline Interval<double> kernel_at(KernelKind kind, double s) {
    using kernel_detail::above;
    using kernel_detail::below;
    if (kind == KernelKind::blinn) return exp_minus(s, 0);
    if (s >= 1) return {0.0, 0.0};
    double k;
    if (kind == KernelKind::wyvill) {
        k = (1 - s) * (1 - s) * (9 - 4 * s) / 9;
    } else if (9 * s <= 1) {
        // 1 - 3 s lies in [2/3, 1]: no cancellation. At 9 s = 1 after rounding both pieces agree to
        // well within the slack, since their difference is of second order there.
        k = 1 - 3 * s;
    } else {
        // 1 - sqrt(s) with the error of sqrt(s) taken into both ends before it is subtracted.
        const double q_lo = std::sqrt(s) * (1 - 4 * unit_roundoff);
        const double q_hi = std::sqrt(s) * (1 + 4 * unit_roundoff);
        const double lo = q_hi < 1 ? below(1.5 * (1 - q_hi) * (1 - q_hi)) : 0;
        return {std::max(lo, 0.0), above(1.5 * (1 - q_lo) * (1 - q_lo))};
    }
    return {std::max(below(k), 0.0), std::min(above(k), 1.0)};
}

// k'(s) at one double s >= 0, enclosed; never positive.
inline Interval<double> kernel_slope_at(KernelKind kind, double s) {
    using kernel_detail::above;
    using kernel_detail::below;
    if (kind == KernelKind::blinn) return -exp_minus(s, 0);
    if (s >= 1) return {0.0, 0.0};
    if (kind == KernelKind::wyvill) {
        const double dk = -2 * (1 - s) * (11 - 6 * s) / 9;
        return {below(dk), std::min(above(dk), 0.0)};
    }
    if (9 * s <= 1) return {below(-3), above(-3)};
    const double q_lo = std::sqrt(s) * (1 - 4 * unit_roundoff);
    const double q_hi = std::sqrt(s) * (1 + 4 * unit_roundoff);
    const double hi = q_hi < 1 ? above(-1.5 * (1 - q_hi) / q_hi) : 0;
    return {below(-1.5 * (1 - q_lo) / q_lo), std::min(hi, 0.0)};
}

// The range of k over [s], s >= 0 where it matters: a lower end below 0 counts as 0.
inline Interval<double> kernel_over(KernelKind kind, const Interval<double>& s) {
    if (is_empty(s)) return {0.0, 1.0};  // lost to overflow: all that k can be
    return {kernel_at(kind, s.hi).lo, kernel_at(kind, std::max(s.lo, 0.0)).hi};
}

// The ranges of k, k' and k'' over [s].
inline KernelRange kernel_range(KernelKind kind, const Interval<double>& s) {
    using kernel_detail::above;
    using kernel_detail::below;
    const double s_lo = std::max(s.lo, 0.0);
    KernelRange range;
    range.k = kernel_over(kind, s);
    if (is_empty(s)) {
        range.dk = range.ddk = Interval<double>::entire();
        return range;
    }
    if (kind == KernelKind::blinn) {
        range.dk = -range.k;
        range.ddk = range.k;
        return range;
    }
    range.dk = {kernel_slope_at(kind, s_lo).lo, kernel_slope_at(kind, s.hi).hi};
    if (s_lo > 1) {
        range.ddk = {0.0, 0.0};
    } else if (kind == KernelKind::wyvill) {
        range.ddk = {s.hi >= 1 ? 0.0 : below((34 - 24 * s.hi) / 9), above((34 - 24 * s_lo) / 9)};
    } else if (9 * s.hi < 1 - kernel_detail::slack) {
        range.ddk = {0.0, 0.0};
    } else {
        const double q_lo = std::max(std::sqrt(s_lo), 1.0 / 3);
        const double q_hi = std::sqrt(s.hi);
        const bool one_piece = 9 * s_lo > 1 + kernel_detail::slack && s.hi < 1;
        range.ddk = {one_piece ? below(0.75 / (q_hi * q_hi * q_hi)) : 0.0,
                     above(0.75 / (q_lo * q_lo * q_lo))};
    }
    return range;
}

}  // namespace ivory
