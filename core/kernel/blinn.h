// Blinn's kernel k(s) = exp(-s), s = q^2 (Blinn 1982, "A generalization of algebraic surface
// drawing"): it never reaches 0. k' = -k, k'' = k.
#ifndef IVORY_CORE_KERNEL_BLINN_H
#define IVORY_CORE_KERNEL_BLINN_H

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/interval/moving_square.h"
#include "core/kernel/kernel_values.h"

namespace ivory {

struct Blinn {
    static constexpr std::string_view word = "blinn";
    static constexpr std::string_view label = "Blinn";
    static constexpr std::string_view formula = "exp(-q²)";
    static constexpr std::string_view source = "Blinn 1982";

    // Whether k = 0 from s = 1 on; otherwise `level` and `vanishes` are needed.
    static constexpr bool ends = false;
    // The s at which k = exp(-x), to nearest, and one from which on all that k adds is below the
    // least double.
    static double level(double x) { return x; }
    static constexpr double vanishes = 800;

    // k(s), k'(s) for a double s >= 0, enclosed; 0 <= k <= 1, k' <= 0.
    static Interval<double> at(double s) { return exp_minus(s, 0); }
    static Interval<double> slope_at(double s) { return -exp_minus(s, 0); }
    // Within `radius` of s, by one exponential; and over a thin range.
    static Interval<double> around(double s, double radius) { return exp_minus(s, radius); }
    static Interval<double> thin(const Interval<double>& s) {
        const double middle = midpoint(s);
        return around(middle, std::max(s.hi - middle, middle - s.lo) * (1 + 4 * unit_roundoff));
    }
    // k' and k'' over s_lo <= s <= s_hi, 0 <= s_lo, where k lies in `k`.
    static Interval<double> slope_over(const Interval<double>& k, double, double) { return -k; }
    static Interval<double> curvature_over(const Interval<double>& k, double, double) { return k; }

    // To nearest; claims nothing.
    static double plain(double s) { return exp_nearest(-s); }
    // About where k'(s) is that slope.
    static double touching_point(double slope) { return -std::log(-slope); }
    // max |dk/dq| over [q, inf), rounded up: 2 q exp(-q^2) falls from q^2 = 1/2 on, sqrt(2/e) there.
    static double steepest_beyond(double q) {
        const double s = q * q;
        if (!(s > 0.5)) return 0.8577638849607070;
        return 2 * q * exp_minus(s * (1 - 2 * unit_roundoff), 0).hi * (1 + 8 * unit_roundoff) +
               1e-300;
    }

