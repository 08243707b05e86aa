// The exponential function: enclosures of intervals, and a fast point value with a proved error.
//
// Reduction (Cody and Waite 1980): x = k ln 2 + r with the integer k nearest to x / ln 2, so that
// e^x = 2^k e^r. ln 2 is taken as L1 + L2, L1 so short that k L1 is exact.
//
// Series: p(r) = 1 + r + r^2/2 + r^3 Q(r). Q is the Taylor polynomial of
// (e^r - 1 - r - r^2/2) / r^3 less its two highest terms, economised: of each term c r^n its
// multiple of the Chebyshev polynomial, c h^n / 2^(n-1) T_n(r/h), is left out, which is at most
// c h^n / 2^(n-1) on |r| <= h, and the rest goes into the lower coefficients.
//
// u is half the distance from 1 to the next number: 2^-53, for float 2^-24; h = 0.3466. What is
// said of float stands in brackets.
//
// (1) |r| < h: fl(x / ln 2) is off by a relative 2.1 u at most, so |r| <= (ln 2)/2 + 2.1 u |x|,
//     below 0.34659 for |x| < 1000 [for |x| <= 88].
//
// (2) x - k L1 is exact: for k = 0 it is x. Else |x| > 1/4, and x is a multiple of u/2; so is
//     k L1, which is a number, as L1 < 1 is a multiple of 2^-42 [2^-17] and |k| < 2^11 [2^7].
//     Their difference is a multiple of u/2 below 1/2: no more than 53 [24] bits.
//
// (3) r = fl((x - k L1) - w) with w = fl(k L2), where |ln 2 - L1 - L2| < 2^-102 [2^-44] and
//     |L2| < 2^-44 [2^-19]: r is off by half a unit of its last place, at most u/4, and by less
//     than 2^-84 [2^-35] from L2 and w.
//
// (4) |p(r) - e^r| <= |r|^3 E with E h^3 < 2^-59.9 [2^-30.7]. The terms left out give
//     h^14/14!/2^10 + h^13/13!/2^9 [h^9/9!/2^5 + h^8/8!/2^4], the remainder of the Taylor series
//     1.05 h^15/15! [1.05 h^10/10!], rounding the coefficients 2^-60.8 [2^-32.0].
//
// (5) v = r^2/2 + r^3 Q(r) as computed is off by less than 1.5 u r^2. In units of u r^2:
//     0.5   rounding r^2;
//     0.34  r^3 Q: Q in [0.15, 0.19] comes from three sums that are off by u/8 each, the rest
//           of it is below 0.04 u; r^2, r^3 and the product with Q add three times 0.183 u;
//           in all |r| (0.42 + 0.55);
//     0.57  the sum; 0.08 by (4).
//
// (6) t = fl(r + v), s = fl(1 + t).
//     r >= 0: t < 0.415 is off by u/4 and s by u. With r by (3) and v, relative to e^r >= 1:
//             (1/4 + 0.19 + 1/4 + 1) u < 1.7 u.
//     r < 0:  |t| < 0.293 is off by u/4 and s < 1 by u/2. Relative to e^r > 0.707:
//             (1/4 + (0.19 + 1/4 + 1/2) / 0.707) u < 1.6 u.
//     The 2^-84 [2^-35] of (3) is below 0.001 u. Scaling by 2^k is exact.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "core/interval/interval.h"

