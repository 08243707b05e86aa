// The kernels and vectors of three components in SIMD, for files that are compiled once for each
// instruction set (after Highway's convention for such files: no usual guard).
#if defined(IVORY_FIELD_KERNEL_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_FIELD_KERNEL_LANES_INL
#undef IVORY_FIELD_KERNEL_LANES_INL
#else
#define IVORY_FIELD_KERNEL_LANES_INL
#endif

#include <hwy/highway.h>

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

// e^-s for s >= 0: exp_nearest of core/interval/exp.h, operation by operation; where the machine
// fuses products with sums it rounds less often, so that its bound holds all the more.
template <class Tag>
HWY_INLINE V<Tag> exp_minus(Tag d, V<Tag> s) {
    using Real = hn::TFromD<Tag>;
    using C = ExpConstants<Real>;
    const hn::RebindToUnsigned<Tag> bits;
    const auto c = [&](Real value) HWY_ATTR { return hn::Set(d, value); };
    const V<Tag> x = hn::Max(hn::Neg(s), c(C::least));
    const V<Tag> shifted = hn::MulAdd(x, c(C::inverse_of_ln2), c(C::rounder));
    const V<Tag> k = hn::Sub(shifted, c(C::rounder));
    const V<Tag> r = hn::NegMulAdd(k, c(C::ln2_low), hn::NegMulAdd(k, c(C::ln2_high), x));
    const V<Tag> r2 = hn::Mul(r, r);
    V<Tag> q;
    if constexpr (sizeof(Real) == 8) {
        const auto& t = C::tail;
        const V<Tag> r4 = hn::Mul(r2, r2);
        const V<Tag> q01 = hn::MulAdd(c(t[1]), r, c(t[0]));
        const V<Tag> q23 = hn::MulAdd(c(t[3]), r, c(t[2]));
        const V<Tag> q45 = hn::MulAdd(c(t[5]), r, c(t[4]));
        const V<Tag> q67 = hn::MulAdd(c(t[7]), r, c(t[6]));
        const V<Tag> q89 = hn::MulAdd(c(t[9]), r, c(t[8]));
        q = hn::MulAdd(r4, hn::MulAdd(r4, q89, hn::MulAdd(q67, r2, q45)), hn::MulAdd(q23, r2, q01));
    } else {
        const auto& t = C::tail;
        const V<Tag> q01 = hn::MulAdd(c(t[1]), r, c(t[0]));
        const V<Tag> q23 = hn::MulAdd(c(t[3]), r, c(t[2]));
        q = hn::MulAdd(r2, hn::MulAdd(r2, c(t[4]), q23), q01);
    }
    const V<Tag> tail = hn::Mul(hn::Mul(r, r2), q);
    const V<Tag> sum = hn::Add(c(1), hn::Add(r, hn::MulAdd(c(Real(0.5)), r2, tail)));
    const auto exponent =
        hn::ShiftLeft < sizeof(Real) == 8 ? 52 : 23 > (hn::BitCast(bits, shifted));
    const V<Tag> scaled = hn::BitCast(d, hn::Add(hn::BitCast(bits, sum), exponent));
    return hn::IfThenElseZero(hn::Le(s, c(-C::least)), scaled);
}

template <class Tag>
struct KernelValue {
    V<Tag> k, dk;  // k(s), k'(s)
};

template <KernelKind kind, class Tag>
HWY_INLINE KernelValue<Tag> kernel(Tag d, V<Tag> s) {
    using Real = hn::TFromD<Tag>;
    const auto c = [&](double value) HWY_ATTR { return hn::Set(d, static_cast<Real>(value)); };
    if constexpr (kind == KernelKind::blinn) {
        const V<Tag> e = exp_minus(d, s);
        return {e, hn::Neg(e)};
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

template <class Tag>
HWY_INLINE V<Tag> dot(const Vec3v<Tag>& a, const Vec3v<Tag>& b) {
    return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
