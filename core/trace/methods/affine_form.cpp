#include "core/trace/methods/affine_form.h"

namespace ivory::natural {
namespace {

constexpr double u = affine_detail::u;

// fl(a - b c) lies within this of it.
double slack(double a, double product) {
    return 4 * u * (std::abs(a) + std::abs(product)) + 1e-300;
}

// Lower and upper bound of a - slope x.
double offset_below(double a, double slope, double x) {
    const double product = slope * x;
    return (a - product) - slack(a, product);
}
double offset_above(double a, double slope, double x) {
    const double product = slope * x;
    return (a - product) + slack(a, product);
}

}  // namespace

Affine kernel(KernelKind kind, const Affine& s) {
    const Span all = range(s);
    if (!(all.hi < infinity<double>)) return any_kernel(s);
    const double lo = std::max(all.lo, 0.0), hi = all.hi;
    if (hi <= lo) return on_line(0, kernel_over(kind, {0.0, std::max(hi, 0.0)}), s);
    const double at_lo = kernel_at(kind, lo).hi, at_hi = kernel_at(kind, hi).hi;
    const double middle = 0.5 * (lo + hi);
    double slope, touch = middle;
    if (hi - lo > 1e-4) {
        slope = (at_hi - at_lo) / (hi - lo);
        if (!(slope < 0)) return on_line(0, {0.0, at_lo}, s);
        // The bound holds wherever it touches.
        touch = with_kernel(kind, [&]<class K>() { return K::touching_point(slope); });
        touch = touch > lo && touch < hi ? touch : middle;
    } else {
        slope = midpoint(kernel_slope_at(kind, middle));
    }
    // k(s) - slope s >= k(w) + k'(w) (s - w) - slope s, a line in s: least at an end.
    const Span k = kernel_at(kind, touch);
    const Span dk = kernel_slope_at(kind, touch);
    const double left = k.lo + dk.hi * (lo - touch), right = k.lo + dk.lo * (hi - touch);
    const double below =
        std::min(offset_below(left - 4 * u * (k.lo + std::abs(dk.lo) * (touch - lo)), slope, lo),
                 offset_below(right - 4 * u * (k.lo + std::abs(dk.lo) * (hi - touch)), slope, hi));
    const double above = std::max(offset_above(at_lo, slope, lo), offset_above(at_hi, slope, hi));
    return on_line(slope, {below, above}, s);
}

Affine sqrt(const Affine& a) {
    const Span all = range(a);
    const double lo = std::max(all.lo, 0.0), hi = all.hi;
    if (!(hi < infinity<double>)) return {0, 0, infinity<double>};
    if (!(hi > 1e-280)) return {0, 0, 2e-140};
    const double root_lo = std::sqrt(lo), root_hi = std::sqrt(hi);
    const double slope = 1 / (root_lo + root_hi);
    const double root = 0.5 * (root_lo + root_hi);  // sqrt is that steep at root^2
    // sqrt x <= root / 2 + x / (2 root), whatever the root: greatest at an end.
    const auto tangent = [&](double x) {
        const double y = 0.5 * root + x / (2 * root);
        return offset_above(y * (1 + 8 * u), slope, x);
    };
    const double below = std::min(offset_below(root_lo * (1 - 2 * u), slope, lo),
                                  offset_below(root_hi * (1 - 2 * u), slope, hi));
    return on_line(slope, {below, std::max(tangent(lo), tangent(hi))}, a);
}

Affine at_least_0(const Affine& a) {
    const Span all = range(a);
    if (all.lo >= 0) return a;
    if (all.hi <= 0) return {};
    if (!(all.hi - all.lo < 1e100)) return {0, 0, infinity<double>};
    const double slope = all.hi / (all.hi - all.lo);
    Span offset(0.0);  // at 0
    offset = hull(offset, Span(offset_below(0, slope, all.lo), offset_above(0, slope, all.lo)));
    offset = hull(offset,
                  Span(offset_below(all.hi, slope, all.hi), offset_above(all.hi, slope, all.hi)));
    return on_line(slope, offset, a);
}

Affine segment_square(const RaySkeleton& e, const Affine& t) {
    const Affine lambda = linear(e.along, t);
    const Span all = range(lambda);
    if (all.hi <= 0) return square(e.from, t);
    if (all.lo >= 1) return square(e.from_b, t);
    if (all.lo >= 0 && all.hi <= 1) return square(e.across, t);
    if (!(all.hi - all.lo < 1e100)) return {0, 0, infinity<double>};
    // clamp(x) - slope x is greatest and least at the ends and the corners.
    const auto clamped = [](double x) { return std::min(std::max(x, 0.0), 1.0); };
    const double slope = (clamped(all.hi) - clamped(all.lo)) / (all.hi - all.lo);
    Span offset = Span::empty_set();
    for (const double x : {all.lo, all.hi, std::max(all.lo, 0.0), std::min(all.hi, 1.0)}) {
        const double y = clamped(x);
        offset = hull(offset, Span(offset_below(y, slope, x), offset_above(y, slope, x)));
    }
    const Affine foot = on_line(slope, offset, lambda);
    const auto away = [&](const Linear& from, const Span& m) {
        return linear(from, t) + times(-m, foot);
    };
    return sqr(away(e.from.x, e.axis.x)) + sqr(away(e.from.y, e.axis.y)) +
           sqr(away(e.from.z, e.axis.z));
}

}  // namespace ivory::natural
