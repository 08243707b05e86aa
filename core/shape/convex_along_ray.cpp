#include "core/shape/convex_along_ray.h"

#include <algorithm>
#include <cmath>

#include "core/interval/quick.h"
#include "core/math/offset.h"
#include "core/shape/convex_part.h"

namespace ivory {
namespace {

constexpr double u = unit_roundoff;

double one_norm(const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

}  // namespace

ConvexAlongRay::At ConvexAlongRay::at(double t) const {
    using namespace convex_part;
    const Vec3d v{offset(origin.x, a.x, t, direction.x), offset(origin.y, a.y, t, direction.y),
                  offset(origin.z, a.z, t, direction.z)};
    const auto axis = [&](std::size_t k) {
        return Vec3d{numbers[k], numbers[k + 1], numbers[k + 2]};
    };
    const Vec3d up = axis(at_n), right = axis(at_e1), top = axis(at_e2);
    const double h = dot(v, up);
    const OffPart off = nearest_in_plane(numbers, size, dot(v, right), dot(v, top));
    const Vec3d away = h * up + off.x * right + off.y * top;

    const double reach = one_norm(v) * (1 + 4 * u), speed = one_norm(direction);
    const double far = one_norm(origin - a) + std::abs(t) * speed;
    const double eta = u * reach + 16 * u * u * far;
    // beside value_error: of h and the root, 4 u each; of `away`, the frame and its sums, 8 u
    const double error = value_error(eta, numbers[at_margin], reach, size) * (1 + 8 * u) + 1e-290;
    const double turn = error + turn_error(numbers[at_margin], reach, size, numbers[at_least]);
    const double distance = std::sqrt(h * h + (off.x * off.x + off.y * off.y));
    const double lo = std::max((distance - error) * (1 - 8 * u), 0.0);
    const double hi = (distance + error) * (1 + 8 * u);
    const double share = 1 / (width * width), half_slope = dot(away, direction);
    const double slope_error = speed * (turn + 24 * u * hi + 8 * numbers[at_margin] * reach);
    const auto scaled = [&](double x, double rounding) {
        return x * share + rounding * (std::abs(x) * share * 8 * u + 1e-300);
    };
    return {
        {std::max(scaled(lo * lo, -1), 0.0), scaled(hi * hi, 1)},
        {scaled(2 * (half_slope - slope_error), -1), scaled(2 * (half_slope + slope_error), 1)}};
}

// Between the tangents at both ends: whatever the place at which these meet is taken to be, the one
// falls up to there and the other rises from there on.
ConvexAlongRay::Over ConvexAlongRay::over(double t0, double t1, const At& at0,
                                          const At& at1) const {
    Over range;
    range.s = {std::min(at0.s.lo, at1.s.lo), std::max(at0.s.hi, at1.s.hi)};
    range.ds = {at0.ds.lo, std::max(at1.ds.hi, at0.ds.lo)};
    const Interval<double> speed = quick::add(quick::add(quick::sqr(Interval<double>(direction.x)),
                                                         quick::sqr(Interval<double>(direction.y))),
                                              quick::sqr(Interval<double>(direction.z)));
    const double share = 2 / (width * width);
    range.dds = {0.0, speed.hi * share * (1 + 8 * u)};
    if (at0.ds.lo < 0 && at1.ds.hi > 0) {
        const double elapsed = t1 - t0;
        const double meet = std::clamp(
            (at1.s.lo - at0.s.lo - at1.ds.hi * elapsed) / (at0.ds.lo - at1.ds.hi), 0.0, elapsed);
        const auto after = [](const Interval<double>& s, double slope, double x) {
            return quick::add(Interval<double>(s.lo),
                              quick::mul(Interval<double>(slope), Interval<double>(x)))
                .lo;
        };
        const double left =
            quick::sub(Interval<double>(next_up(elapsed)), Interval<double>(meet)).hi;
        range.s.lo =
            std::max(std::min(after(at0.s, at0.ds.lo, meet), after(at1.s, -at1.ds.hi, left)), 0.0);
    }
    narrow_by_ends(range, quick::sub(Interval<double>(t1), Interval<double>(t0)), at0.s, at0.ds,
                   at1.s, at1.ds);
    return range;
}

}  // namespace ivory
