#include "core/shape/natural.h"

#include <algorithm>
#include <array>

#include "core/shape/convex_part.h"

namespace ivory {

natural::SquareAndSlope natural::taper_over(const RaySkeleton& e, const Span& t) {
    const auto at = [&](const Linear& l) { return quick::add(l.start, quick::mul(t, l.rate)); };
    const natural::Vector v{at(e.from.x), at(e.from.y), at(e.from.z)};
    const natural::Vector d{e.from.x.rate, e.from.y.rate, e.from.z.rate};
    const Span alpha = inner(v, e.axis),
               reach = quick::add(quick::add(quick::sqr(v.x), quick::sqr(v.y)), quick::sqr(v.z));
    const Span length_square = inner(e.axis, e.axis);
    const Span wanted = quick::add(alpha, quick::mul(reach, e.taper_rate));
    const Span rises = quick::add(length_square, quick::mul(alpha, e.taper_rate));
    Span u{0.0, 1.0};
    if (rises.lo > 0) {
        const Span foot = quick::div(wanted, rises);
        u = {std::min(std::max(foot.lo, 0.0), 1.0), std::min(std::max(foot.hi, 0.0), 1.0)};
    } else if (rises.hi < 0) {
        u = Span(1.0);  // beyond the apex the broader end is nearest
    }
    const natural::Vector from = minus(v, times(u, e.axis));
    const Span width = quick::add(Span(1.0), quick::mul(u, e.taper_rate));
    const Span share = quick::div(Span(1.0), quick::sqr(width));
    return {quick::mul(
                quick::add(quick::add(quick::sqr(from.x), quick::sqr(from.y)), quick::sqr(from.z)),
                share),
            quick::mul(quick::scale(2, inner(from, d)), share)};
}

natural::SquareAndSlope natural::convex_part_over(const RaySkeleton& e, const Span& t) {
    using namespace convex_part;
    const auto at = [&](const Linear& l) { return quick::add(l.start, quick::mul(t, l.rate)); };
    const natural::Vector v{at(e.from.x), at(e.from.y), at(e.from.z)};
    const natural::Vector d{e.from.x.rate, e.from.y.rate, e.from.z.rate};
    // 2 E u, of the numbers
    const double off = 0.25 * e.numbers[at_margin] * (1 + 0x1p-40);
    const auto about = [](double x, double error) { return Span(x - error, x + error); };
    const auto axis = [&](std::size_t k) {
        return natural::Vector{about(e.numbers[k], off), about(e.numbers[k + 1], off),
                               about(e.numbers[k + 2], off)};
    };
    const auto length = [&](double x) {
        return quick::mul(about(x, (off + 0x1p-50) * e.size), e.per_width);
    };
    const natural::Vector up = axis(at_n), right = axis(at_e1), top = axis(at_e2);
    const Span x = inner(v, right), y = inner(v, top), h = inner(v, up);
    const Span dx = inner(d, right), dy = inner(d, top), dh = inner(d, up);

    bool may_be_inside = true, is_inside = true;
    Span least(infinity<double>);
    const auto edge_count = static_cast<std::size_t>(e.numbers[at_count]);
    struct Edge {
        Span square, half_slope;
    };
    std::array<Edge, most_edges> seen;
    for (std::size_t k = 0; k < edge_count; ++k) {
        const double* const edge = &e.numbers[at_edges + per_edge * k];
        const Span tx = about(edge[2], off), ty = about(edge[3], off);
        const Span from_x = quick::sub(x, length(edge[0])), from_y = quick::sub(y, length(edge[1]));
        const Span along = quick::add(quick::mul(from_x, tx), quick::mul(from_y, ty));
        const Span above = quick::sub(quick::mul(from_y, tx), quick::mul(from_x, ty));
        const Span end = length(edge[4]);
        const Span foot{std::clamp(along.lo, 0.0, std::max(end.lo, 0.0)),
                        std::clamp(along.hi, 0.0, std::max(end.hi, 0.0))};
        const Span off_x = quick::sub(from_x, quick::mul(foot, tx)),
                   off_y = quick::sub(from_y, quick::mul(foot, ty));
        seen[k] = {quick::add(quick::sqr(off_x), quick::sqr(off_y)),
                   quick::add(quick::mul(off_x, dx), quick::mul(off_y, dy))};
        least = {std::min(least.lo, seen[k].square.lo), std::min(least.hi, seen[k].square.hi)};
        may_be_inside = may_be_inside && above.hi >= 0;
        is_inside = is_inside && above.lo > 0;
    }
    Span beside(0.0), slope(0.0);
    if (!is_inside) {
        beside = may_be_inside ? Span(0.0, least.hi) : least;
        slope = may_be_inside ? Span(0.0) : Span::empty_set();
        for (std::size_t k = 0; k < edge_count; ++k) {
            if (seen[k].square.lo <= least.hi) slope = hull(slope, seen[k].half_slope);
        }
    }
    return {quick::add(quick::sqr(h), beside),
            quick::scale(2, quick::add(quick::mul(h, dh), slope))};
}

natural::SquareAndSlope natural::curve_arc_over(const RaySkeleton& e, const Span& t) {
    const CurveAlongRay::At first = e.curve.at(t.lo);
    if (t.lo == t.hi) return {first.s, first.ds};
    const SquareRange over = e.curve.over(t.lo, t.hi, first, e.curve.at(t.hi));
    return {over.s, over.ds};
}

}  // namespace ivory
