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
// A lower end that is infinite stays or, where it overflowed, is the largest double; likewise
// above.
inline double lower_end(double x) {
    return std::abs(x) < infinity<double> ? down(x) : std::min(x, largest<double>);
}
inline double upper_end(double x) {
    return std::abs(x) < infinity<double> ? up(x) : std::max(x, -largest<double>);
}
}  // namespace detail

inline Interval<double> add(const Interval<double>& a, const Interval<double>& b) {
    return {detail::lower_end(a.lo + b.lo), detail::upper_end(a.hi + b.hi)};
}

inline Interval<double> sub(const Interval<double>& a, const Interval<double>& b) {
    return {detail::lower_end(a.lo - b.hi), detail::upper_end(a.hi - b.lo)};
}

inline Interval<double> mul(const Interval<double>& a, const Interval<double>& b) {
    const double ll = detail::product(a.lo, b.lo), lh = detail::product(a.lo, b.hi);
    const double hl = detail::product(a.hi, b.lo), hh = detail::product(a.hi, b.hi);
    return {detail::lower_end(std::min(std::min(ll, lh), std::min(hl, hh))),
            detail::upper_end(std::max(std::max(ll, lh), std::max(hl, hh)))};
}

// s >= 0 finite, exact.
inline Interval<double> scale(double s, const Interval<double>& a) {
    return {detail::lower_end(detail::product(s, a.lo)),
            detail::upper_end(detail::product(s, a.hi))};
}

// b > 0.
inline Interval<double> div(const Interval<double>& a, const Interval<double>& b) {
    return {detail::lower_end(a.lo / (a.lo < 0 ? b.lo : b.hi)),
            detail::upper_end(a.hi / (a.hi < 0 ? b.hi : b.lo))};
}

inline Interval<double> sqr(const Interval<double>& a) {
    const double most = std::max(std::abs(a.lo), std::abs(a.hi));
    const double least = std::max(std::max(a.lo, -a.hi), 0.0);
    return {std::max(detail::lower_end(least * least), 0.0), detail::upper_end(most * most)};
}

// a.hi >= 0.
inline Interval<double> sqrt(const Interval<double>& a) {
    return {std::max(detail::lower_end(std::sqrt(std::max(a.lo, 0.0))), 0.0),
            detail::upper_end(std::sqrt(a.hi))};
}

}  // namespace ivory::quick
