#include "core/shape/curve_along_ray.h"

#include <algorithm>
#include <cmath>

#include "core/interval/quick.h"
#include "core/math/offset.h"
#include "core/shape/curve_arc.h"

namespace ivory {
namespace {

using Span = Interval<double>;

constexpr double u = unit_roundoff;

// (q - r)^2 and (q + r)^2 of the least and the greatest q^2.
double nearer(double square, double radius) {
    const double q = std::max(std::sqrt(square) * (1 - 4 * u) - radius, 0.0);
    return q * q * (1 - 4 * u);
}
double farther(double square, double radius) {
    const double q = std::sqrt(square) * (1 + 4 * u) + radius;
    return q * q * (1 + 8 * u);
}

}  // namespace

Span CurveAlongRay::rough_square(double t0, double t1) const {
    const Span square = middle.over(middle.at(t0), middle.at(t1));
    return {nearer(square.lo, radius), farther(square.hi, radius)};
}
double CurveAlongRay::rough_least() const { return nearer(middle.least, radius); }

CurveAlongRay::At CurveAlongRay::at(double t) const {
    using namespace curve_arc;
    Vec3<Span> v;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double from_a = offset(origin[axis], a[axis], t, direction[axis]);
        const double error =
            2 * u * std::abs(from_a) +
            16 * u * u * (std::abs(origin[axis] - a[axis]) + std::abs(t * direction[axis])) +
            1e-300;
        const double k0 = numbers[at_k0 + axis];
        const double k0_error = 2 * u * std::abs(k0) + numbers[at_lost];
        v[axis] =
            quick::sub(Span(from_a - error, from_a + error), Span(k0 - k0_error, k0 + k0_error));
    }
    const Feet found = feet(numbers, v);
    Span slope = Span::empty_set();
    for (std::size_t k = 0; k < found.count; ++k) {
        const Vec3<Span> away = away_at(numbers, v, found.x[k]);
        Span along(0.0);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            along = quick::add(along, quick::mul(away[axis], Span(direction[axis])));
        }
        slope = hull(slope, along);
    }
    const Span share = quick::div(Span(1.0), quick::sqr(Span(width)));
    const Span s = quick::mul(found.square, share);
    return {{std::max(s.lo, 0.0), s.hi}, quick::mul(quick::scale(2, slope), share), found.bend};
}

CurveAlongRay::Over CurveAlongRay::over(double t0, double t1, const At& at0, const At& at1) const {
    using namespace curve_arc;
    const Span elapsed = quick::sub(Span(t1), Span(t0));
    const Span share = quick::div(Span(1.0), quick::sqr(Span(width)));
    Span speed(0.0);  // |d|^2 / w^2
    for (std::size_t axis = 0; axis < 3; ++axis) {
        speed = quick::add(speed, quick::sqr(Span(direction[axis])));
    }
    speed = quick::mul(speed, share);
    const Span way = quick::mul(speed, quick::sqr(elapsed)), turned = quick::mul(speed, elapsed);

    Over range;
    // The parabola of a place that is nearest at one end, at the other.
    const Span of_first = quick::add(quick::add(at0.s, quick::mul(at0.ds, elapsed)), way);
    const Span of_last = quick::add(quick::sub(at1.s, quick::mul(at1.ds, elapsed)), way);
    range.s.hi = std::min(std::max(at0.s.hi, of_first.hi), std::max(at1.s.hi, of_last.hi));
    // Below the chord by no more than |d|^2 (t - t0)(t1 - t).
    range.s.lo = std::max(
        quick::sub(Span(std::min(at0.s.lo, at1.s.lo)), quick::scale(0.25, Span(way.hi))).lo, 0.0);
    range.s.lo = std::min(range.s.lo, std::min(at0.s.lo, at1.s.lo));
    range.ds = {quick::sub(at1.ds, quick::scale(2, turned)).lo,
                quick::add(at0.ds, quick::scale(2, turned)).hi};
    range.dds = {-infinity<double>, 2 * speed.hi};
    if (numbers[at_slowest] > 0) {
        const double slowest = numbers[at_slowest];
        // d / R, rounded up
        const double bent =
            std::sqrt(range.s.hi) * width * numbers[at_turn] / (slowest * slowest) * (1 + 16 * u);
        if (bent < 0.99) range.dds.lo = -2 * speed.hi * bent / (1 - bent) * (1 + 16 * u);
    }
    narrow_by_ends(range, elapsed, at0.s, at0.ds, at1.s, at1.ds);
    // From the left end on, which is what it is asked for (core/field/inclusion.h).
    range.dds.lo = std::max(range.dds.lo, -2 * speed.hi * at0.bend * (1 + 16 * u));
    return range;
}

}  // namespace ivory
