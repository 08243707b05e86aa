// Intervals of doubles with generous margins: the reference's quick look, which decides only what
// is far from doubtful. Written apart from core/interval on purpose, and with other means.
#pragma once

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

#include "tests/reference/multiprecision.h"

namespace ivory::reference {

// A closed interval; never NaN. Each operation rounds to nearest and then moves both ends outward
// by at least one unit in the last place: x 2^-52 is 1 to 2 ulp of a normal x, the least subnormal
// covers the rest.
struct OutwardDouble {
    double lo = 0, hi = 0;

    OutwardDouble() = default;
    OutwardDouble(double x) : lo(x), hi(x) {}
    OutwardDouble(double low, double high) : lo(low), hi(high) {
        if (!(lo <= hi)) *this = entire();  // NaN: infinity - infinity, 0 infinity
    }
    explicit OutwardDouble(const RealInterval& x)
        : OutwardDouble(x.lo.to_double(MPFR_RNDD), x.hi.to_double(MPFR_RNDU)) {}

    [[nodiscard]] static OutwardDouble entire() {
        OutwardDouble all;
        all.lo = -std::numeric_limits<double>::infinity();
        all.hi = std::numeric_limits<double>::infinity();
        return all;
    }
    // Encloses what rounds to [low, high].
    [[nodiscard]] static OutwardDouble around(double low, double high) {
        const auto step = [](double x) { return std::fabs(x) * 0x1p-52 + DBL_TRUE_MIN; };
        const double infinity = std::numeric_limits<double>::infinity();
        return {low == infinity ? DBL_MAX : low - step(low),
                high == -infinity ? -DBL_MAX : high + step(high)};
    }
    // x 2^exponent
    [[nodiscard]] static OutwardDouble of(double x, long exponent) {
        const double y = std::ldexp(x, static_cast<int>(exponent));
        return around(y, y);
    }
    [[nodiscard]] bool is_point() const { return lo == hi; }
    [[nodiscard]] double width() const { return hi - lo; }
};

[[nodiscard]] inline RealInterval exactly(const OutwardDouble& x) {
    return {Real(x.lo), Real(x.hi)};
}

[[nodiscard]] inline OutwardDouble operator-(const OutwardDouble& x) { return {-x.hi, -x.lo}; }

[[nodiscard]] inline OutwardDouble operator+(const OutwardDouble& x, const OutwardDouble& y) {
    return OutwardDouble::around(x.lo + y.lo, x.hi + y.hi);
}

[[nodiscard]] inline OutwardDouble operator-(const OutwardDouble& x, const OutwardDouble& y) {
    return OutwardDouble::around(x.lo - y.hi, x.hi - y.lo);
}

[[nodiscard]] inline OutwardDouble operator*(const OutwardDouble& x, const OutwardDouble& y) {
    const double ll = x.lo * y.lo, lh = x.lo * y.hi, hl = x.hi * y.lo, hh = x.hi * y.hi;
    if (std::isnan(ll) || std::isnan(lh) || std::isnan(hl) || std::isnan(hh)) {
        return OutwardDouble::entire();
    }
    return OutwardDouble::around(std::min(std::min(ll, lh), std::min(hl, hh)),
                                 std::max(std::max(ll, lh), std::max(hl, hh)));
}

[[nodiscard]] inline OutwardDouble operator/(const OutwardDouble& x, const OutwardDouble& y) {
    if (y.lo <= 0 && y.hi >= 0) return OutwardDouble::entire();
    return x * OutwardDouble::around(1 / y.hi, 1 / y.lo);
}

[[nodiscard]] inline OutwardDouble sqr(const OutwardDouble& x) {
    const double a = x.lo * x.lo, b = x.hi * x.hi;
    const bool holds_zero = x.lo <= 0 && x.hi >= 0;
    const OutwardDouble y = OutwardDouble::around(holds_zero ? 0 : std::min(a, b), std::max(a, b));
    return {std::max(y.lo, 0.0), y.hi};
}

// Of the part of x that is not negative; 0 where there is none.
[[nodiscard]] inline OutwardDouble sqrt(const OutwardDouble& x) {
    const OutwardDouble y =
        OutwardDouble::around(std::sqrt(std::max(x.lo, 0.0)), std::sqrt(std::max(x.hi, 0.0)));
    return {std::max(y.lo, 0.0), y.hi};
}

// glibc documents exp to 1 ulp; the margin is some fifty.
[[nodiscard]] inline OutwardDouble exp(const OutwardDouble& x) {
    const double low = std::exp(x.lo), high = std::exp(x.hi);
    return {std::max(0.0, std::min(low, DBL_MAX) * (1 - 1e-14) - DBL_MIN),
            high * (1 + 1e-14) + DBL_MIN};
}

// [x.lo, y.hi]
[[nodiscard]] inline OutwardDouble from_to(const OutwardDouble& x, const OutwardDouble& y) {
    return {x.lo, y.hi};
}

[[nodiscard]] inline OutwardDouble hull(const OutwardDouble& x, const OutwardDouble& y) {
    return {std::min(x.lo, y.lo), std::max(x.hi, y.hi)};
}

// The common part; x and y are known to share a point.
[[nodiscard]] inline OutwardDouble common(const OutwardDouble& x, const OutwardDouble& y) {
    return {std::max(x.lo, y.lo), std::min(x.hi, y.hi)};
}

[[nodiscard]] inline bool certainly_positive(const OutwardDouble& x) { return x.lo > 0; }
[[nodiscard]] inline bool certainly_negative(const OutwardDouble& x) { return x.hi < 0; }

}  // namespace ivory::reference
