#include "core/shape/along_ray.h"

namespace ivory {
namespace {

constexpr double u = unit_roundoff;

// t1 - t0, rounded up.
inline double up_to(double t1, double t0) { return quick::up(t1 - t0); }

}  // namespace

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
    const Interval<double> off = quick::sub(at.rho, radius);
    at.s = quick::add(quick::sqr(off), quick::sqr(at.h));
    at.ds = quick::scale(2, quick::add(quick::mul(off, at.drho), quick::mul(at.h, dh)));
    return at;
}

CircleAlongRay::Over CircleAlongRay::over(double t0, double t1, const At& at0,
                                          const At& at1) const {
    const Interval<double> rho = quick::sqrt(across.over(at0.square, at1.square));
    const Interval<double> drho{at0.drho.lo, at1.drho.hi};  // rho is convex
    const Interval<double> h = hull(at0.h, at1.h);
    const Interval<double> dh{rise - across.nu, rise + across.nu};
    const Interval<double> off = quick::sub(rho, radius);

    // rho'' = gamma rho_0^2 / rho^3, unbounded where rho can be 0.
    const Interval<double> bend =
        rho.lo > 0 ? quick::div(quick::mul(quick::scale(0.5, across.curvature()), least_across),
                                quick::mul(rho, quick::sqr(rho)))
                   : Interval<double>(0.0, infinity<double>);
    Over range;
    range.dds = quick::sub(curvature, quick::scale(2, quick::mul(radius, bend)));
    const Interval<double> elapsed{0.0, up_to(t1, t0)};

    range.ds = quick::scale(2, quick::add(quick::mul(off, drho), quick::mul(h, dh)));
    if (range.dds.lo > -infinity<double>) {
        const Interval<double> gain = quick::mul(range.dds, elapsed);
        range.ds = intersection(range.ds,
                                intersection(quick::add(at0.ds, gain), quick::sub(at1.ds, gain)));
    }
    range.s = quick::add(quick::sqr(off), quick::sqr(h));
    if (range.ds.lo >= 0) {
        range.s = intersection(range.s, Interval<double>(at0.s.lo, at1.s.hi));
    } else if (range.ds.hi <= 0) {
        range.s = intersection(range.s, Interval<double>(at1.s.lo, at0.s.hi));
    } else {
        const Interval<double> gain = quick::mul(range.ds, elapsed);
        range.s =
            intersection(range.s, intersection(quick::add(at0.s, gain), quick::sub(at1.s, gain)));
    }
    return range;
}

}  // namespace ivory
