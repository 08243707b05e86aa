// The BlobTree's kernel (Wyvill, Guy, Galin 1999, "Extending the CSG tree: warping, blending and
// Boolean operations in an implicit surface modeling system"; Blender's and RenderMan's metaballs), for
// s = q^2 <= 1:
//     k(s) = (1 - s)^3,  k'(s) = -3 (1 - s)^2,  k''(s) = 6 (1 - s),
// and 0 beyond; k'' does not jump.
#ifndef IVORY_CORE_KERNEL_BLOBTREE_H
#define IVORY_CORE_KERNEL_BLOBTREE_H

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/kernel/kernel_values.h"

namespace ivory {

struct BlobTree : PolynomialKernel<BlobTree> {
    static constexpr std::string_view word = "blobtree";
    static constexpr std::string_view label = "BlobTree";
    static constexpr std::string_view formula = "(1 - q²)³";
    static constexpr std::string_view source = "Wyvill, Guy, Galin 1999 (Blender's metaballs)";

    // 3 sqrt(s) (1 - s)^2 is greatest at s = 1/5: 48 / (25 sqrt 5) = 0.8587.
    static constexpr double greatest_slope = 3, greatest_curvature = 6, greatest_root_slope = 0.86;

    // It falls to 0 at s = 1.
    static Interval<double> curvature_over(const Interval<double>&, double s_lo, double s_hi) {
        return {s_hi >= 1 ? 0.0 : kernel_detail::below(6 * (1 - s_hi)),
                kernel_detail::above(6 * (1 - s_lo))};
    }

    static double plain(double s) { return s >= 1 ? 0 : (1 - s) * (1 - s) * (1 - s); }
    static double plain_slope(double s) { return -3 * (1 - s) * (1 - s); }
    static double touching_point(double slope) {  // -3 (1 - s)^2
        return 1 - std::sqrt(std::max(slope / -3, 0.0));
    }
    // 6 q (1 - s)^2 falls from s = 1/5 on, 96 / (25 sqrt 5) there.
    static double steepest_beyond(double q) {
        const double s = q * q;
        if (!(s > 0.201)) return 1.7173003;
        const double in = 1 - s * (1 - 2 * unit_roundoff);
        return q < 1 ? 6 * q * in * in * (1 + 32 * unit_roundoff) : 0;
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
struct KernelLanes<BlobTree> : EndingKernelLanes<BlobTree> {
    template <class Tag>
    static HWY_INLINE KernelValue<Tag> at(Tag d, V<Tag> s) {
        const V<Tag> in = at_least_0(hn::Sub(constant(d, 1), s));
        const V<Tag> square = hn::Mul(in, in);
        return {hn::Mul(square, in), hn::Mul(square, constant(d, -3))};
    }

    // 4 s k'' = 24 s (1 - s) falls from 1/2 on.
    template <class Tag>
    static HWY_INLINE V<Tag> greatest_rise(Tag d, V<Tag> least) {
        const V<Tag> s_worst = hn::Max(least, constant(d, 0.5));
        return hn::Mul(hn::Mul(constant(d, 24), s_worst), hn::Sub(constant(d, 1), s_worst));
    }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
