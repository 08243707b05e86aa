#include "core/shape/taper_along_ray.h"

#include <algorithm>
#include <cmath>

#include "core/math/offset.h"

namespace ivory {
namespace {

using I = Interval<double>;
using Vector = TaperAlongRay::Vector;

I inner(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
I square(const Vector& a) { return sqr(a.x) + sqr(a.y) + sqr(a.z); }
Vector less_share(const Vector& v, const Vector& m, const I& u) {
    return {v.x - u * m.x, v.y - u * m.y, v.z - u * m.z};
}

double one_norm(const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

constexpr double u_round = unit_roundoff;

}  // namespace

bool TaperAlongRay::see(const Vec3d& from, const Vec3d& heading, const Vec3d& end_a,
                        const Vec3d& end_b, double at_a, double at_b, const I& span) {
    origin = from;
    direction = heading;
    a = end_a;
    m = {I(end_b.x) - I(end_a.x), I(end_b.y) - I(end_a.y), I(end_b.z) - I(end_a.z)};
    width_a = I(at_a);
    width_b = I(at_b);
    more = width_b - width_a;
    least_width = std::min(at_a, at_b);
    const Vector d{I(heading.x), I(heading.y), I(heading.z)};
    speed_square = square(d);
    along = inner(m, d);
    length_square = square(m);
    // No product of four of these leaves the range of doubles.
    const double most =
        std::max({one_norm(from), one_norm(end_a), one_norm(end_b), mag(span) * 8, at_a, at_b});
    return most < 1e60 && least_width > 1e-60;
}

TaperAlongRay::Foot TaperAlongRay::foot(const I& wanted, const I& rises) const {
    // psi of (1) at both ends; it is linear between.
    const I at_start = -wanted, at_end = rises - wanted;
    if (at_start.lo >= 0 && at_end.lo >= 0) return {.at_a = true};
    if (at_start.hi <= 0 && at_end.hi <= 0) return {.at_b = true};
    if (!(rises.lo > 0)) return {true, true, I(0.0, 1.0)};
    const I u = wanted / rises;
    return {u.lo <= 0, u.hi >= 1, intersection(u, I(0.0, 1.0))};
}

// 2 (p - c(u)).d / w(u)^2, `inward` = (p - a).d.
I TaperAlongRay::slope(const Foot& foot, const I& inward) const {
    I slope = I::empty_set();
    if (foot.at_a) slope = hull(slope, I(2.0) * inward / sqr(width_a));
    if (foot.at_b) slope = hull(slope, I(2.0) * (inward - along) / sqr(width_b));
    if (!is_empty(foot.between)) {
        const I width = width_a + foot.between * more;
        slope = hull(slope, I(2.0) * (inward - foot.between * along) / sqr(width));
    }
    return slope;
}

TaperAlongRay::At TaperAlongRay::at(double t) const {
    At at;
    const double far = 16 * u_round * u_round *
                           (one_norm(origin) + one_norm(a) + std::abs(t) * one_norm(direction)) +
                       1e-290;
    for (std::size_t k = 0; k < 3; ++k) {
        const double x = offset(origin[k], a[k], t, direction[k]);
        const double error = 2 * u_round * std::abs(x) + far;
        at.from_a[k] = {x - error, x + error};
    }
    const I alpha = inner(at.from_a, m), reach = square(at.from_a);
    at.wanted = alpha * width_a + reach * more;
    at.rises = length_square * width_a + alpha * more;

    // Any u gives an upper bound. With gamma the derivative of |p - c(u)| - q w(u) there, no q is
    // below this one by more than what gamma could gain towards either end, over the least width:
    // core/shape/taper.h.
    const Foot where = foot(at.wanted, at.rises);
    double u = where.at_b ? 1 : 0;
    if (!is_empty(where.between)) u = std::min(std::max(midpoint(where.between), 0.0), 1.0);
    if (where.at_a && where.at_b) u = width_a.lo >= width_b.lo ? 0 : 1;
    const Vector from = less_share(at.from_a, m, I(u));
    const I width = width_a + I(u) * more, away = sqrt(square(from)), q = away / width;
    at.s = sqr(q);
    double least = 0;
    if (away.lo > 0) {
        const I gamma = -(inner(from, m) / away) - q * more;
        const double gain = std::max({-gamma.lo * (1 - u), gamma.hi * u, 0.0});
        least = sub_down(q.lo, mul_up(gain / least_width, 1 + 8 * u_round));
    }
    at.s.lo = least > 0 ? std::max(mul_down(least, least), 0.0) : 0;

    const Vector d{I(direction.x), I(direction.y), I(direction.z)};
    at.ds = slope(where, inner(at.from_a, d));
    return at;
}

TaperAlongRay::Over TaperAlongRay::over(double t0, double t1, const At& at0, const At& at1) const {
    const I elapsed{0.0, sub_up(t1, t0)};
    // Both are at most quadratic in t, with second derivatives 2 |d|^2 more and 0.
    const I sag = I(0.25) * sqr(I(elapsed.hi)) * speed_square * more;
    const double sags = mag(sag);
    const I wanted = hull(at0.wanted, at1.wanted) + I(-sags, sags);
    const I rises = hull(at0.rises, at1.rises);
    const Vector d{I(direction.x), I(direction.y), I(direction.z)};
    const I inward = hull(inner(at0.from_a, d), inner(at1.from_a, d));
    const Foot where = foot(wanted, rises);

    Over range;
    range.dds = I::empty_set();
    const I twice = I(2.0) * speed_square;
    if (where.at_a) range.dds = hull(range.dds, twice / sqr(width_a));
    if (where.at_b) range.dds = hull(range.dds, twice / sqr(width_b));
    if (!is_empty(where.between)) {
        const I width = width_a + where.between * more;
        I bends = twice / sqr(width);
        if (rises.lo > 0) {
            const I turn = along + I(2.0) * (inward - where.between * along) * more / width;
            bends = bends - I(2.0) * sqr(turn) / (width * rises);
        } else {
            bends.lo = -infinity<double>;
        }
        range.dds = hull(range.dds, bends);
    }
    // s' passes continuously from case to case, but where the foot leaps from end to end.
    if (!(rises.lo > 0) && where.at_a && where.at_b) range.dds.lo = -infinity<double>;

    range.ds = slope(where, inward);
    range.s = {0.0, infinity<double>};
    narrow_by_ends(range, elapsed, at0.s, at0.ds, at1.s, at1.ds);
    return range;
}

}  // namespace ivory
