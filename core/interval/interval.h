// Closed intervals of float and double, with the empty set and unbounded ones: bare intervals of
// IEEE 1788-2015. Every operation encloses the exact results for all real members of its operands
// that lie in its domain. An infinite bound means unbounded: infinity is never a member.
//
// Ends are the tightest in float and for sums of doubles, else at most one number outside them.
// Bounds must not be NaN; an interval that fails lo <= hi counts as empty.
#pragma once

#include "core/interval/rounding.h"

namespace ivory {

template <IeeeReal Real>
struct Interval {
    Real lo = infinity<Real>;
    Real hi = -infinity<Real>;

    constexpr Interval() = default;  // the empty set
    constexpr Interval(Real point) : lo(point), hi(point) {}
    constexpr Interval(Real lower, Real upper) : lo(lower), hi(upper) {}  // lower <= upper

    [[nodiscard]] static constexpr Interval empty_set() { return {}; }
    [[nodiscard]] static constexpr Interval entire() { return {-infinity<Real>, infinity<Real>}; }

    // As sets; all empty sets that the operations make are {inf, -inf}.
    friend constexpr bool operator==(const Interval&, const Interval&) = default;

    // Sets.

    [[nodiscard]] friend constexpr bool is_empty(const Interval& a) { return !(a.lo <= a.hi); }

    // x is finite.
    [[nodiscard]] friend constexpr bool contains(const Interval& a, Real x) {
        return (a.lo <= x) & (x <= a.hi);
    }

    [[nodiscard]] friend constexpr bool is_subset(const Interval& a, const Interval& b) {
        return is_empty(a) || (b.lo <= a.lo && a.hi <= b.hi);
    }

    [[nodiscard]] friend constexpr Interval intersection(const Interval& a, const Interval& b) {
        const Interval both(a.lo > b.lo ? a.lo : b.lo, a.hi < b.hi ? a.hi : b.hi);
        return is_empty(both) ? empty_set() : both;
    }

    // The least interval around both.
    [[nodiscard]] friend constexpr Interval hull(const Interval& a, const Interval& b) {
        return {a.lo < b.lo ? a.lo : b.lo, a.hi > b.hi ? a.hi : b.hi};
    }

    // Statements about every member; true of the empty set, as it has none.

    [[nodiscard]] friend constexpr bool certainly_less(const Interval& a, const Interval& b) {
        return a.hi < b.lo;
    }
    [[nodiscard]] friend constexpr bool certainly_positive(const Interval& a) { return a.lo > 0; }
    [[nodiscard]] friend constexpr bool certainly_negative(const Interval& a) { return a.hi < 0; }
    [[nodiscard]] friend constexpr bool possibly_zero(const Interval& a) {
        return contains(a, Real(0));
    }

    // Sums: the tightest.

    friend constexpr Interval operator-(const Interval& a) { return {-a.hi, -a.lo}; }

    friend constexpr Interval operator+(const Interval& a, const Interval& b) {
        if (is_empty(a) || is_empty(b)) return empty_set();
        return {add_down(a.lo, b.lo), add_up(a.hi, b.hi)};
    }

    friend constexpr Interval operator-(const Interval& a, const Interval& b) { return a + -b; }

    // Products. 0 times an unbounded interval is 0. s is finite.

    friend constexpr Interval operator*(Real s, const Interval& a) {
        if (is_empty(a)) return empty_set();
        const bool keeps_order = s >= 0;
        return {mul_down(s, keeps_order ? a.lo : a.hi), mul_up(s, keeps_order ? a.hi : a.lo)};
    }

    friend constexpr Interval operator*(const Interval& a, Real s) { return s * a; }

    friend constexpr Interval operator*(const Interval& a, const Interval& b) {
        if (is_empty(a) || is_empty(b)) return empty_set();
        return product(a, b);
    }

    [[nodiscard]] friend constexpr Interval sqr(const Interval& a) {
        if (is_empty(a)) return empty_set();
        return {mul_down(mig(a), mig(a)), mul_up(mag(a), mag(a))};
    }

