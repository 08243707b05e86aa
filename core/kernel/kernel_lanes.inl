// The kernels, roots and vectors of three components in SIMD, for files that are compiled once for
// each instruction set (after Highway's convention for such files: no usual guard).
#if defined(IVORY_CORE_KERNEL_KERNEL_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_KERNEL_KERNEL_LANES_INL
#undef IVORY_CORE_KERNEL_KERNEL_LANES_INL
#else
#define IVORY_CORE_KERNEL_KERNEL_LANES_INL
#endif

#include <hwy/highway.h>

#include <iterator>

#include "core/interval/exp.h"
#include "core/kernel/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
template <class Tag>
using V = hn::Vec<Tag>;
template <class Tag>
using M = hn::Mask<Tag>;

#if HWY_TARGET == HWY_AVX3
HWY_INLINE V<hn::ScalableTag<float>> less_nearest_integer(V<hn::ScalableTag<float>> x) {
    return decltype(x){_mm512_reduce_ps(x.raw, _MM_FROUND_TO_NEAREST_INT)};
}
HWY_INLINE V<D> less_nearest_integer(V<D> x) {
    return V<D>{_mm512_reduce_pd(x.raw, _MM_FROUND_TO_NEAREST_INT)};
}
HWY_INLINE V<hn::ScalableTag<float>> times_power_of_two(V<hn::ScalableTag<float>> x,
                                                        V<hn::ScalableTag<float>> power) {
    return decltype(x){_mm512_scalef_ps(x.raw, power.raw)};
}
HWY_INLINE V<D> times_power_of_two(V<D> x, V<D> power) {
    return V<D>{_mm512_scalef_pd(x.raw, power.raw)};
}
#endif

// 2^-x for x >= 0: exp2_minus of core/interval/exp.h, operation by operation; where the machine
// fuses products with sums it rounds less often, so that its bound holds all the more.
template <class Tag>
HWY_INLINE V<Tag> exp2_minus(Tag d, V<Tag> x) {
    using Real = hn::TFromD<Tag>;
    using C = Exp2Constants<Real>;
    const V<Tag> within = hn::Min(x, hn::Set(d, C::greatest));
#if HWY_TARGET == HWY_AVX3
    // The same numbers by instructions for just that: x - k without rounding, and a scaling by
    // 2^-k.
    const V<Tag> r = less_nearest_integer(within);
#else
    const hn::RebindToUnsigned<Tag> bits;
    const V<Tag> rounder = hn::Set(d, ExpConstants<Real>::rounder);
    const V<Tag> shifted = hn::Sub(rounder, within);
    const V<Tag> r = hn::Add(within, hn::Sub(shifted, rounder));
#endif
    V<Tag> q = hn::Set(d, C::series[std::size(C::series) - 1]);
    for (std::size_t i = std::size(C::series) - 1; i > 0; --i) {
        q = hn::MulAdd(q, r, hn::Set(d, C::series[i - 1]));
    }
    const V<Tag> series = hn::MulAdd(q, r, hn::Set(d, Real(1)));
#if HWY_TARGET == HWY_AVX3
    return times_power_of_two(series, hn::Sub(r, within));
#else
    const auto exponent = hn::ShiftLeft<(sizeof(Real) == 8 ? 52 : 23)>(hn::BitCast(bits, shifted));
    return hn::BitCast(d, hn::Add(hn::BitCast(bits, series), exponent));
#endif
}

// What makes up for rounding, relative to the magnitudes that went in: 2^7 units of it.
template <class Real>
struct Margins;

template <>
struct Margins<double> {
    static constexpr double margin = 0x1p-46, more = 1 + 0x1p-46, less = 1 - 0x1p-46;
    static constexpr double least_peak = 1e-300;  // what underflows
    static constexpr double near_end = 0x1p-49;   // of a kernel that ends at 1
};

template <>
struct Margins<float> {
    static constexpr float margin = 0x1p-17f, more = 1 + 0x1p-17f, less = 1 - 0x1p-17f;
    static constexpr float least_peak = 1e-36f;
    static constexpr float near_end = 0x1p-20f;
};

