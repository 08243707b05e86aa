// Numbers to put in the place of t in core/trace/methods/natural.h: a double, an interval, and an
// interval with the range of the derivative by t.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/interval/quick.h"
#include "core/trace/methods/natural.h"

namespace ivory::natural {

// To nearest; claims nothing.
struct Plain {
    double x = 0;
};

inline Plain linear(const Linear& l, Plain t) { return {l.start.lo + t.x * l.rate.lo}; }
inline Plain constant_like(const Span& c, Plain) { return {midpoint(c)}; }
inline Plain operator+(Plain a, Plain b) { return {a.x + b.x}; }
inline Plain less(Plain a, const Span& b) { return {a.x - b.lo}; }
inline Plain sqr(Plain a) { return {a.x * a.x}; }
inline Plain sqrt(Plain a) { return {std::sqrt(a.x)}; }
inline Plain at_least_0(Plain a) { return {std::max(a.x, 0.0)}; }
inline Plain hull(Plain, Plain b) { return b; }
inline Plain least(Plain a, Plain b) { return {std::min(a.x, b.x)}; }
inline Span range(Plain a) { return Span(a.x); }
inline Plain times(const Span& s, Plain a) { return {s.lo * a.x}; }
inline Plain any_kernel(Plain) { return {0.0}; }
inline Plain enclosed(Plain, const Span& value, const Span&) { return {midpoint(value)}; }
inline Plain kernel(KernelKind kind, Plain s) {
    return {with_kernel(kind, [&]<class K>() { return K::plain(s.x); })};
}

// start + [t] rate. For t >= 0 and a rate of one sign the ends are products of ends; each carries two
// roundings, of the product and of the sum.
inline Span line_over(const Linear& l, const Span& t) {
    const bool rises = l.rate.lo >= 0;
    if (t.lo >= 0 && (rises || l.rate.hi <= 0)) {
        const double below = (rises ? t.lo : t.hi) * l.rate.lo;
        const double above = (rises ? t.hi : t.lo) * l.rate.hi;
        const double lo = l.start.lo + below, hi = l.start.hi + above;
        const Span line{lo - ((std::abs(below) + std::abs(lo)) * 0x1.8p-52 + 0x1p-1069),
                        hi + ((std::abs(above) + std::abs(hi)) * 0x1.8p-52 + 0x1p-1069)};
        if (line.lo > -infinity<double> && line.hi < infinity<double>) return line;
    }
    return quick::add(l.start, quick::mul(t, l.rate));
}

// s a for a double s that is not 0, given as [s, s].
inline Span multiple(const Span& s, const Span& a) {
    return {quick::detail::lower_end(s.lo * (s.lo > 0 ? a.lo : a.hi)),
            quick::detail::upper_end(s.lo * (s.lo > 0 ? a.hi : a.lo))};
}

// All values over an interval of t.
struct Range {
    Span x;
};

inline Range linear(const Linear& l, const Range& t) { return {line_over(l, t.x)}; }
inline Range constant_like(const Span& c, const Range&) { return {c}; }
inline Range operator+(const Range& a, const Range& b) { return {quick::add(a.x, b.x)}; }
inline Range less(const Range& a, const Span& b) { return {quick::sub(a.x, b)}; }
inline Range sqr(const Range& a) { return {quick::sqr(a.x)}; }
inline Range sqrt(const Range& a) { return {quick::sqrt(a.x)}; }
inline Range at_least_0(const Range& a) { return {{std::max(a.x.lo, 0.0), std::max(a.x.hi, 0.0)}}; }
inline Range hull(const Range& a, const Range& b) { return {hull(a.x, b.x)}; }
inline Range least(const Range& a, const Range& b) {
    return {{std::min(a.x.lo, b.x.lo), std::min(a.x.hi, b.x.hi)}};
}
inline Span range(const Range& a) { return a.x; }
inline Range times(const Span& s, const Range& a) { return {multiple(s, a.x)}; }
inline Range any_kernel(const Range&) { return {{0.0, 1.0}}; }
inline Range enclosed(const Range&, const Span& value, const Span&) { return {value}; }
inline Range kernel(KernelKind kind, const Range& s) { return {kernel_over(kind, s.x)}; }

// Values and derivatives by t over an interval of t: forward differentiation of the same formulas.
// The derivatives of the kernels and of s pass continuously from piece to piece; at a circle's axis
// the derivative has two sides, and both are in the slope, which is unbounded there.
struct Dual {
    Span x, slope;
};

inline Dual linear(const Linear& l, const Dual& t) {
    return {line_over(l, t.x), l.rate};  // the slope of t is 1
}
inline Dual constant_like(const Span& c, const Dual&) { return {c, Span(0.0)}; }
inline Dual operator+(const Dual& a, const Dual& b) {
    return {quick::add(a.x, b.x), quick::add(a.slope, b.slope)};
}
inline Dual less(const Dual& a, const Span& b) { return {quick::sub(a.x, b), a.slope}; }
inline Dual sqr(const Dual& a) {
    return {quick::sqr(a.x), quick::scale(2, quick::mul(a.x, a.slope))};
}
// x' / (2 sqrt x); where x can be 0 so can x', which makes the quotient the whole line.
inline Dual sqrt(const Dual& a) {
    const Span root = quick::sqrt(a.x);
    const Span twice = quick::scale(2, root);
    return {root, twice.lo > 0 ? quick::div(a.slope, twice) : a.slope / twice};
}
// Its square has a derivative everywhere, 0 where a <= 0.
inline Dual at_least_0(const Dual& a) {
    if (a.x.lo >= 0) return a;
    if (a.x.hi <= 0) return {Span(0.0), Span(0.0)};
    return {{0.0, a.x.hi}, hull(a.slope, Span(0.0))};
}
inline Dual hull(const Dual& a, const Dual& b) { return {hull(a.x, b.x), hull(a.slope, b.slope)}; }
inline Dual least(const Dual& a, const Dual& b) {
    if (a.x.hi < b.x.lo) return a;
    if (b.x.hi < a.x.lo) return b;
    return {{std::min(a.x.lo, b.x.lo), std::min(a.x.hi, b.x.hi)}, hull(a.slope, b.slope)};
}
inline Span range(const Dual& a) { return a.x; }
inline Dual times(const Span& s, const Dual& a) { return {multiple(s, a.x), multiple(s, a.slope)}; }
inline Dual any_kernel(const Dual&) { return {{0.0, 1.0}, Span::entire()}; }
inline Dual enclosed(const Dual&, const Span& value, const Span& slope) { return {value, slope}; }
inline Dual kernel(KernelKind kind, const Dual& s) {
    return with_kernel(kind, [&]<class K>() -> Dual {
        const Span k = kernel_over<K>(s.x);
        if constexpr (K::ends) {
            // k' rises with s.
            const Span dk{K::slope_at(std::max(s.x.lo, 0.0)).lo, K::slope_at(s.x.hi).hi};
            return {k, quick::mul(dk, s.slope)};
        } else {
            return {k, quick::mul(K::slope_over(k, s.x.lo, s.x.hi), s.slope)};
        }
    });
}

}  // namespace ivory::natural
