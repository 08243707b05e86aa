#include "core/shape/circle_along_ray.h"

#include <algorithm>
#include <cmath>

#include "core/interval/quick.h"

namespace ivory {
namespace {

constexpr double u = unit_roundoff;

// t1 - t0, rounded up.
inline double up_to(double t1, double t0) { return quick::up(t1 - t0); }

// A lower bound of a convex function over [0, time] from lower bounds of its values at both ends, of
// its slope at 0, below 0, and an upper bound of that at the end, above 0. The function lies above
// both tangents and so above every mean of them; that is a line, least at an end. With these weights
// it is nearly level.
double least_above_tangents(double value0, double slope0, double value1, double slope1,
                            double time) {
    const double share = slope1 / (slope1 - slope0);
    if (!(share >= 0 && share <= 1)) return 0;  // lost to overflow
    const Interval<double> of0(share), of1 = quick::sub(Interval<double>(1.0), of0);
    const auto at = [&](double tau0, double tau1) {
        const auto tangent = [](double value, double slope, double tau) {
            return quick::add(Interval<double>(value), quick::mul({slope, slope}, {tau, tau}));
        };
        return quick::add(quick::mul(of0, tangent(value0, slope0, tau0)),
                          quick::mul(of1, tangent(value1, -slope1, tau1)))
            .lo;
    };
    return std::min(at(0, time), at(time, 0));
}

}  // namespace

// How far out of the rim, or 0 where it is filled.
Interval<double> CircleAlongRay::off_rim(const Interval<double>& rho) const {
    const Interval<double> off = quick::sub(rho, radius);
    return filled ? Interval<double>(std::max(off.lo, 0.0), std::max(off.hi, 0.0)) : off;
}

// rho'' = gamma rho_0^2 / rho^3, unbounded where rho can be 0.
Interval<double> CircleAlongRay::rho_bend(const Interval<double>& rho) const {
    const Interval<double> cube = quick::mul(rho, quick::sqr(rho));
    if (!(cube.lo > 0)) return {0.0, infinity<double>};
    return quick::div(quick::mul(quick::scale(0.5, across.curvature()), least_across), cube);
}

CircleAlongRay::At CircleAlongRay::at(double t) const {
    At at;
    at.square = across.at(t);
    const double tau = t - across.reference;
    const double error =
        across.eta + across.nu * std::abs(tau) + 8 * u * (std::abs(height) + std::abs(tau * rise));
    const double h = height + tau * rise;
    at.h = {h - error, h + error};
    at.rho = quick::sqrt(at.square.value());
    // |rho'| <= |e|, whatever rho is; the quotient is sharper away from the axis.
    const double speed = across.kappa + across.nu;
    at.drho = {-speed, speed};
    if (at.rho.lo > 0) {
        const Interval<double> quotient = quick::div(quick::scale(0.5, at.square.slope()), at.rho);
        at.drho = {std::max(quotient.lo, -speed), std::min(quotient.hi, speed)};
        if (is_empty(at.drho)) at.drho = {-speed, speed};
    }
    const Interval<double> dh{rise - across.nu, rise + across.nu};
    const Interval<double> off = off_rim(at.rho);
    at.s = quick::add(quick::sqr(off), quick::sqr(at.h));
    at.ds = quick::scale(2, quick::add(quick::mul(off, at.drho), quick::mul(at.h, dh)));
    return at;
}

CircleAlongRay::Over CircleAlongRay::over(double t0, double t1, const At& at0,
                                          const At& at1) const {
    if (filled) return over_filled(t0, t1, at0, at1);
    const Interval<double> rho = quick::sqrt(across.over(at0.square, at1.square));
    const Interval<double> drho{at0.drho.lo, at1.drho.hi};  // rho is convex
    const Interval<double> h = hull(at0.h, at1.h);
    const Interval<double> dh{rise - across.nu, rise + across.nu};
    const Interval<double> off = quick::sub(rho, radius);

    Over range;
    range.dds = quick::sub(curvature, quick::scale(2, quick::mul(radius, rho_bend(rho))));
    const Interval<double> elapsed{0.0, up_to(t1, t0)};

    range.ds = quick::scale(2, quick::add(quick::mul(off, drho), quick::mul(h, dh)));
    range.s = quick::add(quick::sqr(off), quick::sqr(h));
    narrow_by_ends(range, elapsed, at0.s, at0.ds, at1.s, at1.ds);
    return range;
}

CircleAlongRay::Over CircleAlongRay::over_filled(double t0, double t1, const At& at0,
                                                 const At& at1) const {
    const Interval<double> rho = quick::sqrt(across.over(at0.square, at1.square));
    const Interval<double> drho{at0.drho.lo, at1.drho.hi};  // rho is convex
    const Interval<double> h = hull(at0.h, at1.h);
    const Interval<double> dh{rise - across.nu, rise + across.nu};
    const Interval<double> off = off_rim(rho);

    // Within the rim s'' is that of h^2; beyond, 2 |d|^2 - 2 r rho'', and no less than that of h^2,
    // since both squares are convex. At the rim it jumps.
    Over range;
    const Interval<double> level = quick::scale(2, quick::sqr(dh));
    range.dds = rho.lo <= radius.hi ? level : Interval<double>::empty_set();
    if (rho.hi >= radius.lo) {
        const Interval<double> bend = rho_bend({std::max(rho.lo, radius.lo), rho.hi});
        const Interval<double> beyond =
            quick::sub(curvature, quick::scale(2, quick::mul(radius, bend)));
        range.dds = hull(range.dds, Interval<double>(std::max(beyond.lo, level.lo),
                                                     std::max(beyond.hi, level.hi)));
    }

    const Interval<double> elapsed{0.0, up_to(t1, t0)};
    const Interval<double> gain = quick::mul(range.dds, elapsed);
    range.ds = intersection(quick::scale(2, quick::add(quick::mul(off, drho), quick::mul(h, dh))),
                            Interval<double>(at0.ds.lo, at1.ds.hi));
    range.ds =
        intersection(range.ds, intersection(quick::add(at0.ds, gain), quick::sub(at1.ds, gain)));

    double least = quick::add(quick::sqr(off), quick::sqr(h)).lo;
    if (range.ds.lo >= 0) {
        least = std::max(least, at0.s.lo);
    } else if (range.ds.hi <= 0) {
        least = std::max(least, at1.s.lo);
    } else {
        least = std::max(
            least, least_above_tangents(at0.s.lo, range.ds.lo, at1.s.lo, range.ds.hi, elapsed.hi));
    }
    range.s = {std::max(least, 0.0), std::max(at0.s.hi, at1.s.hi)};
    return range;
}

// As `sublevel` does it for a square: h vanishes at t_r - height / rise, within the errors of both.
Interval<double> CircleAlongRay::within_height(double most) const {
    const double speed = std::abs(rise) * (1 - 16 * u) - across.nu - 1e-149;  // <= |h'|
    if (!(speed > 0.5 * std::abs(rise))) return Interval<double>::entire();
    const double half = most / speed, centre = across.reference - height / rise;
    const double error = (across.eta + 8 * u * std::abs(height)) / speed +
                         8 * (across.nu / speed + u) * std::abs(centre - across.reference) +
                         8 * u * std::abs(centre) + 1e-6 * half;
    return {centre - half - error, centre + half + error};
}

}  // namespace ivory