template <class Tag>
HWY_INLINE V<Tag> constant(Tag d, double value) {
    return hn::Set(d, static_cast<hn::TFromD<Tag>>(value));
}
template <class Vector>
HWY_INLINE Vector at_least_0(Vector x) {
    return hn::Max(x, hn::Zero(hn::DFromV<Vector>()));
}

template <class Tag>
struct KernelValue {
    V<Tag> k, dk;  // k(s), slope_sign k'(s)
};

// A lower bound of s on a stretch, and where y = x^2 = (away . d / w)^2 lies there; `is_exact` where
// s = y + h_square, as it is for a point.
template <class Tag>
struct CurvatureRange {
    V<Tag> least;
    V<Tag> y0, y1, h_square;
    bool is_exact;
};

// rise: an upper bound of w^2 (k'' s'^2 + k' s'') for all rays on the stretch; fall: of its
// negative.
template <class Tag>
struct Bend {
    V<Tag> rise, fall;
};

// Rounding errors of one entry: what they do to F / |b| and to F' w / (2 |b|). With u the unit
// roundoff of its stage, eta < 5e-4 the error of `away` and eta_slope that of its direction, both in
// widths.
template <class Tag>
struct EntryErrors {
    V<Tag> value, slope;
};

// The quick forms of a kernel, next to the exact ones in its file: values to nearest and bounds
// that are widened by far more than their roundings. Both are there because the inner loops can
// afford neither directed steps nor cases.
//     argument_scale, slope_sign
//     at(d, s)                    of s times argument_scale
//     peak(d, s)                  an upper bound of k from a lower bound of s
//     steepest(d, s)              of |k'| from a lower bound of s
//     slope(d, least, peak)       of w / (2 |b|) |F'| = x |k'| <= sqrt(s) |k'| where s >= least
//     bound_curvature(d, range, peak, outward)
//     errors(d, u, eta, least, greatest_root, peak)
template <class K>
struct KernelLanes;

// Of a kernel that ends at s = 1 all but `at` and `greatest_rise` follow from its greatest slopes.
template <class K>
struct EndingKernelLanes {
    static constexpr double argument_scale = 1;
    static constexpr double slope_sign = 1;

    // The factored forms lose relative accuracy only in 1 - q of Nishimura's kernel, for which the
    // absolute terms are.
    template <class Tag>
    static HWY_INLINE V<Tag> peak(Tag d, V<Tag> s) {
        using Margin = Margins<hn::TFromD<Tag>>;
        const V<Tag> k = KernelLanes<K>::at(d, s).k;
        return hn::IfThenElseZero(
            hn::Lt(s, constant(d, 1)),
            hn::MulAdd(k, hn::Set(d, Margin::more), hn::Set(d, Margin::near_end)));
    }

    template <class Tag>
    static HWY_INLINE V<Tag> steepest(Tag d, V<Tag> s) {
        using Margin = Margins<hn::TFromD<Tag>>;
        const V<Tag> dk = hn::Neg(KernelLanes<K>::at(d, s).dk);
        return hn::IfThenElseZero(
            hn::Lt(s, constant(d, 1)),
            hn::MulAdd(dk, hn::Set(d, Margin::more), hn::Set(d, Margin::margin)));
    }

    template <class Tag>
    static HWY_INLINE V<Tag> slope(Tag d, V<Tag> least, V<Tag>) {
        static_assert(K::greatest_root_slope <= 1);
        return hn::IfThenElseZero(hn::Lt(least, constant(d, 1)), constant(d, 1));
    }

    // 4 x^2 k'' - 2 (1 - outward) |k'| with x^2 <= s.
    template <class Tag>
    static HWY_INLINE Bend<Tag> bound_curvature(Tag d, const CurvatureRange<Tag>& range, V<Tag>,
                                                V<Tag> outward) {
        const V<Tag> one = constant(d, 1), two = constant(d, 2);
        const V<Tag> widened = hn::Set(d, Margins<hn::TFromD<Tag>>::more);
        const V<Tag> least = range.least;
        const V<Tag> slope = steepest(d, least);
        const V<Tag> greatest = KernelLanes<K>::greatest_rise(d, least);
        const V<Tag> inward = hn::Mul(hn::Mul(two, at_least_0(hn::Sub(outward, one))), slope);
        const M<Tag> reaches = hn::Lt(least, one);
        return {hn::IfThenElseZero(reaches, hn::Mul(hn::Add(greatest, inward), widened)),
                hn::IfThenElseZero(reaches, hn::Mul(hn::Mul(two, slope), widened))};
    }

