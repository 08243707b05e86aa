// Safe steps: from t0 with f(t0) < 0, and m an upper bound of f'' on the whole window, f lies below
// a + b x + m x^2 / 2, where a >= f(t0) and b >= f'(t0). Up to the first zero of that parabola there
// is no root; near a simple root the steps converge to it quadratically, from the left. With lower
// bounds instead, f lies above a parabola, whose zero no first root comes after.
//
// Two forms of each: one ray's, rounded down, whatever the numbers; and, at the end of this file,
// those of the packets' walk, to nearest and then shortened, which give up where numbers are not
// ordinary.
#ifndef IVORY_CORE_TRACE_SAFE_STEP_H
#define IVORY_CORE_TRACE_SAFE_STEP_H

#include <algorithm>
#include <cmath>

#include "core/interval/interval.h"

namespace ivory {

// The first zero of a + b x + m x^2 / 2 in [0, width], for a < 0, rounded down; `width` where there
// is none, 0 where the numbers are too large or too small to tell. With x in units of the width, a
// term whose square underflows beside |a| >= 1e-100 moves no zero into [0, 1].
inline double parabola_step(double a, double b, double m, double width) {
    constexpr double u = unit_roundoff;
    b *= width;
    m = std::max(m * width * width, -1e300);
    if (!(-a > 1e-100 && -a < 1e150 && std::abs(b) < 1e150 && m < 1e150)) return 0;
    const double square = b * b - 2 * a * m;
    double x = 2;  // none in [0, 1]
    if (b > 0) {
        // -2 a / (b + root): a larger root only shortens the step. The roundings of b^2 - 2 a m are
        // of its terms' size.
        const double enlarged = square + 16 * u * (b * b + std::abs(a * m));
        if (enlarged >= 0) x = -2 * a / (b + std::sqrt(enlarged));
    } else if (m > 0) {
        // (root - b) / m: both terms of the square are positive, so that its relative error stays
        // below 8 u.
        x = (std::sqrt(square) - b) / m;
    }
    return x >= 1 + 32 * u ? width : x * (1 - 32 * u) * width;
}

// The first zero of a + b x in [0, width], for a < 0, rounded down.
inline double line_step(double a, double b, double width) {
    if (b <= 0) return width;
    if (!(b < infinity<double> && a > -infinity<double>)) return 0;
    return std::min(-a / b * (1 - 8 * unit_roundoff), width);
}

}  // namespace ivory
#endif

#ifdef IVORY_LANES  // once for each instruction set: core/trace/walk.inl
HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

// What the zeros of parabolas may be off by. The formulas are monotonic in what they are given, and
// their own few roundings (below 2^-20 in all, or 2^-48) are less than what `tight` takes away or
// adds; those with a rough square root and a rough inverse (2^-10.4 together) are less than what
// `rough` does.
template <class Real>
struct StepMargins;

template <>
struct StepMargins<float> {
    static constexpr float tight = 0x1p-18f, rough = 0x1p-10f;
};

template <>
struct StepMargins<double> {
    static constexpr double tight = 0x1p-44, rough = tight;
};

// The first zero of a + b x + m x^2 / 2 for a < 0, m > 0, within a relative `rough`; of a parabola
// that is larger by `tight`.
template <class Tag>
HWY_INLINE V<Tag> parabola_zero(Tag d, V<Tag> a, V<Tag> b, V<Tag> m) {
    using Real = hn::TFromD<Tag>;
    constexpr Real tight = StepMargins<Real>::tight;
    const V<Tag> minus_two = hn::Set(d, Real{-2});
    a = hn::Mul(a, hn::Set(d, 1 - tight));
    b = hn::MulAdd(hn::Abs(b), hn::Set(d, tight), b);
    const V<Tag> root = rough_sqrt(d, hn::MulAdd(b, b, hn::Mul(hn::Mul(minus_two, a), m)));
    const M<Tag> upward = hn::Gt(b, hn::Zero(d));
    const V<Tag> numerator = hn::IfThenElse(upward, hn::Mul(minus_two, a), hn::Sub(root, b));
    const V<Tag> denominator = hn::IfThenElse(upward, hn::Add(root, b), m);
    return hn::Mul(numerator, rough_inverse(d, denominator));
}

// Of a + b x - fall x^2 / 2 with a < 0, made smaller by `tight`: where it has a zero, f rises up to
// there, and on up to the parabola's vertex, which lies beyond what the rough numbers add to `x`.
template <class Tag>
struct LatestZero {
    V<Tag> x;        // no earlier than the parabola's
    M<Tag> is_firm;  // there is one
};

template <class Tag>
HWY_INLINE LatestZero<Tag> latest_zero(Tag d, V<Tag> a, V<Tag> b, V<Tag> fall) {
    using Real = hn::TFromD<Tag>;
    using Margin = StepMargins<Real>;
    const V<Tag> firm = hn::Mul(b, hn::Set(d, 1 - Margin::tight));
    const V<Tag> square = hn::MulAdd(firm, firm, hn::Mul(hn::Add(fall, fall), a));
    const V<Tag> turning =
        hn::MulAdd(hn::Mul(firm, hn::Set(d, Real{16} * Margin::rough * Margin::rough)), firm,
                   hn::Set(d, least_square<Real>));
    const V<Tag> steepness = hn::Add(firm, rough_sqrt(d, square));
    const V<Tag> x = hn::Mul(hn::Mul(hn::Set(d, Real{-2} * (1 + Margin::rough)), a),
                             rough_inverse(d, steepness));
    return {x, hn::And(hn::Gt(firm, hn::Zero(d)), hn::Gt(square, turning))};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