    static KernelAlong along_parabola(const MovingSquare& square, double peak, double t0,
                                      double t1);
};

namespace blinn_detail {

// [lo, hi] [k] for k >= 0, with room for four roundings of the ends.
inline Interval<double> times_positive(double lo, double hi, const Interval<double>& k) {
    const double x = lo * (lo >= 0 ? k.lo : k.hi), y = hi * (hi >= 0 ? k.hi : k.lo);
    return {x - std::abs(x) * (4 * unit_roundoff), y + std::abs(y) * (4 * unit_roundoff)};
}

// s' k.
inline Interval<double> slope_times(const SquareAt& at, const Interval<double>& k) {
    return times_positive(at.ds - at.ds_radius, at.ds + at.ds_radius, k);
}

// (s'^2 - s'') k; the difference cancels, so its rounding is counted by its terms.
inline Interval<double> bend_times(const SquareAt& at, const Interval<double>& c2,
                                   const Interval<double>& k) {
    const double steepest = std::abs(at.ds) + at.ds_radius;
    const double flattest = std::max(std::abs(at.ds) - at.ds_radius, 0.0);
    const double most = steepest * steepest, fewest = flattest * flattest;
    const double rounding = 8 * unit_roundoff * (most + c2.hi);
    return times_positive(fewest - c2.hi - rounding, most - c2.lo + rounding, k);
}

}  // namespace blinn_detail

// Along a parabola s = least + c (t - t_0)^2 k is a one-dimensional Gaussian: with x = s',
// c2 = s'' = 2 c,
//   k   = exp(-s)              extremum at x = 0: exp(-least)
//   k'  = -x exp(-s)           extrema at x^2 = c2: -+ sqrt(c2) exp(-1/2 - least)
//   k'' = (x^2 - c2) exp(-s)   extrema at x = 0: -c2 exp(-least),
//                              at x^2 = 3 c2: 2 c2 exp(-3/2 - least)
// (x rises with t, so each range is that of its ends and of the extrema between them).
inline KernelAlong Blinn::along_parabola(const MovingSquare& square, double peak, double t0,
                                         double t1) {
    using blinn_detail::bend_times;
    using blinn_detail::slope_times;
    constexpr double u = unit_roundoff;
    const SquareAt a = square.at(t0), b = square.at(t1);
    const Interval<double> c2 = square.curvature();
    KernelAlong k;
    k.left = exp_minus(a.s, a.s_radius);
    k.right = exp_minus(b.s, b.s_radius);
    const double x0 = a.ds - a.ds_radius, x1 = b.ds + b.ds_radius;
    const bool dips = x0 < 0 && x1 > 0;
    k.value = {std::min(k.left.lo, k.right.lo), dips ? peak : std::max(k.left.hi, k.right.hi)};

    const Interval<double> slope0 = slope_times(a, k.left);
    const Interval<double> slope1 = slope_times(b, k.right);
    Interval<double> slope = hull(slope0, slope1);
    const double steepest = std::sqrt(c2.hi) * (1 + 4 * u);  // >= sqrt(c2)
    const double flattest = std::sqrt(c2.lo) * (1 - 4 * u);  // <= sqrt(c2)
    // exp(-least) is the value at the foot on the whole line, even if that lies outside of the
    // window.
    const auto extreme = [&](double factor) {
        return std::min(factor * exp_minus(square.vertex, 0).hi, k.value.hi) * (1 + 8 * u);
    };
    if (x0 < steepest && x1 > flattest) {
        slope.hi = std::max(slope.hi, steepest * extreme(0.60653065971263345));
    }
    if (x0 < -flattest && x1 > -steepest) {
        slope.lo = std::min(slope.lo, -steepest * extreme(0.60653065971263345));
    }
    k.left_slope = -slope0;
    k.slope = -slope;

    const Interval<double> bend0 = bend_times(a, c2, k.left);
    const Interval<double> bend1 = bend_times(b, c2, k.right);
    k.curvature = hull(bend0, bend1);
    constexpr double root3 = 1.7320508075688774;
    const double outer = root3 * steepest * (1 + 4 * u), inner = root3 * flattest * (1 - 4 * u);
    if ((x0 < outer && x1 > inner) || (x0 < -inner && x1 > -outer)) {
        k.curvature.hi =
            std::max(k.curvature.hi, 2 * c2.hi * extreme(0.22313016014842985) * (1 + 8 * u));
    }
    if (dips) k.curvature.lo = std::min(k.curvature.lo, -c2.hi * peak * (1 + 4 * u));
    return k;
}

}  // namespace ivory
#endif

#ifdef IVORY_LANES  // once for each instruction set: core/kernel/kernel_lanes.inl
HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

template <>
struct KernelLanes<Blinn> {
    // Computed as 2^-(s / ln 2): what `at` is given is s times this.
    static constexpr double argument_scale = 0x1.71547652b82fep+0;
    // k' is -k: the sign is left to whoever has a factor to put it into.
    static constexpr double slope_sign = -1;

    template <class Tag>
    static HWY_INLINE KernelValue<Tag> at(Tag d, V<Tag> s) {
        const V<Tag> e = exp2_minus(d, s);
        return {e, e};
    }

    template <class Tag>
    static HWY_INLINE V<Tag> peak(Tag d, V<Tag> s) {
        using Real = hn::TFromD<Tag>;
        using Margin = Margins<Real>;
        // rounded down, the product with s as well
        constexpr double scale = argument_scale * (sizeof(Real) == 4 ? 1 - 0x1p-21 : 1 - 0x1p-50);
        const V<Tag> k = exp2_minus(d, hn::Mul(s, constant(d, scale)));
        return hn::MulAdd(k, hn::Set(d, Margin::more), hn::Set(d, Margin::least_peak));
    }

    template <class Tag>
    static HWY_INLINE V<Tag> steepest(Tag d, V<Tag> s) {
        return peak(d, s);
    }