    // a b + c, rounded once.
    [[nodiscard]] friend Interval fma(const Interval& a, const Interval& b, const Interval& c) {
        if (is_empty(a) || is_empty(b) || is_empty(c)) return empty_set();
        return {least_of(fma_down(a.lo, b.lo, c.lo), fma_down(a.lo, b.hi, c.lo),
                         fma_down(a.hi, b.lo, c.lo), fma_down(a.hi, b.hi, c.lo)),
                -least_of(fma_down(-a.lo, b.lo, -c.hi), fma_down(-a.lo, b.hi, -c.hi),
                          fma_down(-a.hi, b.lo, -c.hi), fma_down(-a.hi, b.hi, -c.hi))};
    }

    // Quotients: { x / y : x in a, y in b, y != 0 }, so that a / [0, 0] is empty, 1 / [0, 1] is
    // [1, inf], and a / b with 0 inside b is the whole line.
    //
    //   b > 0:            lo = a.lo / (a.lo < 0 ? b.lo : b.hi),
    //                     hi = a.hi / (a.hi < 0 ? b.hi : b.lo)
    //   b.lo = 0 < b.hi:  the same with 1 / b.lo = inf:
    //                     a >= 0: [a.lo / b.hi, inf],
    //                     a <= 0: [-inf, a.hi / b.hi],
    //                     0 inside a: the whole line
    //   b.hi <= 0:        (-a) / (-b)
    friend constexpr Interval operator/(const Interval& a, const Interval& b) {
        if (is_empty(a) || is_empty(b) || (b.lo == 0 && b.hi == 0)) return empty_set();
        if (a.lo == 0 && a.hi == 0) return a;
        if (b.lo < 0 && b.hi > 0) return entire();
        if (b.hi <= 0) return -a / -b;
        if (b.lo > 0)
            return {div_down(a.lo, a.lo < 0 ? b.lo : b.hi), div_up(a.hi, a.hi < 0 ? b.hi : b.lo)};
        if (a.lo >= 0) return {div_down(a.lo, b.hi), infinity<Real>};
        if (a.hi <= 0) return {-infinity<Real>, div_up(a.hi, b.hi)};
        return entire();
    }

    [[nodiscard]] friend constexpr Interval recip(const Interval& a) { return Interval(1) / a; }

    // Of the members >= 0.
    [[nodiscard]] friend Interval sqrt(const Interval& a) {
        if (is_empty(a) || a.hi < 0) return empty_set();
        return {a.lo > 0 ? sqrt_down(a.lo) : Real(0), sqrt_up(a.hi)};
    }

    friend constexpr Interval& operator+=(Interval& a, const Interval& b) { return a = a + b; }
    friend constexpr Interval& operator-=(Interval& a, const Interval& b) { return a = a - b; }
    friend constexpr Interval& operator*=(Interval& a, const Interval& b) { return a = a * b; }
    friend constexpr Interval& operator/=(Interval& a, const Interval& b) { return a = a / b; }

    // { min(x, y) : x in a, y in b } and so on: exact.

    [[nodiscard]] friend constexpr Interval min(const Interval& a, const Interval& b) {
        if (is_empty(a) || is_empty(b)) return empty_set();
        return {a.lo < b.lo ? a.lo : b.lo, a.hi < b.hi ? a.hi : b.hi};
    }

    [[nodiscard]] friend constexpr Interval max(const Interval& a, const Interval& b) {
        if (is_empty(a) || is_empty(b)) return empty_set();
        return {a.lo > b.lo ? a.lo : b.lo, a.hi > b.hi ? a.hi : b.hi};
    }

    [[nodiscard]] friend constexpr Interval abs(const Interval& a) {
        if (is_empty(a)) return empty_set();
        return {mig(a), mag(a)};
    }

    // Numbers about an interval; NaN for the empty set.

    // The greatest and the least |x|.
    [[nodiscard]] friend constexpr Real mag(const Interval& a) {
        if (is_empty(a)) return std::numeric_limits<Real>::quiet_NaN();
        return -a.lo > a.hi ? -a.lo : a.hi;
    }

