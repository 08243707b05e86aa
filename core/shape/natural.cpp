#include "core/shape/natural.h"

#include <algorithm>

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

}  // namespace ivory
