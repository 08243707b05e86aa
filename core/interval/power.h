// Integer powers of intervals, each end at most one number outside the tightest.
//
// A power is computed by squaring in pairs hi + lo of doubles with the exponent kept apart, so that
// nothing overflows or underflows on the way: (hi + lo) 2^exponent, hi in [1, 2), |lo| <= 2^-53.
//
// Product: p + e = A.hi B.hi exactly (e by fma), and lo = e + (A.hi B.lo + A.lo B.hi). Left out is
// A.lo B.lo, at most 2^-106; rounding costs 2^-105 for each product, 2^-104 for their sum, 2^-104
// for the sum with e: below 2^-102 in all, relative to a product of 1 - 2^-52 at least, and nothing
// where both lo are 0. The relative errors of the factors add up. They stay below 2^-68, so that
// the product of two of them disappears in the factors 2 and 3/2 that are kept in hand here.
//
// Reciprocal: q = fl(1 / hi), and 1 / hi - q = (1 - q hi) / hi, where 1 - q hi is exact by fma;
// lo = ((1 - q hi) - q lo) / hi. Its three operations, on numbers below 2^-51, are off by less than
// 2^-102.4 in all; left out are (lo / hi)^2 and lo (1 - q hi) / hi^2, at most 2^-105 together.
// Relative to a value above 1/2: below 2^-101.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/interval/interval.h"

namespace ivory {

class PowerOfDouble {
  public:
    // |x|^n for finite x != 0 and n != 0.
    PowerOfDouble(double x, int n) {
        int binary_exponent = 0;
        Term square{2 * std::frexp(x < 0 ? -x : x, &binary_exponent), 0, 0, 0};
        square.exponent = binary_exponent - 1;
        power_ = {1, 0, 0, 0};
        for (std::int64_t bits = n < 0 ? -std::int64_t{n} : n; bits > 0; bits >>= 1) {
            if (bits & 1) power_ = product(power_, square);
            square = product(square, square);
        }
        if (n < 0) power_ = reciprocal(power_);
    }

    // Bounds of |x|^n. hi < 2, so the absolute error is below 2 and with the factor in hand 3 times
    // the relative one. |lo| + that < 2^-52.9 is less than a step from hi; downwards from hi = 1,
    // where the step is 2^-53, lo < 0 is at least -2^-54.
    [[nodiscard]] double lower() const {
        const double w = power_.lo - 3 * power_.error;
        return scale_down(w < 0 ? next_down(power_.hi) : power_.hi, power_.exponent);
    }
    [[nodiscard]] double upper() const {
        const double w = power_.lo + 3 * power_.error;
        return scale_up(w > 0 ? next_up(power_.hi) : power_.hi, power_.exponent);
    }

  private:
    struct Term {
        double hi;
        double lo;
        std::int64_t exponent;
        double error;  // relative
    };

    static Term normalised(double p, double e, std::int64_t exponent, double error) {
        const double hi = p + e;
        const double lo = e - (hi - p);
        if (hi >= 2) return {hi / 2, lo / 2, exponent + 1, error};
        if (hi < 1) return {hi * 2, lo * 2, exponent - 1, error};
        return {hi, lo, exponent, error};
    }

    static Term product(const Term& a, const Term& b) {
        const double p = a.hi * b.hi;
        const double e = std::fma(a.hi, b.hi, -p);
        const bool exact = a.lo == 0 && b.lo == 0;
        return normalised(p, e + (a.hi * b.lo + a.lo * b.hi), a.exponent + b.exponent,
                          a.error + b.error + (exact ? 0 : 0x1p-101));
    }

    static Term reciprocal(const Term& a) {
        const double q = 1 / a.hi;
        const double residual = std::fma(-q, a.hi, 1.0);
        const bool exact = residual == 0 && a.lo == 0;
        return normalised(q, (residual - q * a.lo) / a.hi, -a.exponent,
                          a.error + (exact ? 0 : 0x1p-100));
    }

    Term power_{};
};

// { x^n : x in a }, where 0 is left out for n < 0; x^0 = 1 everywhere.
template <IeeeReal Real>
[[nodiscard]] Interval<Real> pown(const Interval<Real>& a, int n) {
    if (is_empty(a)) return {};
    if (n == 0) return Interval<Real>(1);
    if (n == 1) return a;
    if (n == 2) return sqr(a);
    if (n == -1) return recip(a);
    if (n < 0 && a.lo == 0 && a.hi == 0) return {};

    // |x|^n for x >= 0 or infinite, with 1/0 = inf and 1/inf = 0.
    const auto ends = [n](Real x) -> Interval<Real> {
        if (x == 0) return n > 0 ? Real(0) : infinity<Real>;
        if (x == infinity<Real>) return n > 0 ? infinity<Real> : Real(0);
        const PowerOfDouble power(static_cast<double>(x), n);
        if constexpr (std::same_as<Real, float>) {
            return {float_down(power.lower()), float_up(power.upper())};
        } else {
            return {power.lower(), power.upper()};
        }
    };

    if (n % 2 == 0) {
        const Interval<Real> least = ends(n > 0 ? mig(a) : mag(a));
        const Interval<Real> greatest = ends(n > 0 ? mag(a) : mig(a));
        return {least.lo, greatest.hi};
    }
    if (n < 0 && a.lo < 0 && a.hi > 0) return Interval<Real>::entire();
    if (a.lo < 0 && a.hi <= 0) return -pown(-a, n);
    if (a.lo < 0) return {-ends(-a.lo).hi, ends(a.hi).hi};  // n > 0
    return n > 0 ? Interval<Real>{ends(a.lo).lo, ends(a.hi).hi}
                 : Interval<Real>{ends(a.hi).lo, ends(a.lo).hi};
}

}  // namespace ivory