    [[nodiscard]] friend constexpr Real mig(const Interval& a) {
        if (is_empty(a)) return std::numeric_limits<Real>::quiet_NaN();
        return a.lo > 0 ? a.lo : a.hi < 0 ? -a.hi : Real(0);
    }

    // The number nearest to the middle; 0 for the whole line, the largest finite one of its sign
    // for a half line.
    //   The sum is halved exactly, or is so small that it is exact itself; where it overflows, the
    //   halves are exact.
    [[nodiscard]] friend constexpr Real midpoint(const Interval& a) {
        if (is_empty(a)) return std::numeric_limits<Real>::quiet_NaN();
        if (a.lo == -infinity<Real>) return a.hi == infinity<Real> ? Real(0) : -largest<Real>;
        if (a.hi == infinity<Real>) return largest<Real>;
        const Real sum = a.lo + a.hi;
        const bool overflows = (sum > largest<Real>) | (sum < -largest<Real>);
        return overflows ? a.lo / 2 + a.hi / 2 : sum / 2;
    }

    // The least r with a inside [m - r, m + r], m the midpoint; rounded up.
    [[nodiscard]] friend constexpr Real radius(const Interval& a) {
        if (is_empty(a)) return std::numeric_limits<Real>::quiet_NaN();
        const Real m = midpoint(a);
        const Real below = sub_up(m, a.lo);
        const Real above = sub_up(a.hi, m);
        return below > above ? below : above;
    }

    // hi - lo, rounded up.
    [[nodiscard]] friend constexpr Real width(const Interval& a) {
        if (is_empty(a)) return std::numeric_limits<Real>::quiet_NaN();
        return sub_up(a.hi, a.lo);
    }

  private:
    // The bounds are the least and the greatest of the products of the ends. Rounding to nearest
    // keeps the order, so those are found first and stepped once. Products of floats are exact in
    // double. A bound of 0 is exact, unless a product of its sign underflowed.
    static constexpr Interval product(const Interval& a, const Interval& b) {
        const double ll = of_ends(a.lo, b.lo);
        const double lh = of_ends(a.lo, b.hi);
        const double hl = of_ends(a.hi, b.lo);
        const double hh = of_ends(a.hi, b.hi);
        const double least = least_of(ll, lh, hl, hh);
        const double greatest = -least_of(-ll, -lh, -hl, -hh);
        if constexpr (std::same_as<Real, float>) {
            return {float_down(least), float_up(greatest)};
        } else {
            const bool low_ends = have_26_bits(a.lo, b.lo);
            const bool high_ends = have_26_bits(a.hi, b.hi);
            const bool least_is_normal = beyond_underflow(least);
            const bool greatest_is_normal = beyond_underflow(greatest);
            const bool least_is_exact = low_ends & high_ends & least_is_normal;
            const bool greatest_is_exact = low_ends & high_ends & greatest_is_normal;
            Interval bounds(least_is_exact ? least : next_down(least),
                            greatest_is_exact ? greatest : next_up(greatest));
            const bool has_negative = (a.lo < 0 && b.hi > 0) || (a.hi > 0 && b.lo < 0);
            const bool has_positive = (a.lo < 0 && b.lo < 0) || (a.hi > 0 && b.hi > 0);
            if (least == 0 && !has_negative) bounds.lo = 0;
            if (greatest == 0 && !has_positive) bounds.hi = 0;
            return bounds;
        }
    }

    // Rounded to nearest; 0 times inf is 0.
    static constexpr double of_ends(Real x, Real y) {
        const double product = static_cast<double>(x) * static_cast<double>(y);
        return product == product ? product : 0;
    }

    template <class Number>
    static constexpr Number least_of(Number a, Number b, Number c, Number d) {
        const Number ab = b < a ? b : a;
        const Number cd = d < c ? d : c;
        return cd < ab ? cd : ab;
    }
};

}  // namespace ivory
