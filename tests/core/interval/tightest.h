// The tightest enclosures, by GNU MPFR: each end is found as the least or the greatest of the exact
// results for the ends of the operands, at 256 bits, rounded outward once more to Real.
#pragma once

#include <mpfr.h>

#include <initializer_list>
#include <limits>
#include <vector>

#include "core/interval/interval.h"
#include "tests/reference/multiprecision.h"

namespace ivory::test {

template <IeeeReal Real>
Real rounded_to(const reference::Real& x, mpfr_rnd_t rounding) {
    if constexpr (std::same_as<Real, float>) {
        return mpfr_get_flt(x.raw(), rounding);
    } else {
        return mpfr_get_d(x.raw(), rounding);
    }
}

// Around the values of `at`, a function of a rounding direction and two numbers, at all pairs.
template <IeeeReal Real, class Function>
Interval<Real> around(const std::vector<Real>& xs, const std::vector<Real>& ys, Function at) {
    Interval<Real> result;
    for (const Real x : xs) {
        for (const Real y : ys) {
            result = hull(result, Interval<Real>(rounded_to<Real>(at(MPFR_RNDD, x, y), MPFR_RNDD),
                                                 rounded_to<Real>(at(MPFR_RNDU, x, y), MPFR_RNDU)));
        }
    }
    return result;
}

template <IeeeReal Real>
Interval<Real> tightest_sum(const Interval<Real>& a, const Interval<Real>& b) {
    if (is_empty(a) || is_empty(b)) return {};
    const auto sum = [](Real x, Real y, mpfr_rnd_t rounding) {
        return rounded_to<Real>(
            reference::rounded(mpfr_add, rounding, reference::Real(x), reference::Real(y)),
            rounding);
    };
    return {sum(a.lo, b.lo, MPFR_RNDD), sum(a.hi, b.hi, MPFR_RNDU)};
}

template <IeeeReal Real>
Interval<Real> tightest_product(const Interval<Real>& a, const Interval<Real>& b) {
    if (is_empty(a) || is_empty(b)) return {};
    return around<Real>({a.lo, a.hi}, {b.lo, b.hi}, [](mpfr_rnd_t rounding, Real x, Real y) {
        if (x == 0 || y == 0) return reference::Real(0.0);
        return reference::rounded(mpfr_mul, rounding, reference::Real(x), reference::Real(y));
    });
}

// b is split at 0, which is left out; towards it the quotients grow beyond all bounds, and towards
// infinity they tend to 0.
template <IeeeReal Real>
Interval<Real> tightest_quotient(const Interval<Real>& a, const Interval<Real>& b) {
    if (is_empty(a) || is_empty(b)) return {};
    Interval<Real> result;
    for (const double side : {-1.0, 1.0}) {
        const Interval<Real> half =
            side < 0 ? Interval<Real>(-infinity<Real>, 0) : Interval<Real>(0, infinity<Real>);
        const Interval<Real> part = intersection(b, half);
        if (is_empty(part) || (part.lo == 0 && part.hi == 0)) continue;
        result =
            hull(result,
                 around<Real>(
                     {a.lo, a.hi}, {part.lo, part.hi}, [side](mpfr_rnd_t rounding, Real x, Real y) {
                         if (x == 0 || std::isinf(y)) return reference::Real(0.0);
                         if (y == 0)
                             return reference::Real((x > 0) == (side > 0) ? HUGE_VAL : -HUGE_VAL);
                         return reference::rounded(mpfr_div, rounding, reference::Real(x),
                                                   reference::Real(y));
                     }));
    }
    return result;
}

template <IeeeReal Real>
Interval<Real> tightest_square(const Interval<Real>& a) {
    if (is_empty(a)) return {};
    std::vector<Real> ends{a.lo, a.hi};
    if (a.lo <= 0 && a.hi >= 0) ends.push_back(0);
    return around<Real>(ends, {0}, [](mpfr_rnd_t rounding, Real x, Real) {
        return reference::rounded(mpfr_sqr, rounding, reference::Real(x));
    });
}

template <IeeeReal Real>
Interval<Real> tightest_root(const Interval<Real>& a) {
    const Interval<Real> domain = intersection(a, Interval<Real>(0, infinity<Real>));
    if (is_empty(domain)) return {};
    return around<Real>({domain.lo, domain.hi}, {0}, [](mpfr_rnd_t rounding, Real x, Real) {
        return reference::rounded(mpfr_sqrt, rounding, reference::Real(x == 0 ? Real(0) : x));
    });
}

// a b + c with c added at its own end: the least sum has the least c.
template <IeeeReal Real>
Interval<Real> tightest_fma(const Interval<Real>& a, const Interval<Real>& b,
                            const Interval<Real>& c) {
    if (is_empty(a) || is_empty(b) || is_empty(c)) return {};
    const auto end = [&](Real z, mpfr_rnd_t rounding) {
        if (std::isinf(z)) return Interval<Real>(z);
        return around<Real>({a.lo, a.hi}, {b.lo, b.hi}, [&](mpfr_rnd_t, Real x, Real y) {
            if (x == 0 || y == 0) return reference::Real(z);
            return reference::rounded(mpfr_fma, rounding, reference::Real(x), reference::Real(y),
                                      reference::Real(z));
        });
    };
    return {end(c.lo, MPFR_RNDD).lo, end(c.hi, MPFR_RNDU).hi};
}

template <IeeeReal Real>
Interval<Real> tightest_power(const Interval<Real>& a, int n) {
    if (is_empty(a)) return {};
    const auto powers = [n](const Interval<Real>& part, int side) {
        return around<Real>({part.lo, part.hi}, {0}, [n, side](mpfr_rnd_t rounding, Real x, Real) {
            const double end = x == 0 ? std::copysign(0.0, side) : static_cast<double>(x);
            reference::Real result;
            mpfr_pow_si(result.raw(), reference::Real(end).raw(), n, rounding);
            return result;
        });
    };
    Interval<Real> result;
    for (const int side : {-1, 1}) {
        const Interval<Real> half =
            side < 0 ? Interval<Real>(-infinity<Real>, 0) : Interval<Real>(0, infinity<Real>);
        const Interval<Real> part = intersection(a, half);
        if (is_empty(part) || (n < 0 && part.lo == 0 && part.hi == 0)) continue;
        result = hull(result, powers(part, side));
    }
    return result;
}

template <IeeeReal Real>
Interval<Real> tightest_exp(const Interval<Real>& a) {
    if (is_empty(a)) return {};
    return around<Real>({a.lo, a.hi}, {0}, [](mpfr_rnd_t rounding, Real x, Real) {
        return reference::rounded(mpfr_exp, rounding, reference::Real(x));
    });
}

}  // namespace ivory::test
