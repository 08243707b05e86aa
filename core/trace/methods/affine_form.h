// Affine forms of one noise symbol: x = mid + lin e + r with |r| <= err, where e in [-1, 1] is the
// place in the interval of t and the same in all forms. Reduced affine arithmetic (Gamito, Maddock
// 2007; Knoll et al. 2009): along a ray all correlation is by t, so everything else is condensed
// into one error. Products as in revised affine arithmetic (Fryazinov, Pasko, Comninos 2010, after
// Vu, Sam-Haroud, Faltings 2009): e^2 in [0, 1] moves the middle instead of widening both sides.
// Convex functions by the best line (de Figueiredo, Stolfi 2004, Chebyshev approximation).
//
// Roundings: an operation errs by less than 4 u times the sum of the magnitudes of its terms, which
// goes into err; err itself is a sum of at most ten non-negative terms, enlarged by 16 u, and
// 1e-300 stands for what underflows. Whatever overflows ends as an infinite or NaN range, which
// excludes nothing.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/trace/methods/natural.h"

namespace ivory::natural {

struct Affine {
    double mid = 0, lin = 0, err = 0;
};

namespace affine_detail {
inline constexpr double u = unit_roundoff;

inline double magnitude(const Affine& a) { return std::abs(a.mid) + std::abs(a.lin) + a.err; }

inline Affine rounded(double mid, double lin, double err, double terms) {
    return {mid, lin, (err + 4 * u * terms) * (1 + 16 * u) + 1e-300};
}
}  // namespace affine_detail

// Every x of the form lies in it.
inline Span range(const Affine& a) {
    const double reach = (std::abs(a.lin) + a.err) * (1 + 8 * affine_detail::u);
    const double rounding = 4 * affine_detail::u * (std::abs(a.mid) + reach);
    return {a.mid - reach - rounding, a.mid + reach + rounding};
}

// All of [t0, t1]; its error is 0.
inline Affine affine_over(const Span& t) {
    const double mid = midpoint(t);
    return {mid, radius(t), 0};
}

// The product of two independent errors, start's and rate's, with t, which has none.
inline Affine linear(const Linear& l, const Affine& t) {
    const double a = l.start.lo, b = l.rate.lo;
    const double reach = std::abs(t.mid) + t.lin;
    return affine_detail::rounded(a + b * t.mid, b * t.lin,
                                  (l.start.hi - a) + (l.rate.hi - b) * reach,
                                  std::abs(a) + std::abs(b) * reach);
}

inline Affine constant_like(const Span& c, const Affine&) {
    return affine_detail::rounded(midpoint(c), 0, radius(c), 0);
}

inline Affine operator+(const Affine& a, const Affine& b) {
    return affine_detail::rounded(
        a.mid + b.mid, a.lin + b.lin, a.err + b.err,
        std::abs(a.mid) + std::abs(a.lin) + std::abs(b.mid) + std::abs(b.lin));
}

inline Affine less(const Affine& a, const Span& b) {
    return affine_detail::rounded(a.mid - b.lo, a.lin, a.err + (b.hi - b.lo),
                                  std::abs(a.mid) + std::abs(b.lo));
}

inline Affine times(const Span& s, const Affine& a) {
    return affine_detail::rounded(
        s.lo * a.mid, s.lo * a.lin,
        std::abs(s.lo) * a.err + (s.hi - s.lo) * affine_detail::magnitude(a),
        std::abs(s.lo) * affine_detail::magnitude(a));
}

// (mid + lin e + r)^2 = mid^2 + 2 mid lin e + lin^2 e^2 + 2 (mid + lin e) r + r^2, with e^2 lin^2
// and r^2 from 0 to their greatest value.
inline Affine sqr(const Affine& a) {
    const double bend = 0.5 * (a.lin * a.lin + a.err * a.err);
    return affine_detail::rounded(a.mid * a.mid + bend, 2 * a.mid * a.lin,
                                  bend + 2 * (std::abs(a.mid) + std::abs(a.lin)) * a.err,
                                  affine_detail::magnitude(a) * affine_detail::magnitude(a));
}

// slope x + [offset.lo, offset.hi] for the x of the form.
inline Affine on_line(double slope, const Span& offset, const Affine& a) {
    const double mid = midpoint(offset);
    return affine_detail::rounded(slope * a.mid + mid, slope * a.lin,
                                  std::abs(slope) * a.err + radius(offset),
                                  std::abs(slope) * affine_detail::magnitude(a) + std::abs(mid));
}

// k is convex: over [s] it lies below the chord's ends and above any tangent. Of the lines of the
// chord's slope the best touches where k' is that slope.
[[nodiscard]] Affine kernel(KernelKind kind, const Affine& s);

// The square root is concave: above the chord's ends, below any tangent.
[[nodiscard]] Affine sqrt(const Affine& a);

// max(x, 0) is convex: below the chord's ends, above its corner.
[[nodiscard]] Affine at_least_0(const Affine& a);

// min(a, b) = a - max(a - b, 0).
inline Affine least(const Affine& a, const Affine& b) {
    const Span minus(-1.0);
    return a + times(minus, at_least_0(a + times(minus, b)));
}

inline Affine enclosed(const Affine&, const Span& value, const Span&) {
    return affine_detail::rounded(midpoint(value), 0, radius(value), mag(value));
}

// By the mean value theorem, from t's middle.
inline Affine along_slope(const Affine& t, const Span& at_middle, const Span& slope) {
    const double mid = midpoint(at_middle), rate = midpoint(slope);
    return affine_detail::rounded(
        mid, rate * t.lin,
        radius(at_middle) + radius(slope) * (std::abs(t.lin) + t.err) + std::abs(rate) * t.err,
        std::abs(mid) + mag(slope) * affine_detail::magnitude(t));
}

inline Affine any_kernel(const Affine&) { return {0.5, 0, 0.5 * (1 + 4 * affine_detail::u)}; }

// Where the foot passes an end of the segment, |v - lambda M|^2 with lambda clamped to [0, 1].
[[nodiscard]] Affine segment_square(const RaySkeleton& e, const Affine& t);

}  // namespace ivory::natural
