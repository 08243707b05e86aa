// Murakami's kernel (Murakami and Ichihara 1987, "On a 3D display method by metaball technique";
// POV-Ray's blob), for s = q^2 <= 1:
//     k(s) = (1 - s)^2,  k'(s) = -2 (1 - s),  k''(s) = 2,
// and 0 beyond.
#ifndef IVORY_CORE_KERNEL_MURAKAMI_H
#define IVORY_CORE_KERNEL_MURAKAMI_H

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/kernel/kernel_values.h"

namespace ivory {

struct Murakami : PolynomialKernel<Murakami> {
    static constexpr std::string_view word = "murakami";
    static constexpr std::string_view label = "Murakami";
    static constexpr std::string_view formula = "(1 - q²)²";
    static constexpr std::string_view source = "Murakami, Ichihara 1987 (POV-Ray's blob)";

    // 2 sqrt(s) (1 - s) is greatest at s = 1/3: 4 / 3^(3/2) = 0.7698.
    static constexpr double greatest_slope = 2, greatest_curvature = 2, greatest_root_slope = 0.77;

    // It jumps at s = 1.
    static Interval<double> curvature_over(const Interval<double>&, double, double s_hi) {
        return {s_hi >= 1 ? 0.0 : 2.0, 2.0};
    }

    static double plain(double s) { return s >= 1 ? 0 : (1 - s) * (1 - s); }
    static double plain_slope(double s) { return -2 * (1 - s); }
    static double touching_point(double slope) { return 1 + 0.5 * slope; }  // -2 (1 - s)
    // 4 q (1 - s) falls from s = 1/3 on, 8 / 3^(3/2) there.
    static double steepest_beyond(double q) {
        const double s = q * q;
        if (!(s > 0.334)) return 1.5396008;
        return q < 1 ? 4 * q * (1 - s * (1 - 2 * unit_roundoff)) * (1 + 32 * unit_roundoff) : 0;
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
struct KernelLanes<Murakami> : EndingKernelLanes<Murakami> {
    template <class Tag>
    static HWY_INLINE KernelValue<Tag> at(Tag d, V<Tag> s) {
        const V<Tag> in = at_least_0(hn::Sub(constant(d, 1), s));
        return {hn::Mul(in, in), hn::Mul(in, constant(d, -2))};
    }

    // 4 s k'' = 8 s up to s = 1.
    template <class Tag>
    static HWY_INLINE V<Tag> greatest_rise(Tag d, V<Tag>) {
        return constant(d, 8);
    }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