namespace ivory {

// { e^x : x in a }, within one number of the tightest at each end; [1, 1] for [0, 0].
template <IeeeReal Real>
[[nodiscard]] Interval<Real> exp(const Interval<Real>& a);

template <>
Interval<double> exp(const Interval<double>& a);
template <>
Interval<float> exp(const Interval<float>& a);

template <IeeeReal Real>
struct ExpConstants;

template <>
struct ExpConstants<double> {
    static constexpr double rounder = 0x1.8p52;  // added, it leaves an integer in the low bits
    static constexpr double inverse_of_ln2 = 0x1.71547652b82fep+0;
    static constexpr double ln2_high = 0x1.62e42fefa3800p-1;  // L1
    static constexpr double ln2_low = 0x1.ef35793c76730p-45;  // L2
    static constexpr double least = -708;
    static constexpr double greatest = 709;
    // Q(r), lowest power first.
    static constexpr double tail[] = {
        0x1.5555555555556p-3,  0x1.5555555555556p-5,  0x1.11111111109b6p-7,  0x1.6c16c16c162d8p-10,
        0x1.a01a01a7c12bbp-13, 0x1.a01a01a6d6122p-16, 0x1.71de0dbd7b455p-19, 0x1.27e4db6eb2e8bp-22,
        0x1.af387497dfeffp-26, 0x1.1f72e3be86384p-29};
    using Bits = std::uint64_t;
};

template <>
struct ExpConstants<float> {
    static constexpr float rounder = 0x1.8p23f;
    static constexpr float inverse_of_ln2 = 0x1.715476p+0f;
    static constexpr float ln2_high = 0x1.62e4p-1f;
    static constexpr float ln2_low = 0x1.7f7d1cp-20f;
    static constexpr float least = -87;
    static constexpr float greatest = 88;
    static constexpr float tail[] = {0x1.555556p-3f, 0x1.55551ap-5f, 0x1.1110e2p-7f, 0x1.6d10bp-10f,
                                     0x1.a1249ap-13f};
    using Bits = std::uint32_t;
};

// r^3 Q(r), for |r| <= h, and r^2 as computed; Number is double or float, or a vector of them made
// from one of them.
template <IeeeReal Real, class Number>
[[nodiscard]] constexpr Number exp_tail(Number r, Number r2) {
    const auto c = [](std::size_t i) { return Number(ExpConstants<Real>::tail[i]); };
    const Number q01 = c(0) + c(1) * r;
    const Number q23 = c(2) + c(3) * r;
    if constexpr (std::same_as<Real, double>) {
        const Number r4 = r2 * r2;
        const Number q45 = c(4) + c(5) * r;
        const Number q67 = c(6) + c(7) * r;
        const Number q89 = c(8) + c(9) * r;
        return (r * r2) * ((q01 + q23 * r2) + r4 * ((q45 + q67 * r2) + r4 * q89));
    } else {
        return (r * r2) * (q01 + r2 * (q23 + r2 * c(4)));
    }
}

// |exp_nearest(x) - e^x| <= exp_relative_error e^x for x in [-708, 709] (float: [-87, 88]), by (6).
// Below it is 0, off by e^-708 < 3.4e-308 (float: e^-87 < 1.7e-38) at most; x above the range gives
// the value at its end. exp_nearest(0) = 1. x is not NaN.
template <IeeeReal Real>
inline constexpr Real exp_relative_error = std::numeric_limits<Real>::epsilon();

template <IeeeReal Real>
[[nodiscard]] constexpr Real exp_nearest(Real x) {
    using C = ExpConstants<Real>;
    using Bits = typename C::Bits;
    const Real within = x < C::least ? C::least : x > C::greatest ? C::greatest : x;
    const Real shifted = within * C::inverse_of_ln2 + C::rounder;
    const Real k = shifted - C::rounder;
    const Real r = (within - k * C::ln2_high) - k * C::ln2_low;
    const Real r2 = r * r;
    const Real s = Real(1) + (r + (Real(0.5) * r2 + exp_tail<Real>(r, r2)));
    // s is normal and so is s 2^k: k is added to its exponent.
    constexpr int fraction_width = std::numeric_limits<Real>::digits - 1;
    const Bits exponent = std::bit_cast<Bits>(shifted) << fraction_width;
    const Real scaled = std::bit_cast<Real>(std::bit_cast<Bits>(s) + exponent);
    return x < C::least ? Real(0) : scaled;
}

// 2^-x for x >= 0, of fewer operations: with k the integer nearest to x, r = x - k is exact,
// and 2^-x = 2^-k 2^-r with
//     2^-r = 1 + r q(r),  q = c0 + r (c1 + r (...)),  |r| <= 1/2,
// q interpolated at the zeros of a Chebyshev polynomial and rounded.
//
// (7) |1 + r q(r) - 2^-r| < |r| 2^-54.4 [2^-26], below 0.19 u.
//
// (8) Numbers below 1, 1/2, .. are off by u/2, u/4, .. once rounded. In q: the last sum below 0.84
//     by u/2, the product in it, below 0.15, by u/8, its other factor, below 0.29, by u/4, which
//     counts half, and all before it by less than u/32: 0.8 u. So r q, below 0.42, is off by
//     0.4 u + u/4, and by 0.84 u with (7).
//     r < 0: 1 + r q in [1, 1.42) is off by u more: 1.84 u relative to 2^-r >= 1.
//     r > 0: by u/2 more: 1.34 u relative to 2^-r > 0.707, less than 1.9 u.
//     Fused products leave out roundings.
template <IeeeReal Real>
struct Exp2Constants;

template <>
struct Exp2Constants<double> {
    static constexpr double greatest = 1021;
    static constexpr double series[] = {
        -0x1.62e42fefa39efp-1,  0x1.ebfbdff82c598p-3,   -0x1.c6b08d704a0c2p-5,
        0x1.3b2ab6fba1ddap-7,   -0x1.5d87fe78a5276p-10, 0x1.430913096fd9fp-13,
        -0x1.ffcbfc670dcd4p-17, 0x1.62bfd47773353p-20,  -0x1.b524fae627834p-24,
        0x1.e6063f7217bc6p-28,  -0x1.e9d3fe3952179p-32};
};

template <>
struct Exp2Constants<float> {
    static constexpr float greatest = 125;
    static constexpr float series[] = {-0x1.62e43p-1f, 0x1.ebfbep-3f,   -0x1.c6af6cp-5f,
                                       0x1.3b2a54p-7f, -0x1.5f089p-10f, 0x1.44138ap-13f};
};

// 1 + r q(r); Number as for exp_tail.
template <IeeeReal Real, class Number>
[[nodiscard]] constexpr Number exp2_series(Number r) {
    constexpr auto& c = Exp2Constants<Real>::series;
    Number q(c[std::size(c) - 1]);
    for (std::size_t i = std::size(c) - 1; i > 0; --i) q = Number(c[i - 1]) + r * q;
    return Number(Real(1)) + r * q;
}

// |exp2_minus(x) - 2^-x| <= exp_relative_error 2^-x for x in [0, 1021] (float: [0, 125]), by (8);
// beyond, the value at the end. exp2_minus(0) = 1. x is not NaN.
template <IeeeReal Real>
[[nodiscard]] constexpr Real exp2_minus(Real x) {
    using Bits = typename ExpConstants<Real>::Bits;
    const Real within = x > Exp2Constants<Real>::greatest ? Exp2Constants<Real>::greatest : x;
    const Real shifted = ExpConstants<Real>::rounder - within;
    const Real r = within + (shifted - ExpConstants<Real>::rounder);
    constexpr int fraction_width = std::numeric_limits<Real>::digits - 1;
    const Bits exponent = std::bit_cast<Bits>(shifted) << fraction_width;
    return std::bit_cast<Real>(std::bit_cast<Bits>(exp2_series<Real>(r)) + exponent);
}

}  // namespace ivory