    // With s = least + y, e^-s sqrt(s) <= e^-least (sqrt(least) + sup sqrt(y) e^-y); sup of x e^-x^2
    // for x >= 0 is 0.4289.
    template <class Tag>
    static HWY_INLINE V<Tag> slope(Tag d, V<Tag> least, V<Tag> peak) {
        constexpr double unit_slope = 0.43;
        const V<Tag> falling = hn::Mul(peak, hn::Add(hn::Sqrt(least), constant(d, unit_slope)));
        return hn::Mul(hn::Min(constant(d, unit_slope), falling),
                       hn::Set(d, Margins<hn::TFromD<Tag>>::more));
    }

    // 2 e^-s (2 x^2 - 1 + outward), with y = x^2 at most s.
    template <class Tag>
    static HWY_INLINE Bend<Tag> bound_curvature(Tag d, const CurvatureRange<Tag>& range,
                                                V<Tag> peak, V<Tag> outward) {
        using Margin = Margins<hn::TFromD<Tag>>;
        const V<Tag> one = constant(d, 1), two = constant(d, 2);
        const V<Tag> widened = hn::Set(d, Margin::more);
        V<Tag> fall = hn::Mul(two, peak);
        if (range.is_exact) {
            fall = hn::Mul(hn::MulAdd(two, at_least_0(hn::NegMulAdd(two, range.y0, one)),
                                      hn::Set(d, Margin::margin)),
                           peak);
        }
        // (2 y - 1) e^-y rises up to 1.5
        const V<Tag> y = hn::Max(range.y0, hn::Min(range.y1, constant(d, 1.5)));
        const V<Tag> steep = hn::Mul(hn::Mul(two, hn::MulSub(two, y, one)),
                                     KernelLanes::peak(d, hn::Add(y, range.h_square)));
        V<Tag> rise = hn::IfThenElseZero(hn::Gt(y, constant(d, 0.5)), hn::Mul(steep, widened));
        // |d|^2 is 1 but for 2^-49
        rise = hn::MulAdd(hn::MulAdd(two, outward, hn::Set(d, Margin::margin)), peak, rise);
        return {rise, fall};
    }

    // The computed s is off by
    //     ds <= 2 sqrt(s) eta + eta^2 + 9 u s,
    // five roundings of the square, one of 1 / w^2 and two of 1 / ln 2; 2^-x adds 2 u, so that with
    // e^ds <= 1.02 |dk| <= 1.02 e^-s (ds + 2 u). (For s in the hundreds e^ds is larger, but then
    // e^-(s - least) or e^-s itself leaves nothing to bound.) Now e^-s s^(j/2) <= peak r^j for
    // j = 1, 2, 3, with r the lesser of
    //     the greatest sqrt(s) on the stretch,
    //     sqrt(least) + 1, since sqrt(s) <= sqrt(least) + sqrt(s - least) and the suprema of
    //         y^(j/2) e^-y are 0.43, 0.37, 0.41.
    // Hence
    //     |dF|  <= |b| peak (eta (2.1 r + 1e-3) + u (10 r^2 + 4)),
    //     |dF'| <= 2 |b| / w peak (eta_slope (2.1 r^2 + 1.1) + u r (10 r^2 + 16)),
    // with one more rounding, of b, in the first: 2.1 > 2 * 1.02 and 10 > 9 * 1.02 make room for it,
    // 1e-3 > 1.02 eta for eta^2; the second from |d(k x)| <= |dk| sqrt(s) + 1.02 k (eta_slope +
    // 5 u sqrt(s)), eta <= eta_slope, and up to six more roundings: 10 + 5 + 1 = 16.
    template <class Tag>
    static HWY_INLINE EntryErrors<Tag> errors(Tag d, double u, const EntryErrors<Tag>& eta,
                                              V<Tag> least, V<Tag> greatest_root, V<Tag> peak) {
        const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
        const V<Tag> r = hn::Min(hn::Add(hn::Sqrt(least), c(1)), greatest_root);
        const V<Tag> square = hn::Mul(r, r);
        const V<Tag> of_value = hn::Mul(c(u), hn::MulAdd(c(10), square, c(4)));
        const V<Tag> of_slope = hn::Mul(hn::Mul(c(u), r), hn::MulAdd(c(10), square, c(16)));
        return {hn::Mul(peak, hn::MulAdd(eta.value, hn::MulAdd(c(2.1), r, c(1e-3)), of_value)),
                hn::Mul(peak, hn::MulAdd(eta.slope, hn::MulAdd(c(2.1), square, c(1.1)), of_slope))};
    }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
