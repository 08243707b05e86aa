// The kernels, roots and vectors of three components in SIMD, for files that are compiled once for
// each instruction set (after Highway's convention for such files: no usual guard).
#if defined(IVORY_FIELD_KERNEL_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_FIELD_KERNEL_LANES_INL
#undef IVORY_FIELD_KERNEL_LANES_INL
#else
#define IVORY_FIELD_KERNEL_LANES_INL
#endif

#include <hwy/highway.h>

#include <iterator>

#include "core/field/kernel.h"
#include "core/interval/exp.h"

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
    const auto exponent =
        hn::ShiftLeft < sizeof(Real) == 8 ? 52 : 23 > (hn::BitCast(bits, shifted));
    return hn::BitCast(d, hn::Add(hn::BitCast(bits, series), exponent));
#endif
}

// Blinn's kernel is computed as 2^-(s / ln 2): what it is given is s times this.
template <KernelKind kind>
inline constexpr double argument_scale = kind == KernelKind::blinn ? 0x1.71547652b82fep+0 : 1;

// And its k' is -k: the sign is left to whoever has a factor to put it into.
template <KernelKind kind>
inline constexpr double slope_sign = kind == KernelKind::blinn ? -1 : 1;

template <class Tag>
struct KernelValue {
    V<Tag> k, dk;  // k(s), slope_sign k'(s)
};

// Of s times argument_scale.
template <KernelKind kind, class Tag>
HWY_INLINE KernelValue<Tag> kernel(Tag d, V<Tag> s) {
    using Real = hn::TFromD<Tag>;
    const auto c = [&](double value) HWY_ATTR { return hn::Set(d, static_cast<Real>(value)); };
    if constexpr (kind == KernelKind::blinn) {
        const V<Tag> e = exp2_minus(d, s);
        return {e, e};
    } else if constexpr (kind == KernelKind::wyvill) {
        // (1 - s)^2 (9 - 4 s) / 9 and -2/9 (1 - s) (11 - 6 s)
        const V<Tag> in = hn::Max(hn::Sub(c(1), s), c(0));
        const V<Tag> k =
            hn::Mul(hn::Mul(in, in), hn::Mul(hn::NegMulAdd(c(4), s, c(9)), c(1.0 / 9)));
        const V<Tag> dk = hn::Mul(hn::Mul(in, c(-2.0 / 9)), hn::NegMulAdd(c(6), s, c(11)));
        return {k, dk};
    } else {
        // 1 - 3 s and -3; beyond s = 1/9: 3/2 (1 - q)^2 and -3/2 (1 - q) / q
        const V<Tag> q = hn::Sqrt(s);
        const V<Tag> in = hn::Max(hn::Sub(c(1), q), c(0));
        const V<Tag> half = hn::Mul(c(1.5), in);
        const M<Tag> core = hn::Le(s, c(1.0 / 9));
        return {hn::IfThenElse(core, hn::NegMulAdd(c(3), s, c(1)), hn::Mul(half, in)),
                hn::IfThenElse(core, c(-3), hn::Div(hn::Neg(half), hn::Max(q, c(1.0 / 4))))};
    }
}

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