    // s <= 1 where k is not 0, so that it is off by 2 eta + eta^2 + 10 u at most; with |k'| <= 3 and
    // |k''| <= 20.25 and ten roundings each, |dF| <= |b| (3 (2.001 eta + 10 u) + 30 u) and
    // |dF'| <= 2 |b| / w ((3 + 20.25 * 2.001) eta_slope + 20.25 * 10 u + 90 u).
    template <class Tag>
    static HWY_INLINE EntryErrors<Tag> errors(Tag d, double u, const EntryErrors<Tag>& eta, V<Tag>,
                                              V<Tag>, V<Tag>) {
        static_assert(K::greatest_slope <= 3 && K::greatest_curvature <= 20.25);
        const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
        return {hn::MulAdd(c(8), eta.value, c(60 * u)), hn::MulAdd(c(60), eta.slope, c(300 * u))};
    }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#define IVORY_LANES
#include "core/kernel/kernels.h"
#undef IVORY_LANES

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

template <KernelKind kind>
using LanesOf = KernelLanes<KernelOf<kind>>;

template <class Tag>
struct Vec3v {
    V<Tag> x, y, z;
};

// 1 / x and sqrt(x) for x > 0. In float, off by a relative 2^-11.4 at most for 1e-36 < x < 1e36:
// x86 promises 1.5 2^-12 for both instructions, which take a fraction of the time of a division;
// without vectors Highway's stand-in for the second is off by 2^-9.
template <class Tag>
inline constexpr bool has_rough = HWY_ARCH_X86&& HWY_TARGET != HWY_SCALAR&& HWY_TARGET !=
                                      HWY_EMU128 &&
                                  sizeof(hn::TFromD<Tag>) == sizeof(float);

template <class Tag>
HWY_INLINE V<Tag> rough_inverse(Tag d, V<Tag> x) {
    if constexpr (has_rough<Tag>) return hn::ApproximateReciprocal(x);
    return hn::Div(hn::Set(d, hn::TFromD<Tag>{1}), x);
}

template <class Tag>
HWY_INLINE V<Tag> rough_sqrt(Tag, V<Tag> x) {
    if constexpr (has_rough<Tag>) return hn::Mul(x, hn::ApproximateReciprocalSqrt(x));
    return hn::Sqrt(x);
}

template <class Tag>
HWY_INLINE V<Tag> dot(const Vec3v<Tag>& a, const Vec3v<Tag>& b) {
    return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}

// What is not below this has a `root`.
template <class Real>
inline constexpr Real least_square = static_cast<Real>(sizeof(Real) == 4 ? 1e-30 : 1e-200);

// sqrt(x) and 1 / sqrt(x) for 1e-36 < x < 1e36, off by a relative 6 u (u = 2^-24 or 2^-53) at most:
// in float one step of Newton from the instruction's 1.5 2^-12, which becomes 3.4 u, and roundings
// of 2 u and, for the root, 1/2 u.
template <class Tag>
struct Root {
    V<Tag> root, inverse;
};

template <class Tag>
HWY_INLINE Root<Tag> root(Tag d, V<Tag> x) {
    const auto c = [&](double value)
                       HWY_ATTR { return hn::Set(d, static_cast<hn::TFromD<Tag>>(value)); };
    if constexpr (has_rough<Tag>) {
        const V<Tag> y = hn::ApproximateReciprocalSqrt(x);
        const V<Tag> xy = hn::Mul(x, y);
        const V<Tag> error = hn::NegMulAdd(hn::Mul(xy, c(0.5)), y, c(0.5));  // (1 - x y^2) / 2
        return {hn::MulAdd(xy, error, xy), hn::MulAdd(y, error, y)};
    }
    const V<Tag> exact = hn::Sqrt(x);
    return {exact, hn::Div(c(1), exact)};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
