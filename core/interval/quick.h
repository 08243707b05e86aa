// The same operations on non-empty intervals of doubles for inner loops: one step outward of twice
// the largest rounding error instead of the nearest neighbour, no test for exact results, no
// branches.
//
// A result x of one rounding errs by u |x| or, where it underflows, by 2^-1075: x -+ (2 u |x| +
// 2^-1070), with the step's own roundings (3 u of the step, u of the sum), bounds it. Infinite ends
// stay; 0 times infinity counts as 0, since infinity is not a member.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/interval/interval.h"

namespace ivory::quick {

inline double down(double x) { return x - (std::abs(x) * 0x1.8p-52 + 0x1p-1070); }
inline double up(double x) { return x + (std::abs(x) * 0x1.8p-52 + 0x1p-1070); }

namespace detail {
inline double product(double a, double b) {
    const double p = a * b;
    return p == p ? p : 0;
}
// Infinite ends must not turn into NaN: inf - inf.
inline double down_or_infinite(double x) { return std::abs(x) < infinity<double> ? down(x) : x; }
inline double up_or_infinite(double x) { return std::abs(x) < infinity<double> ? up(x) : x; }
}  // namespace detail

inline Interval<double> add(const Interval<double>& a, const Interval<double>& b) {
    return {detail::down_or_infinite(a.lo + b.lo), detail::up_or_infinite(a.hi + b.hi)};
}

inline Interval<double> sub(const Interval<double>& a, const Interval<double>& b) {
    return {detail::down_or_infinite(a.lo - b.hi), detail::up_or_infinite(a.hi - b.lo)};
}

inline Interval<double> mul(const Interval<double>& a, const Interval<double>& b) {
    const double ll = detail::product(a.lo, b.lo), lh = detail::product(a.lo, b.hi);
    const double hl = detail::product(a.hi, b.lo), hh = detail::product(a.hi, b.hi);
    return {detail::down_or_infinite(std::min(std::min(ll, lh), std::min(hl, hh))),
            detail::up_or_infinite(std::max(std::max(ll, lh), std::max(hl, hh)))};
}

// s >= 0 finite, exact.
inline Interval<double> scale(double s, const Interval<double>& a) {
    return {detail::down_or_infinite(detail::product(s, a.lo)),
            detail::up_or_infinite(detail::product(s, a.hi))};
}

// b > 0.
inline Interval<double> div(const Interval<double>& a, const Interval<double>& b) {
    return {detail::down_or_infinite(a.lo / (a.lo < 0 ? b.lo : b.hi)),
            detail::up_or_infinite(a.hi / (a.hi < 0 ? b.hi : b.lo))};
}

inline Interval<double> sqr(const Interval<double>& a) {
    const double most = std::max(std::abs(a.lo), std::abs(a.hi));
    const double least = std::max(std::max(a.lo, -a.hi), 0.0);
    return {std::max(down(least * least), 0.0), detail::up_or_infinite(most * most)};
}

// a.hi >= 0.
inline Interval<double> sqrt(const Interval<double>& a) {
    return {std::max(down(std::sqrt(std::max(a.lo, 0.0))), 0.0),
            detail::up_or_infinite(std::sqrt(a.hi))};
}

}  // namespace ivory::quick
