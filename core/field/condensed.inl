// What a condensed polynomial is at some lanes' places, and its slope.
#if defined(IVORY_CORE_FIELD_CONDENSED_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_FIELD_CONDENSED_INL
#undef IVORY_CORE_FIELD_CONDENSED_INL
#else
#define IVORY_CORE_FIELD_CONDENSED_INL
#endif

#include "core/field/condensed.h"
#include "core/kernel/kernel_lanes.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

// P and P' of a ray's polynomial, at t - (the window's middle).
HWY_INLINE void add_condensed(D d, const CondensedRay& condensed, V<D> tau, V<D>& f, V<D>& slope) {
    V<D> all = hn::Zero(d), of_all = all;
    for (std::size_t k = condensed.degree + 1; k-- > 0;) {
        of_all = hn::MulAdd(of_all, tau, all);
        all = hn::MulAdd(all, tau, hn::Set(d, condensed.coefficient[k]));
    }
    f = hn::Add(f, all);
    slope = hn::Add(slope, of_all);
}

using Floats = hn::ScalableTag<float>;

// Adds P(p) to `f` and its derivative along the direction to `slope`; p relative to the window's middle, in units.
// Horner's scheme in w within v within u, and what follows from it for the derivatives.
HWY_INLINE void add_condensed(Floats d, const Condensed& condensed, const Vec3v<Floats>& p,
                              const Vec3v<Floats>& direction, V<Floats>& f, V<Floats>& slope) {
    const auto along = [&](const Vec3v<Floats>& a, const Vec3<float>& axis) HWY_ATTR {
        return hn::MulAdd(a.x, hn::Set(d, axis.x),
                          hn::MulAdd(a.y, hn::Set(d, axis.y), hn::Mul(a.z, hn::Set(d, axis.z))));
    };
    const auto& frame = condensed.frame;
    const V<Floats> u = along(p, frame[0]), v = along(p, frame[1]), w = along(p, frame[2]),
                    du = along(direction, frame[0]), dv = along(direction, frame[1]),
                    dw = along(direction, frame[2]);
    const std::size_t n = condensed.degree;
    const float* c = condensed.coefficient.data() + (n + 1) * (n + 2) * (n + 3) / 6;
    const V<Floats> zero = hn::Zero(d);
    V<Floats> all = zero, of_all = zero;
    for (std::size_t i = 0; i <= n; ++i) {  // n - i is the power of u
        V<Floats> plane = zero, of_plane = zero;
        for (std::size_t j = 0; j <= i; ++j) {  // i - j that of v
            V<Floats> line = hn::Set(d, *--c), of_line = zero;
            for (std::size_t k = 0; k < j; ++k) {
                of_line = hn::MulAdd(of_line, w, line);
                line = hn::MulAdd(line, w, hn::Set(d, *--c));
            }
            of_plane = hn::MulAdd(of_plane, v, hn::MulAdd(plane, dv, hn::Mul(of_line, dw)));
            plane = hn::MulAdd(plane, v, line);
        }
        of_all = hn::MulAdd(of_all, u, hn::MulAdd(all, du, of_plane));
        all = hn::MulAdd(all, u, plane);
    }
    f = hn::Add(f, all);
    slope = hn::Add(slope, of_all);
}

// The gradient of P.
HWY_INLINE Vec3v<Floats> gradient_of(Floats d, const Condensed& condensed, const Vec3v<Floats>& p) {
    const auto along = [&](const Vec3<float>& axis) HWY_ATTR {
        V<Floats> f = hn::Zero(d), slope = hn::Zero(d);
        const Vec3v<Floats> direction{hn::Set(d, axis.x), hn::Set(d, axis.y), hn::Set(d, axis.z)};
        add_condensed(d, condensed, p, direction, f, slope);
        return slope;
    };
    return {along({1, 0, 0}), along({0, 1, 0}), along({0, 0, 1})};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
