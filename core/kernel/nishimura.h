// Nishimura's metaball (Nishimura et al. 1985, "Object modeling by distribution function and a
// method of image generation"), with q = sqrt(s):
//
//            k(s)                           k'(s)                 k''(s)
//     1 - 3 s           s <= 1/9            -3                    0
//     3/2 (1 - q)^2     1/9 <= s <= 1       -3/2 (1 - q) / q      3/4 / q^3
//     0                 beyond
#ifndef IVORY_CORE_KERNEL_NISHIMURA_H
#define IVORY_CORE_KERNEL_NISHIMURA_H

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/kernel/kernel_values.h"

namespace ivory {

struct Nishimura {
    static constexpr std::string_view word = "nishimura";
    static constexpr std::string_view label = "Nishimura";
    static constexpr std::string_view formula = "1 - 3 q², from q = 1/3 to 1: 3/2 (1 - q)²";
    static constexpr std::string_view source = "Nishimura et al. 1985 (metaballs)";

    static constexpr bool ends = true;
    // sup |k'| and |k''| by s, and of sqrt(s) |k'|: what the bounds of all kernels that end rest on.
    static constexpr double greatest_slope = 3, greatest_curvature = 20.25, greatest_root_slope = 1;

    static Interval<double> at(double s) {
        using kernel_detail::above;
        using kernel_detail::below;
        if (s >= 1) return {0.0, 0.0};
        if (9 * s <= 1) {
            // 1 - 3 s lies in [2/3, 1]: no cancellation. At 9 s = 1 after rounding both pieces agree
            // to well within the slack, since their difference is of second order there.
            const double k = 1 - 3 * s;
            return {std::max(below(k), 0.0), std::min(above(k), 1.0)};
        }
        // 1 - sqrt(s) with the error of sqrt(s) taken into both ends before it is subtracted.
        const double q_lo = std::sqrt(s) * (1 - 4 * unit_roundoff);
        const double q_hi = std::sqrt(s) * (1 + 4 * unit_roundoff);
        const double lo = q_hi < 1 ? below(1.5 * (1 - q_hi) * (1 - q_hi)) : 0;
        return {std::max(lo, 0.0), above(1.5 * (1 - q_lo) * (1 - q_lo))};
    }

    static Interval<double> slope_at(double s) {
        using kernel_detail::above;
        using kernel_detail::below;
        if (s >= 1) return {0.0, 0.0};
        if (9 * s <= 1) return {below(-3), above(-3)};
        const double q_lo = std::sqrt(s) * (1 - 4 * unit_roundoff);
        const double q_hi = std::sqrt(s) * (1 + 4 * unit_roundoff);
        const double hi = q_hi < 1 ? above(-1.5 * (1 - q_hi) / q_hi) : 0;
        return {below(-1.5 * (1 - q_lo) / q_lo), std::min(hi, 0.0)};
    }

    // Where it jumps (s = 1/9, s = 1) both one-sided values are in the range.
    static Interval<double> curvature_over(const Interval<double>&, double s_lo, double s_hi) {
        using kernel_detail::above;
        using kernel_detail::below;
        if (9 * s_hi < 1 - kernel_detail::slack) return {0.0, 0.0};
        const double q_lo = std::max(std::sqrt(s_lo), 1.0 / 3);
        const double q_hi = std::sqrt(s_hi);
        const bool one_piece = 9 * s_lo > 1 + kernel_detail::slack && s_hi < 1;
        return {one_piece ? below(0.75 / (q_hi * q_hi * q_hi)) : 0.0,
                above(0.75 / (q_lo * q_lo * q_lo))};
    }

    static double plain(double s) {
        if (s >= 1) return 0;
        if (9 * s <= 1) return 1 - 3 * s;
        const double rest = 1 - std::sqrt(s);
        return 1.5 * rest * rest;
    }
    static double touching_point(double slope) {
        const double q = 1.5 / (1.5 - slope);  // -3/2 (1 - q) / q
        return q * q;
    }
    // 6 q, then 3 (1 - q): from q = 1/3 on it falls, 2 there.
    static double steepest_beyond(double q) {
        if (!(q > 1.0 / 3)) return 2;
        return q < 1 ? 3 * (1 - q) * (1 + 8 * unit_roundoff) : 0;
    }
};

}  // namespace ivory
#endif

#ifdef IVORY_LANES  // once for each instruction set: core/kernel/kernel_lanes.inl
HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

template <>
struct KernelLanes<Nishimura> : EndingKernelLanes<Nishimura> {
    template <class Tag>
    static HWY_INLINE KernelValue<Tag> at(Tag d, V<Tag> s) {
        const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
        const V<Tag> q = hn::Sqrt(s);
        const V<Tag> in = hn::Max(hn::Sub(c(1), q), c(0));
        const V<Tag> half = hn::Mul(c(1.5), in);
        const M<Tag> core = hn::Le(s, c(1.0 / 9));
        return {hn::IfThenElse(core, hn::NegMulAdd(c(3), s, c(1)), hn::Mul(half, in)),
                hn::IfThenElse(core, c(-3), hn::Div(hn::Neg(half), hn::Max(q, c(1.0 / 4))))};
    }

    // An upper bound of 4 s k'' from s = least on: 4 s 3/4 / q^3.
    template <class Tag>
    static HWY_INLINE V<Tag> greatest_rise(Tag d, V<Tag> least) {
        return hn::Div(constant(d, 3), hn::Sqrt(hn::Max(least, constant(d, 1.0 / 9))));
    }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
