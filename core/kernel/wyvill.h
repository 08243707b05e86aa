// Wyvill's soft object (Wyvill, McPheeters, Wyvill 1986, "Data structure for soft objects"), for
// s = q^2 <= 1:
//     k(s) = 1 - 4/9 s^3 + 17/9 s^2 - 22/9 s = (1 - s)^2 (9 - 4 s) / 9,
//     k'(s) = -2/9 (1 - s)(11 - 6 s),  k''(s) = (34 - 24 s) / 9,
// and 0 beyond. The factored form keeps its relative accuracy near s = 1, where the expanded one
// cancels.
#ifndef IVORY_CORE_KERNEL_WYVILL_H
#define IVORY_CORE_KERNEL_WYVILL_H

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/kernel/kernel_values.h"

namespace ivory {

struct Wyvill : PolynomialKernel<Wyvill> {
    static constexpr std::string_view word = "wyvill";
    static constexpr std::string_view label = "Wyvill";
    static constexpr std::string_view formula = "1 - 4/9 q⁶ + 17/9 q⁴ - 22/9 q²";
    static constexpr std::string_view source = "Wyvill, McPheeters, Wyvill 1986 (soft objects)";

    static constexpr double greatest_slope = 22.0 / 9, greatest_curvature = 34.0 / 9,
                            greatest_root_slope = 0.8;

    // It falls up to s = 1, where it jumps.
    static Interval<double> curvature_over(const Interval<double>&, double s_lo, double s_hi) {
        return {s_hi >= 1 ? 0.0 : kernel_detail::below((34 - 24 * s_hi) / 9),
                kernel_detail::above((34 - 24 * s_lo) / 9)};
    }

    static double plain(double s) { return s >= 1 ? 0 : (1 - s) * (1 - s) * (9 - 4 * s) / 9; }
    static double plain_slope(double s) { return -2 * (1 - s) * (11 - 6 * s) / 9; }
    static double touching_point(double slope) {  // -2/9 (1 - s)(11 - 6 s)
        return (17 - std::sqrt(std::max(289 - 24 * (11 + 4.5 * slope), 0.0))) / 12;
    }
    // 4/9 q (1 - s)(11 - 6 s) falls from s = (51 - sqrt 1281) / 60 on.
    static double steepest_beyond(double q) {
        const double s = q * q;
        if (!(s > 0.254)) return 1.5834298;
        return q < 1 ? 4.0 / 9 * q * (1 - s * (1 - 2 * unit_roundoff)) * (11 - 6 * s) *
                           (1 + 32 * unit_roundoff)
                     : 0;
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
struct KernelLanes<Wyvill> : EndingKernelLanes<Wyvill> {
    template <class Tag>
    static HWY_INLINE KernelValue<Tag> at(Tag d, V<Tag> s) {
        const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
        const V<Tag> in = hn::Max(hn::Sub(c(1), s), c(0));
        const V<Tag> k =
            hn::Mul(hn::Mul(in, in), hn::Mul(hn::NegMulAdd(c(4), s, c(9)), c(1.0 / 9)));
        const V<Tag> dk = hn::Mul(hn::Mul(in, c(-2.0 / 9)), hn::NegMulAdd(c(6), s, c(11)));
        return {k, dk};
    }

    // 4 s (34 - 24 s) / 9 falls from 17 / 24 on.
    template <class Tag>
    static HWY_INLINE V<Tag> greatest_rise(Tag d, V<Tag> least) {
        const V<Tag> s_worst = hn::Max(least, constant(d, 17.0 / 24));
        return hn::Mul(hn::Mul(constant(d, 4.0 / 9), s_worst),
                       hn::NegMulAdd(constant(d, 24), s_worst, constant(d, 34)));
    }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
